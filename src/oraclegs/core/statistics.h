#pragma once
// Middle values and the logistic function.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace oraclegs {

/// The middle one, of an even count the upper of the two in the middle; 0 for none. The values lose their order.
template <class T>
T UpperMedian(std::vector<T>* values) {
  if (values->empty()) return T{};
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}
template <class T>
T UpperMedian(std::vector<T> values) {
  return UpperMedian(&values);
}

/// The middle one, of an even count the mean of the two in the middle; 0 for none. The values lose their order.
template <class T>
T Median(std::vector<T>* values) {
  const T upper = UpperMedian(values);
  if (values->size() % 2 == 1 || values->empty()) return upper;
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  return (upper + *std::max_element(values->begin(), middle)) / 2;
}
template <class T>
T Median(std::vector<T> values) {
  return Median(&values);
}

/// The probability that belongs to a logit.
template <class T>
T Sigmoid(T logit) {
  return 1 / (1 + std::exp(-logit));
}

}  // namespace oraclegs

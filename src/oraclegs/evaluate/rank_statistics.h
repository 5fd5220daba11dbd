#pragma once
// Rank statistics: how well one value orders things by another.

#include <cstdint>
#include <vector>

namespace oraclegs {

/// Indices of the values in rising order; ties in their order.
std::vector<int64_t> RisingOrder(const std::vector<float>& values);

/// Calls f(begin, end) for each run of equal values in `order`, which is from RisingOrder or its reverse.
template <class F>
void ForEachTie(const std::vector<float>& values, const std::vector<int64_t>& order, F&& f) {
  const auto n = static_cast<int64_t>(order.size());
  for (int64_t begin = 0, end = 0; begin < n; begin = end) {
    while (end < n && values[order[end]] == values[order[begin]]) ++end;
    f(begin, end);
  }
}

/// Rank of each value, from 1; ties share their mean.
std::vector<double> Ranks(const std::vector<float>& values);

/// Pearson's correlation of two lists of one length; Spearman's, if given Ranks. 0 when one list is constant.
double Correlation(const std::vector<double>& a, const std::vector<double>& b);

/// Area under the ROC curve of a low value as a sign of being positive: the probability that a positive has a lower
/// rank than a negative, with ties counted half (Mann-Whitney). ranks: of the values; positive: one flag for each. NaN
/// when none or all are positive.
double AurocOfLowRank(const std::vector<double>& ranks, const std::vector<bool>& positive);

}  // namespace oraclegs

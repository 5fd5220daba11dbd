#pragma once
// How well one value orders things by another: ranks and what is made of them.

#include <cstdint>
#include <vector>

namespace oraclegs {

/// The places of the values in rising order; equal ones in their order.
std::vector<int64_t> RisingOrder(const std::vector<float>& values);

/// Calls f(begin, end) for each run of `order`, which RisingOrder gave, or its reverse, of one value.
template <class F>
void ForEachTie(const std::vector<float>& values, const std::vector<int64_t>& order, F&& f) {
  const auto n = static_cast<int64_t>(order.size());
  for (int64_t begin = 0, end = 0; begin < n; begin = end) {
    while (end < n && values[order[end]] == values[order[begin]]) ++end;
    f(begin, end);
  }
}

/// Of each value, from 1; ties share their mean.
std::vector<double> Ranks(const std::vector<float>& values);

/// Pearson's correlation of two lists of one length; of Ranks it is Spearman's. 0 when one of them is constant.
double Correlation(const std::vector<double>& a, const std::vector<double>& b);

/// Area under the ROC curve of a low value as a sign of being positive: the probability that a positive has a lower
/// rank than a negative, ties by half (Mann and Whitney). ranks: of the values; positive: one for each. NaN when none
/// or all are positive.
double AurocOfLowRank(const std::vector<double>& ranks, const std::vector<bool>& positive);

}  // namespace oraclegs

#include "oraclegs/evaluate/oracle_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "oraclegs/core/error.h"
#include "oraclegs/evaluate/rank_statistics.h"
#include "oraclegs/evaluate/sparsification.h"
#include "oraclegs/image/similarity.h"

namespace oraclegs {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void CheckPixels(const std::vector<float>& error, const std::vector<float>& confidence) {
  if (error.size() != confidence.size() || error.empty()) {
    throw ShapeError("OracleQuality: {} errors and {} confidences, needs as many, and at least one", error.size(),
                     confidence.size());
  }
  for (size_t i = 0; i < error.size(); ++i) {
    if (!(error[i] >= 0) || !std::isfinite(error[i])) {
      throw ShapeError("OracleQuality: the error of pixel {} is {}, must be finite and >= 0", i, error[i]);
    }
    if (!(confidence[i] >= 0 && confidence[i] <= 1)) {
      throw ShapeError("OracleQuality: the confidence of pixel {} is {}, must be in 0 .. 1", i, confidence[i]);
    }
  }
}

std::vector<bool> Above(const std::vector<float>& error, float threshold) {
  std::vector<bool> above(error.size());
  for (size_t i = 0; i < error.size(); ++i) above[i] = error[i] > threshold;
  return above;
}

/// Bins with sums instead of means, so that they can be joined.
std::vector<ReliabilityBin> BinSums(const std::vector<float>& error, const std::vector<float>& confidence) {
  std::vector<ReliabilityBin> bins(kReliabilityBins);
  for (int b = 0; b < kReliabilityBins; ++b) {
    bins[b].from = static_cast<double>(b) / kReliabilityBins;
    bins[b].to = static_cast<double>(b + 1) / kReliabilityBins;
  }
  for (size_t i = 0; i < error.size(); ++i) {
    const auto e = static_cast<double>(error[i]), u = static_cast<double>(confidence[i]);
    ReliabilityBin& bin = bins[std::min(static_cast<int>(u * kReliabilityBins), kReliabilityBins - 1)];
    bin.confidence += u;
    bin.error += e;
    bin.similarity += Similarity(e);
    ++bin.share;
  }
  bins.erase(std::remove_if(bins.begin(), bins.end(), [](const ReliabilityBin& bin) { return bin.share == 0; }),
             bins.end());
  return bins;
}

double MeanConfidence(const ReliabilityBin& sums) { return sums.confidence / sums.share; }

ReliabilityBin Joined(const ReliabilityBin& a, const ReliabilityBin& b) {
  return {a.from, b.to, a.confidence + b.confidence, a.error + b.error, a.similarity + b.similarity, a.share + b.share};
}

/// Joins bins, the smallest first, until all are large enough.
std::vector<ReliabilityBin> WithoutSmallBins(std::vector<ReliabilityBin> sums, double smallest) {
  while (sums.size() > 1) {
    const auto small = std::min_element(
        sums.begin(), sums.end(), [](const ReliabilityBin& a, const ReliabilityBin& b) { return a.share < b.share; });
    if (small->share >= smallest) break;
    const bool has_left = small != sums.begin(), has_right = small + 1 != sums.end();
    const bool to_left = has_left && (!has_right || MeanConfidence(*small) - MeanConfidence(*(small - 1)) <
                                                        MeanConfidence(*(small + 1)) - MeanConfidence(*small));
    const auto first = to_left ? small - 1 : small;
    *first = Joined(*first, *(first + 1));
    sums.erase(first + 1);
  }
  return sums;
}

bool ErrorFalls(const std::vector<ReliabilityBin>& sums) {
  if (sums.size() < 2) return false;
  for (size_t b = 1; b < sums.size(); ++b) {
    if (sums[b].error / sums[b].share >= sums[b - 1].error / sums[b - 1].share) return false;
  }
  return true;
}

ReliabilityBin Means(ReliabilityBin sums, double pixels) {
  for (double* sum : {&sums.confidence, &sums.error, &sums.similarity}) *sum /= sums.share;
  sums.share /= pixels;
  return sums;
}

}  // namespace

OracleQuality OracleQuality::FromPixels(const std::vector<float>& error, const std::vector<float>& confidence) {
  CheckPixels(error, confidence);
  const auto n = static_cast<double>(error.size());
  const std::vector<int64_t> by_confidence = RisingOrder(confidence), by_error = RisingOrder(error);
  OracleQuality quality;
  quality.pixels = static_cast<int64_t>(error.size());
  quality.mean_error = std::accumulate(error.begin(), error.end(), 0.0) / n;
  quality.median_error = static_cast<double>(error[by_error[(error.size() - 1) / 2]]);

  if (quality.mean_error > 0) {
    const std::vector<int64_t> worst_first(by_error.rbegin(), by_error.rend());
    const double ideal = SparsificationArea(error, error, worst_first);
    quality.ause = (SparsificationArea(error, confidence, by_confidence) - ideal) / quality.mean_error;
    quality.ause_random = 1 - ideal / quality.mean_error;
  }
  const bool errors_differ = error[by_error.front()] < error[by_error.back()];
  quality.ause_ratio = errors_differ ? quality.ause / quality.ause_random : kNaN;

  const std::vector<double> confidence_ranks = Ranks(confidence);
  quality.spearman = 0 - Correlation(confidence_ranks, Ranks(error));
  quality.auroc_above_median = AurocOfLowRank(confidence_ranks, Above(error, static_cast<float>(quality.median_error)));
  quality.auroc_large_error = AurocOfLowRank(confidence_ranks, Above(error, kLargeError));

  const std::vector<ReliabilityBin> sums = BinSums(error, confidence);
  for (const ReliabilityBin& bin : sums) quality.reliability.push_back(Means(bin, n));
  for (const ReliabilityBin& bin : quality.reliability) {
    quality.calibration_error += bin.share * std::abs(bin.confidence - bin.similarity);
  }
  quality.monotone = ErrorFalls(WithoutSmallBins(sums, kSmallBin * n));
  return quality;
}

nlohmann::json ToJson(const OracleQuality& quality) {
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
  nlohmann::json bins = nlohmann::json::array();
  for (const ReliabilityBin& bin : quality.reliability) {
    bins.push_back({{"from", bin.from},
                    {"to", bin.to},
                    {"confidence", bin.confidence},
                    {"error", bin.error},
                    {"similarity", bin.similarity},
                    {"share", bin.share}});
  }
  return {{"pixels", quality.pixels},
          {"mean_error", quality.mean_error},
          {"ause", quality.ause},
          {"ause_random", quality.ause_random},
          {"ause_ratio", number(quality.ause_ratio)},
          {"spearman", quality.spearman},
          {"median_error", quality.median_error},
          {"auroc_above_median", number(quality.auroc_above_median)},
          {"auroc_large_error", number(quality.auroc_large_error)},
          {"reliability", bins},
          {"calibration_error", quality.calibration_error},
          {"monotone", quality.monotone}};
}

}  // namespace oraclegs

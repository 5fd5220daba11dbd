#include "oraclegs/evaluate/sparsification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/evaluate/rank_statistics.h"

namespace oraclegs {
namespace {

constexpr size_t kSteps = 100;  // of the removed share, in [0, 1)
constexpr double kNoArea = std::numeric_limits<double>::quiet_NaN();
using Curve = std::array<double, kSteps>;

enum class Averaged { kMean, kRootMeanSquare };

/// The error of what is left when 0, 1, ... of kSteps parts of the pixels, the last in the order, are removed.
Curve CurveOf(const std::vector<float>& error, const std::vector<int64_t>& order, Averaged averaged) {
  std::vector<double> sums(error.size() + 1);
  for (size_t k = 0; k < order.size(); ++k) {
    const auto e = static_cast<double>(error[static_cast<size_t>(order[k])]);
    sums[k + 1] = sums[k] + (averaged == Averaged::kMean ? e : e * e);
  }
  Curve curve{};
  for (size_t step = 0; step < kSteps; ++step) {
    const size_t kept = std::max<size_t>(1, error.size() * (kSteps - step) / kSteps);
    const double mean = sums[kept] / static_cast<double>(kept);
    curve[step] = averaged == Averaged::kMean ? mean : std::sqrt(mean);
  }
  return curve;
}

double AreaOf(const std::vector<float>& error, const std::vector<int64_t>& by_doubt, Averaged averaged) {
  if (error.size() != by_doubt.size()) {
    throw ShapeError("PublishedAuse: {} errors of {} pixels", error.size(), by_doubt.size());
  }
  if (error.empty()) return kNoArea;
  const Curve doubted = CurveOf(error, by_doubt, averaged), ideal = CurveOf(error, RisingOrder(error), averaged);
  const double largest =
      std::max(*std::max_element(doubted.begin(), doubted.end()), *std::max_element(ideal.begin(), ideal.end()));
  if (!(largest > 0)) return 0;
  double area = 0;
  for (size_t step = 1; step < kSteps; ++step) {
    area += (doubted[step - 1] - ideal[step - 1] + doubted[step] - ideal[step]) / (2 * kSteps * largest);
  }
  return area;
}

PublishedAuse AuseOf(const PixelErrors& errors, const std::vector<float>& doubt) {
  const std::vector<int64_t> by_doubt = RisingOrder(doubt);
  return {AreaOf(errors.absolute, by_doubt, Averaged::kMean), AreaOf(errors.error, by_doubt, Averaged::kRootMeanSquare),
          AreaOf(errors.dssim, by_doubt, Averaged::kMean)};
}

void Append(const std::vector<float>& more, std::vector<float>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

}  // namespace

double SparsificationArea(const std::vector<float>& error, const std::vector<float>& key,
                          const std::vector<int64_t>& removed) {
  std::vector<double> expected(removed.size());
  ForEachTie(key, removed, [&](int64_t begin, int64_t end) {
    double sum = 0;
    for (int64_t k = begin; k < end; ++k) sum += static_cast<double>(error[removed[k]]);
    std::fill(expected.begin() + begin, expected.begin() + end, sum / static_cast<double>(end - begin));
  });
  double sum = 0, area = 0, kept = 0;
  for (auto e = expected.rbegin(); e != expected.rend(); ++e) {
    sum += *e;
    area += sum / ++kept;
  }
  return area / kept;
}

PublishedAuse PooledAuse(const std::vector<PixelErrors>& images, const std::vector<std::vector<float>>& doubts) {
  PixelErrors all;
  std::vector<float> doubt;
  for (size_t i = 0; i < images.size(); ++i) {
    Append(images[i].error, &all.error);
    Append(images[i].absolute, &all.absolute);
    Append(images[i].dssim, &all.dssim);
    Append(doubts[i], &doubt);
  }
  return AuseOf(all, doubt);
}

PublishedAuse MeanAuse(const std::vector<PixelErrors>& images, const std::vector<std::vector<float>>& doubts) {
  PublishedAuse sum;
  double count = 0;
  for (size_t i = 0; i < images.size(); ++i) {
    if (images[i].at.empty()) continue;
    const PublishedAuse one = AuseOf(images[i], doubts[i]);
    sum.mae += one.mae, sum.rmse += one.rmse, sum.dssim += one.dssim, ++count;
  }
  if (count == 0) return {kNoArea, kNoArea, kNoArea};
  return {sum.mae / count, sum.rmse / count, sum.dssim / count};
}

nlohmann::json ToJson(const PublishedAuse& ause) {
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
  return {{"mae", number(ause.mae)}, {"rmse", number(ause.rmse)}, {"dssim", number(ause.dssim)}};
}

}  // namespace oraclegs

#include "oraclegs/validate/calibrator.h"

#include <algorithm>
#include <cstddef>

#include "oraclegs/core/error.h"
#include "oraclegs/image/similarity.h"

namespace oraclegs {
namespace {

// Error that decides the order of pixels: near the noise of a sensor as well as beyond it.
constexpr float kFineError = 0.02f;

constexpr size_t kSteps = 200;  // groups of neighboring x that are pooled first against noise

struct Pool {
  double x = 0, y = 0, count = 0;  // sums
  double MeanY() const { return y / count; }
};

}  // namespace

void PixelSamples::Append(const PixelSamples& more) {
  columns = more.columns;
  rows.insert(rows.end(), more.rows.begin(), more.rows.end());
  errors.insert(errors.end(), more.errors.begin(), more.errors.end());
}

PixelModel Calibrator::FitOne(const PixelSamples& samples) const {
  const auto rows = static_cast<Eigen::Index>(samples.errors.size());
  const auto columns = static_cast<Eigen::Index>(samples.columns);
  Eigen::MatrixXf features(rows, columns);
  Eigen::VectorXf labels(rows);
  for (Eigen::Index s = 0; s < rows; ++s) {
    const auto i = static_cast<size_t>(s);
    features.row(s) = Eigen::Map<const Eigen::RowVectorXf>(&samples.rows[i * samples.columns], columns);
    labels[s] = (Similarity(samples.errors[i]) + Similarity(samples.errors[i], kFineError)) / 2;
  }
  PixelModel model{Logistic::Fit(features, labels), {}};
  if (rule_ == LevelRule::kAsIs) return model;
  std::vector<std::pair<float, float>> levels;
  for (size_t i = 0; i < samples.errors.size(); ++i) {
    levels.emplace_back(model.order(&samples.rows[i * samples.columns]), Similarity(samples.errors[i]));
  }
  model.level = Isotonic::Fit(std::move(levels));
  return model;
}

void Calibrator::Fit(const std::vector<std::pair<std::string, PixelSamples>>& samples) {
  std::map<std::string, PixelSamples> by_source;
  PixelSamples all;
  for (const auto& [source, of_one] : samples) {
    by_source[source].Append(of_one);
    all.Append(of_one);
  }
  if (all.errors.empty()) {
    throw InputError(
        "no pixel of a training view can be held out and proposed to calibrate the oracle with: masks exclude all of "
        "them; correct the masks, or use --oracle uniform");
  }
  std::erase_if(by_source, [](const auto& entry) { return entry.second.errors.empty(); });
  for (const auto& [source, of_source] : by_source) by_source_[source] = FitOne(of_source);
  if (!any_) any_ = by_source.size() == 1 ? by_source_.begin()->second : FitOne(all);
}

const PixelModel& Calibrator::ModelOf(const std::string& source) const {
  const auto own = by_source_.find(source);
  return own == by_source_.end() ? *any_ : own->second;
}

Isotonic Isotonic::Fit(std::vector<std::pair<float, float>> samples) {
  std::sort(samples.begin(), samples.end());
  std::vector<Pool> pools;
  const size_t group = std::max<size_t>(1, samples.size() / kSteps);
  for (size_t first = 0; first < samples.size();) {
    size_t last = std::min(samples.size(), first + group);
    while (last < samples.size() && samples[last].first == samples[last - 1].first) ++last;
    Pool pool;
    for (; first < last; ++first) {
      pool.x += static_cast<double>(samples[first].first);
      pool.y += static_cast<double>(samples[first].second);
      pool.count += 1;
    }
    while (!pools.empty() && pools.back().MeanY() >= pool.MeanY()) {
      pool.x += pools.back().x, pool.y += pools.back().y, pool.count += pools.back().count;
      pools.pop_back();
    }
    pools.push_back(pool);
  }
  Isotonic map;
  for (const Pool& pool : pools) {
    map.x_.push_back(static_cast<float>(pool.x / pool.count));
    map.y_.push_back(static_cast<float>(pool.MeanY()));
  }
  return map;
}

float Isotonic::operator()(float x) const {
  if (x_.empty()) return x;
  const auto above = std::upper_bound(x_.begin(), x_.end(), x);
  if (above == x_.begin()) return y_.front();
  if (above == x_.end()) return y_.back();
  const auto k = static_cast<size_t>(above - x_.begin());
  const float t = (x - x_[k - 1]) / (x_[k] - x_[k - 1]);
  return (1 - t) * y_[k - 1] + t * y_[k];
}

}  // namespace oraclegs

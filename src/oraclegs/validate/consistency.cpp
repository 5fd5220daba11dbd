#include "oraclegs/validate/consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/image/color_error.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxSamples = 36000;  // samples of one source, over all held-out views
constexpr float kAlike = 0.1f;         // error of a pixel that says how much brighter a proposal is

/// Held-out view, and the exposure gain that is removed from its colors.
struct Truth {
  const LoadedView& view;
  Eigen::Vector3f gain;
};

/// Pixel `i` of the truth in the mean exposure, which proposals have.
std::array<float, 3> TrueColor(const Truth& truth, size_t i) {
  std::array<float, 3> color;
  for (size_t c = 0; c < 3; ++c) {
    color[c] = std::min(1.f, truth.view.rgb.data[3 * i + c] / truth.gain[static_cast<Eigen::Index>(c)]);
  }
  return color;
}

/// The truth with the mean gain that the proposal still has over it, where the two are alike: exposure is no error.
Truth Aligned(Truth truth, const ImageF& proposal) {
  Eigen::Vector3d shown(0, 0, 0), expected(0, 0, 0);
  for (size_t i = 0; i < truth.view.rgb.data.size() / 3; ++i) {
    if (!truth.view.mask.empty() && truth.view.mask[i] == 0) continue;
    const std::array<float, 3> color = TrueColor(truth, i);
    if (ColorError(&proposal.data[3 * i], color.data()) > kAlike) continue;
    for (Eigen::Index c = 0; c < 3; ++c) {
      shown[c] += static_cast<double>(proposal.data[3 * i + static_cast<size_t>(c)]);
      expected[c] += static_cast<double>(color[static_cast<size_t>(c)]);
    }
  }
  for (Eigen::Index c = 0; c < 3; ++c) {
    if (shown[c] > 0 && expected[c] > 0) truth.gain[c] *= static_cast<float>(expected[c] / shown[c]);
  }
  return truth;
}

/// Samples of at most so many evenly spaced, unmasked pixels of the view, in the mean exposure, which proposals have.
PixelSamples SamplesOf(const Proposal& proposal, const PixelRows& rows, const Truth& truth, size_t limit) {
  PixelSamples samples;
  samples.columns = rows.columns();
  const size_t pixels = rows.size();
  PixelRows::Space space;
  // An odd stride, so that samples do not all lie in the same columns.
  const size_t stride = std::max<size_t>(1, pixels / std::max<size_t>(1, limit)) | 1;
  for (size_t i = 0; i < pixels; i += stride) {
    if (!truth.view.mask.empty() && truth.view.mask[i] == 0) continue;
    const float* row = rows.Row(i, &space);
    samples.rows.insert(samples.rows.end(), row, row + samples.columns);
    const std::array<float, 3> color = TrueColor(truth, i);
    samples.errors.push_back(ColorError(&proposal.rgb.data[3 * i], color.data()));
  }
  return samples;
}

constexpr int kReach = 2;
constexpr std::array<float, 2 * kReach + 1> kTaps = {1, 4, 6, 4, 1};

/// Smooths `length` values that are `step` apart; `copy` is scratch of that length.
void SmoothLine(float* values, int length, size_t step, std::vector<float>* copy) {
  for (int i = 0; i < length; ++i) (*copy)[static_cast<size_t>(i)] = values[static_cast<size_t>(i) * step];
  for (int i = 0; i < length; ++i) {
    float sum = 0, taps = 0;
    for (int k = std::max(0, i - kReach); k <= std::min(length - 1, i + kReach); ++k) {
      const float tap = kTaps[static_cast<size_t>(k - i + kReach)];
      sum += tap * (*copy)[static_cast<size_t>(k)];
      taps += tap;
    }
    values[static_cast<size_t>(i) * step] = sum / taps;
  }
}

}  // namespace

void ConsistencyOracle::Calibrate(const std::vector<Query>& held_out) {
  Calibrate(held_out, features_.SecondMaps(held_out));
}

std::vector<ConfidenceMap> ConsistencyOracle::CalibrateAndPredict(const std::vector<Query>& held_out) {
  const std::vector<ConfidenceMap> second = features_.SecondMaps(held_out);
  Calibrate(held_out, second);
  return Predict(held_out, second);
}

std::vector<ConfidenceMap> ConsistencyOracle::Predict(const std::vector<Query>& queries) const {
  if (!calibrator_.fitted()) throw UsageError("the {} oracle needs held-out views to learn from", name());
  return Predict(queries, features_.SecondMaps(queries));
}

std::vector<std::pair<std::string, PixelSamples>> ConsistencyOracle::Sample(const std::vector<Query>& held_out,
                                                                            size_t limit) const {
  return Sample(held_out, features_.SecondMaps(held_out), [limit](const Query&) { return limit; });
}

void ConsistencyOracle::Calibrate(const std::vector<Query>& held_out, const std::vector<ConfidenceMap>& second) {
  std::map<std::string, size_t> count;
  for (const Query& query : held_out) ++count[query.proposal.source];
  calibrator_.Fit(
      Sample(held_out, second, [&](const Query& query) { return kMaxSamples / count.at(query.proposal.source); }));
}

std::vector<std::pair<std::string, PixelSamples>> ConsistencyOracle::Sample(
    const std::vector<Query>& held_out, const std::vector<ConfidenceMap>& second,
    FunctionRef<size_t(const Query&)> limit) const {
  std::vector<std::pair<std::string, PixelSamples>> samples;
  for (const Query& query : held_out) {
    if (!query.held_out) throw ShapeError("{}: no view is held out to calibrate with", query.proposal.name);
    samples.push_back({query.proposal.source, {}});
  }
  features_.ForEach(held_out, second, [&](size_t q, const PixelRows& rows) {
    const auto view = static_cast<size_t>(*held_out[q].held_out);
    samples[q].second =
        SamplesOf(held_out[q].proposal, rows,
                  Aligned({views_[view], features_.warper().Gain(view)}, held_out[q].proposal.rgb), limit(held_out[q]));
  });
  return samples;
}

std::vector<ConfidenceMap> ConsistencyOracle::Predict(const std::vector<Query>& queries,
                                                      const std::vector<ConfidenceMap>& second) const {
  std::vector<ConfidenceMap> maps(queries.size());
  features_.ForEach(queries, second, [&](size_t q, const PixelRows& rows) {
    const PixelModel& model = calibrator_.ModelOf(queries[q].proposal.source);
    PixelRows::Space space;
    ConfidenceMap& map = maps[q];
    for (size_t i = 0; i < rows.size(); ++i) map.push_back(model.order(rows.Row(i, &space)));
    const Camera& camera = queries[q].proposal.camera;
    if (features_.ReadsImages()) Smooth(camera.width, camera.height, &map);
    for (float& confidence : map) confidence = model.level(confidence);
  });
  return maps;
}

void Smooth(int width, int height, ConfidenceMap* map) {
  const auto columns = static_cast<size_t>(width), rows = static_cast<size_t>(height);
  if (map->size() != columns * rows) {
    throw ShapeError("Smooth: the map has {} pixels, expected {} x {}", map->size(), width, height);
  }
  std::vector<float> copy(std::max(columns, rows));
  for (size_t y = 0; y < rows; ++y) SmoothLine(map->data() + y * columns, width, 1, &copy);
  for (size_t x = 0; x < columns; ++x) SmoothLine(map->data() + x, height, columns, &copy);
}

}  // namespace oraclegs

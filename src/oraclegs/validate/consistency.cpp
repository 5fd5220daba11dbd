#include "oraclegs/validate/consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/validate/smooth.h"

namespace oraclegs {
namespace {

constexpr float kGoodError = 0.08f;
// What orders the pixels: near the noise of a sensor as well as beyond it.
constexpr float kFineError = 0.02f;
constexpr size_t kSamples = 36000;  // of a source, over all hidden photographs

float Likeness(float error, float scale) { return std::exp(-(error / scale) * (error / scale)); }

float ColorError(const float* a, const float* b) {
  float squares = 0;
  for (int c = 0; c < 3; ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(squares / 3);
}

/// The different (photograph, camera) among proposals: candidates for one view share its warp.
std::vector<std::vector<size_t>> GroupByView(const std::vector<HiddenPhotograph>& hidden) {
  std::vector<std::vector<size_t>> groups;
  for (size_t h = 0; h < hidden.size(); ++h) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const std::vector<size_t>& group) {
      const HiddenPhotograph& other = hidden[group.front()];
      const Camera &a = other.proposal.camera, &b = hidden[h].proposal.camera;
      return other.photograph == hidden[h].photograph && a.width == b.width && a.height == b.height && a.fx == b.fx &&
             a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.cam_from_world.matrix() == b.cam_from_world.matrix();
    });
    if (same == groups.end()) {
      groups.push_back({h});
    } else {
      same->push_back(h);
    }
  }
  return groups;
}

/// What is known of each pixel of a proposal, as one row of numbers.
class PixelRows {
 public:
  static constexpr size_t kMost = kFeatures + 1;

  /// Either may be empty.
  PixelRows(std::vector<Features> features, const ConfidenceMap& second)
      : features_(std::move(features)), second_(second) {}

  size_t size() const { return features_.empty() ? second_.size() : features_.size(); }
  size_t columns() const { return (features_.empty() ? 0 : kFeatures) + (second_.empty() ? 0 : 1); }
  /// The row, in `space` where it does not stand anywhere as a whole.
  const float* Row(size_t pixel, std::array<float, kMost>* space) const {
    if (features_.empty()) return &second_[pixel];
    if (second_.empty()) return features_[pixel].data();
    *std::copy(features_[pixel].begin(), features_[pixel].end(), space->begin()) = second_[pixel];
    return space->data();
  }

 private:
  std::vector<Features> features_;
  const ConfidenceMap& second_;
};

/// A photograph whose exposure colours are freed of.
struct Truth {
  const LoadedView& photo;
  Eigen::Vector3f gain;
};

}  // namespace

struct ConsistencyOracle::Samples {
  size_t columns = 0;
  std::vector<float> rows;  ///< samples * columns
  std::vector<float> errors;

  void Append(const Samples& more) {
    columns = more.columns;
    rows.insert(rows.end(), more.rows.begin(), more.rows.end());
    errors.insert(errors.end(), more.errors.begin(), more.errors.end());
  }

  /// Evenly spread pixels of the photograph that count, in the mean exposure, which proposals have.
  static Samples Of(const Proposal& proposal, const PixelRows& rows, const Truth& truth_of, size_t most) {
    Samples samples;
    samples.columns = rows.columns();
    const auto& [photo, gain] = truth_of;
    const size_t pixels = rows.size();
    std::array<float, PixelRows::kMost> space;
    // An odd stride, lest every sample stand in the same columns.
    const size_t stride = std::max<size_t>(1, pixels / std::max<size_t>(1, most)) | 1;
    for (size_t i = 0; i < pixels; i += stride) {
      if (!photo.mask.empty() && photo.mask[i] == 0) continue;
      const float* row = rows.Row(i, &space);
      samples.rows.insert(samples.rows.end(), row, row + samples.columns);
      const float* shown = &photo.rgb.data[3 * i];
      const std::array<float, 3> truth = {std::min(1.f, shown[0] / gain[0]), std::min(1.f, shown[1] / gain[1]),
                                          std::min(1.f, shown[2] / gain[2])};
      samples.errors.push_back(ColorError(&proposal.rgb.data[3 * i], truth.data()));
    }
    return samples;
  }
};

float Goodness(float error) { return Likeness(error, kGoodError); }

std::string ConsistencyOracle::name() const {
  if (!second_) return "consistency";
  return ReadsPhotographs() ? second_->name() + "+consistency" : second_->name();
}

/// None where the second oracle is asked alone.
std::vector<Features> ConsistencyOracle::FeaturesAt(const HiddenPhotograph& hidden, const WarpedView& warped) const {
  return ReadsPhotographs() ? FeaturesOf(hidden.proposal, warped) : std::vector<Features>();
}

/// Calls take(h, warped) for each, views in parallel.
template <class Take>
void ConsistencyOracle::ForEach(const std::vector<HiddenPhotograph>& hidden, const Take& take) const {
  const std::vector<std::vector<size_t>> groups = GroupByView(hidden);
  ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t g) {
    ThrowIfInterrupted();
    const std::vector<size_t>& group = groups[static_cast<size_t>(g)];
    const HiddenPhotograph& first = hidden[group.front()];
    const WarpedView warped = ReadsPhotographs() ? warper_.Warp(first.proposal.camera, first.photograph) : WarpedView();
    for (const size_t h : group) take(h, warped);
  });
}

void ConsistencyOracle::Look(std::vector<HiddenPhotograph>* hidden) const {
  if (!second_) return;
  std::vector<ConfidenceMap> maps = second_->Judge(*hidden);
  for (size_t h = 0; h < maps.size(); ++h) (*hidden)[h].second = std::move(maps[h]);
}

/// Those that were asked for before, or all of them now; empty ones without a second oracle.
std::vector<ConfidenceMap> ConsistencyOracle::SecondMaps(const std::vector<HiddenPhotograph>& hidden) const {
  if (!second_) return std::vector<ConfidenceMap>(hidden.size());
  std::vector<ConfidenceMap> maps;
  for (const HiddenPhotograph& h : hidden) maps.push_back(h.second);
  const bool asked = std::none_of(maps.begin(), maps.end(), [](const ConfidenceMap& map) { return map.empty(); });
  return asked ? maps : second_->Judge(hidden);
}

ConsistencyOracle::Model ConsistencyOracle::Fit(const Samples& samples) const {
  const auto rows = static_cast<Eigen::Index>(samples.errors.size());
  const auto columns = static_cast<Eigen::Index>(samples.columns);
  Eigen::MatrixXf features(rows, columns);
  Eigen::VectorXf labels(rows);
  for (Eigen::Index s = 0; s < rows; ++s) {
    const auto i = static_cast<size_t>(s);
    features.row(s) = Eigen::Map<const Eigen::RowVectorXf>(&samples.rows[i * samples.columns], columns);
    labels[s] = (Likeness(samples.errors[i], kGoodError) + Likeness(samples.errors[i], kFineError)) / 2;
  }
  Model model{Logistic::Fit(features, labels), {}};
  if (!finds_level_) return model;
  std::vector<std::pair<float, float>> levels;
  for (size_t i = 0; i < samples.errors.size(); ++i) {
    levels.emplace_back(model.order(&samples.rows[i * samples.columns]), Goodness(samples.errors[i]));
  }
  model.level = Isotonic::Fit(std::move(levels));
  return model;
}

void ConsistencyOracle::Learn(const std::vector<HiddenPhotograph>& hidden) {
  std::map<std::string, size_t> count;
  for (const HiddenPhotograph& one : hidden) ++count[one.proposal.source];
  const std::vector<ConfidenceMap> second = SecondMaps(hidden);
  std::vector<Samples> samples(hidden.size());
  ForEach(hidden, [&](size_t h, const WarpedView& warped) {
    const auto v = static_cast<size_t>(hidden[h].photograph);
    samples[h] = Samples::Of(hidden[h].proposal, PixelRows(FeaturesAt(hidden[h], warped), second[h]),
                             {photos_[v], warper_.Gain(v)}, kSamples / count.at(hidden[h].proposal.source));
  });
  std::map<std::string, Samples> by_source;
  Samples all;
  for (size_t h = 0; h < hidden.size(); ++h) {
    by_source[hidden[h].proposal.source].Append(samples[h]);
    all.Append(samples[h]);
  }
  if (all.errors.empty()) {
    throw InputError(
        "no pixel of a training photograph can be hidden and proposed to learn from: masks exclude all of them; mend "
        "the masks, or use --oracle uniform");
  }
  std::erase_if(by_source, [](const auto& entry) { return entry.second.errors.empty(); });
  for (const auto& [source, of_source] : by_source) by_source_[source] = Fit(of_source);
  if (!any_) any_ = by_source.size() == 1 ? by_source_.begin()->second : Fit(all);
}

std::vector<ConfidenceMap> ConsistencyOracle::Judge(const std::vector<HiddenPhotograph>& hidden) const {
  if (!any_) throw UsageError("the {} oracle needs hidden photographs to learn from", name());
  const std::vector<ConfidenceMap> second = SecondMaps(hidden);
  std::vector<ConfidenceMap> maps(hidden.size());
  ForEach(hidden, [&](size_t h, const WarpedView& warped) {
    const auto own = by_source_.find(hidden[h].proposal.source);
    const Model& model = own == by_source_.end() ? *any_ : own->second;
    const PixelRows rows(FeaturesAt(hidden[h], warped), second[h]);
    std::array<float, PixelRows::kMost> space;
    ConfidenceMap& map = maps[h];
    for (size_t i = 0; i < rows.size(); ++i) map.push_back(model.order(rows.Row(i, &space)));
    const Camera& camera = hidden[h].proposal.camera;
    if (ReadsPhotographs()) Smooth(camera.width, camera.height, &map);
    for (float& trust : map) trust = model.level(trust);
  });
  return maps;
}

}  // namespace oraclegs

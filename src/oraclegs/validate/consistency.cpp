#include "oraclegs/validate/consistency.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/validate/features.h"

namespace oraclegs {
namespace {

constexpr float kGoodError = 0.08f;
// What orders the pixels: near the noise of a sensor as well as beyond it.
constexpr float kFineError = 0.02f;
constexpr size_t kSamples = 12000;  // of a source, over all hidden photographs

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

/// Calls take(h, warped) for each, views in parallel.
template <class Take>
void ForEachWarped(const Warper& warper, const std::vector<HiddenPhotograph>& hidden, const Take& take) {
  const std::vector<std::vector<size_t>> groups = GroupByView(hidden);
  ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t g) {
    ThrowIfInterrupted();
    const std::vector<size_t>& group = groups[static_cast<size_t>(g)];
    const HiddenPhotograph& first = hidden[group.front()];
    const WarpedView warped = warper.Warp(first.proposal.camera, first.photograph);
    for (const size_t h : group) take(h, warped);
  });
}

}  // namespace

struct ConsistencyOracle::Samples {
  std::vector<Features> features;
  std::vector<float> errors;

  void Append(const Samples& more) {
    features.insert(features.end(), more.features.begin(), more.features.end());
    errors.insert(errors.end(), more.errors.begin(), more.errors.end());
  }

  /// Evenly spread pixels of the photograph that count, in the mean exposure, which proposals have.
  static Samples Of(const Proposal& proposal, const WarpedView& warped, const Photo& photo, const Eigen::Vector3f& gain,
                    size_t most) {
    Samples samples;
    const std::vector<Features> features = FeaturesOf(proposal, warped);
    // An odd stride, lest every sample stand in the same columns.
    const size_t stride = std::max<size_t>(1, features.size() / std::max<size_t>(1, most)) | 1;
    for (size_t i = 0; i < features.size(); i += stride) {
      if (!photo.mask.empty() && photo.mask[i] == 0) continue;
      samples.features.push_back(features[i]);
      const float* shown = &photo.rgb.data[3 * i];
      const std::array<float, 3> truth = {std::min(1.f, shown[0] / gain[0]), std::min(1.f, shown[1] / gain[1]),
                                          std::min(1.f, shown[2] / gain[2])};
      samples.errors.push_back(ColorError(&proposal.rgb.data[3 * i], truth.data()));
    }
    return samples;
  }
};

float Goodness(float error) { return Likeness(error, kGoodError); }

ConsistencyOracle::Model ConsistencyOracle::Fit(const Samples& samples) {
  const auto rows = static_cast<Eigen::Index>(samples.errors.size());
  Eigen::MatrixXf features(rows, static_cast<Eigen::Index>(kFeatures));
  Eigen::VectorXf labels(rows);
  for (Eigen::Index s = 0; s < rows; ++s) {
    const auto i = static_cast<size_t>(s);
    features.row(s) =
        Eigen::Map<const Eigen::RowVectorXf>(samples.features[i].data(), static_cast<Eigen::Index>(kFeatures));
    labels[s] = (Likeness(samples.errors[i], kGoodError) + Likeness(samples.errors[i], kFineError)) / 2;
  }
  Model model{Logistic::Fit(features, labels), {}};
  std::vector<std::pair<float, float>> levels;
  for (size_t i = 0; i < samples.errors.size(); ++i) {
    levels.emplace_back(model.order(samples.features[i].data()), Goodness(samples.errors[i]));
  }
  model.level = Isotonic::Fit(std::move(levels));
  return model;
}

void ConsistencyOracle::Learn(const std::vector<HiddenPhotograph>& hidden) {
  std::map<std::string, size_t> count;
  for (const HiddenPhotograph& one : hidden) ++count[one.proposal.source];
  std::vector<Samples> samples(hidden.size());
  ForEachWarped(warper_, hidden, [&](size_t h, const WarpedView& warped) {
    const auto v = static_cast<size_t>(hidden[h].photograph);
    samples[h] = Samples::Of(hidden[h].proposal, warped, photos_[v], warper_.Gain(v),
                             kSamples / count.at(hidden[h].proposal.source));
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
        "the "
        "masks, or use --confidence uniform");
  }
  std::erase_if(by_source, [](const auto& entry) { return entry.second.errors.empty(); });
  for (const auto& [source, of_source] : by_source) by_source_[source] = Fit(of_source);
  if (!any_) any_ = by_source.size() == 1 ? by_source_.begin()->second : Fit(all);
}

std::vector<ConfidenceMap> ConsistencyOracle::Judge(const std::vector<HiddenPhotograph>& hidden) const {
  if (!any_) throw UsageError("the consistency oracle needs hidden photographs to learn from");
  std::vector<ConfidenceMap> maps(hidden.size());
  ForEachWarped(warper_, hidden, [&](size_t h, const WarpedView& warped) {
    const auto own = by_source_.find(hidden[h].proposal.source);
    const Model& model = own == by_source_.end() ? *any_ : own->second;
    for (const Features& f : FeaturesOf(hidden[h].proposal, warped))
      maps[h].push_back(model.level(model.order(f.data())));
  });
  return maps;
}

std::vector<ConfidenceMap> ConsistencyOracle::Validate(const std::vector<Proposal>& proposals) const {
  std::vector<HiddenPhotograph> none_hidden;
  for (const Proposal& p : proposals) none_hidden.push_back({-1, p});
  return Judge(none_hidden);
}

}  // namespace oraclegs

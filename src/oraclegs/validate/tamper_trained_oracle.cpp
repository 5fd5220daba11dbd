#include "oraclegs/validate/tamper_trained_oracle.h"

#include <algorithm>
#include <array>
#include <utility>

#include "oraclegs/core/parallel.h"
#include "oraclegs/propose/options.h"
#include "oraclegs/validate/tamper.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxLearnedViews = 24;
constexpr size_t kViewsTogether = 4;                      // whose samples are held at once
constexpr size_t kMaxPixels = 60000;                      // over all samples
constexpr size_t kSamplesOfView = 4;                      // of a view
constexpr double kMinTampered = 0.1, kMaxTampered = 0.6;  // share of a sample's pixels
constexpr double kWrongScale = 1.3;
constexpr const char* kTampered = "tampered";

/// The image in the mean exposure, which proposals have.
ImageF WithoutGain(const LoadedView& view, const Eigen::Vector3f& gain) {
  ImageF image = view.rgb;
  for (size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = std::min(1.f, image.data[i] / gain[static_cast<Eigen::Index>(i % 3)]);
  }
  return image;
}

ImageF Mean(const ImageF& a, const ImageF& b) {
  ImageF mean = a;
  for (size_t i = 0; i < mean.data.size(); ++i) mean.data[i] = (a.data[i] + b.data[i]) / 2;
  return mean;
}

/// `image` over the whole of a picture of this size.
ImageF Resized(const ImageF& image, int width, int height) {
  return image.width == width && image.height == height ? image : ResizeArea(image, width, height);
}

/// Pictures that do not show what the view shows: of another view, upside down, and of another scale.
std::array<ImageF, 3> WrongPictures(const ImageF& truth, const ImageF& other) {
  return {Resized(other, truth.width, truth.height), UpsideDown(truth), Zoomed(truth, kWrongScale)};
}

const Proposal* OfSource(const std::vector<Proposal>& candidates, const char* source) {
  const auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](const Proposal& p) { return p.source == source; });
  return found == candidates.end() ? nullptr : &*found;
}

/// A held-out view with its image and what is proposed for it.
struct HeldOutView {
  const LoadedView& view;
  int index;
  ImageF truth, other;                      ///< its image and that of another view, in the mean exposure
  const std::vector<Proposal>& candidates;  ///< not empty
  ImageF proxy_render;
};

/// Training samples of a view: its image, what is proposed and the mean of both, each tampered, and a wrong picture.
std::vector<Query> SamplesOf(const HeldOutView& known, uint64_t seed) {
  const ImageF &first = known.candidates.front().rgb, &last = known.candidates.back().rgb;
  const std::array<ImageF, kSamplesOfView - 1> bases = {known.truth, last, Mean(known.truth, first)};
  std::vector<Query> samples_of_views;
  const auto add = [&](ImageF rgb) {
    samples_of_views.push_back(
        {{known.view.name, kTampered, known.view.camera, std::move(rgb)}, known.index, known.proxy_render});
  };
  for (size_t b = 0; b < bases.size(); ++b) {
    Rng rng(seed, RandomStream::kTampering, (static_cast<uint64_t>(known.index) * kSamplesOfView + b) << 32);
    const double share = rng.Uniform(kMinTampered, kMaxTampered);
    add(Tamper(bases[b], known.other, share, &rng).rgb);
  }
  add(WrongPictures(known.truth, known.other)[static_cast<size_t>(known.index) % 3]);
  return samples_of_views;
}

}  // namespace

std::vector<size_t> LearnedViews(size_t views) {
  const size_t count = std::min(views, kMaxLearnedViews);
  std::vector<size_t> picked;
  for (size_t i = 0; i < count; ++i) picked.push_back(i * views / count);
  return picked;
}

size_t TamperTrainedOracle::TrainingSamples(size_t views) { return LearnedViews(views).size() * kSamplesOfView; }

TamperTrainedOracle::TamperTrainedOracle(const FeatureSource& features, const Proposers& proposers,
                                         const HeldOutCandidates& held_out, LevelRule rule, uint64_t seed)
    : features_(features.Thorough()), proposers_(proposers), oracle_(features_, held_out.views, rule) {
  Learn(held_out, seed);
}

void TamperTrainedOracle::Learn(const HeldOutCandidates& held_out, uint64_t seed) {
  const std::vector<size_t> picked = LearnedViews(held_out.views.size());
  const Warper& warper = features_.warper();
  const size_t limit = kMaxPixels / (picked.size() * kSamplesOfView);
  std::vector<std::pair<std::string, PixelSamples>> samples;
  std::vector<double> right, wrong;
  for (size_t begin = 0; begin < picked.size(); begin += kViewsTogether) {
    const size_t count = std::min(kViewsTogether, picked.size() - begin);
    std::vector<std::vector<Query>> samples_of_views(count);
    std::vector<std::vector<std::optional<double>>> agreement(count);
    ParallelFor(static_cast<int64_t>(count), [&](int64_t i) {
      const size_t v = picked[begin + static_cast<size_t>(i)];
      const size_t w = (v + std::max<size_t>(1, held_out.views.size() / 2)) % held_out.views.size();
      const std::vector<Proposal>& candidates = held_out.candidates[v];
      const Proposal* proxy_render = OfSource(candidates, kProxiesWord);
      if (candidates.empty() || (proposers_.has_proxy_models() && !proxy_render)) return;
      const LoadedView& view = held_out.views[v];
      const HeldOutView known{view,
                              static_cast<int>(v),
                              WithoutGain(view, warper.Gain(v)),
                              WithoutGain(held_out.views[w], warper.Gain(w)),
                              candidates,
                              proxy_render ? proxy_render->rgb : ImageF()};
      samples_of_views[static_cast<size_t>(i)] = SamplesOf(known, seed);
      const WarpedView warped = warper.Warp(view.camera, known.index);
      std::vector<std::optional<double>>& of_view = agreement[static_cast<size_t>(i)];
      of_view.push_back(Agreement(known.truth, warped));
      for (const ImageF& picture : WrongPictures(known.truth, known.other)) {
        of_view.push_back(Agreement(picture, warped));
      }
    });
    std::vector<Query> queries;
    for (std::vector<Query>& of_view : samples_of_views) {
      std::move(of_view.begin(), of_view.end(), std::back_inserter(queries));
    }
    for (const auto& of_view : agreement) {
      for (size_t k = 0; k < of_view.size(); ++k) {
        if (of_view[k]) (k == 0 ? right : wrong).push_back(*of_view[k]);
      }
    }
    for (auto& sample : oracle_.Sample(queries, limit)) samples.push_back(std::move(sample));
  }
  oracle_.Fit(samples);
  check_.Learn(std::move(right), std::move(wrong));
}

std::vector<ConfidenceMap> TamperTrainedOracle::Predict(const std::vector<Proposal>& proposals) const {
  std::vector<Query> queries;
  for (const Proposal& p : proposals) {
    Query query{{p.name, kTampered, p.camera, p.rgb}};  // nothing else that it may say of itself
    if (const auto proxy_render = proposers_.ProxyRender({p.name, p.camera})) query.proxy_render = proxy_render->rgb;
    queries.push_back(std::move(query));
  }
  std::vector<ConfidenceMap> confidence = oracle_.Predict(queries);
  ParallelFor(static_cast<int64_t>(proposals.size()), [&](int64_t i) {
    const Proposal& p = proposals[static_cast<size_t>(i)];
    ConfidenceMap& map = confidence[static_cast<size_t>(i)];
    if (check_.Rejects(Agreement(p.rgb, features_.warper().Warp(p.camera)))) std::fill(map.begin(), map.end(), 0.f);
  });
  return confidence;
}

}  // namespace oraclegs

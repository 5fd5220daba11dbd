#include "oraclegs/train/mcmc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/outliers.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

constexpr int64_t kMcmcGrain = 4096;

std::vector<double> Opacities(const Gaussians& gaussians) {
  std::vector<double> opacities(gaussians.size());
  const float* logits = gaussians.opacity_logits.data();
  ParallelBlocks(gaussians.size(), kMcmcGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) opacities[i] = OpacityOf(logits[i]);
  });
  return opacities;
}

/// Draws indices with probability proportional to their weights.
class WeightedDraw {
 public:
  /// Takes the weights. Zero, negative and NaN ones are never drawn.
  WeightedDraw(const std::vector<double>& weights, uint64_t seed, RandomStream stream, int64_t iteration)
      : seed_(seed), stream_(stream), counter_(static_cast<uint64_t>(iteration) << 32) {
    double sum = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
      if (!(weights[i] > 0)) continue;
      sum += weights[i];
      sums_.push_back(sum);
      indices_.push_back(static_cast<int64_t>(i));
    }
  }

  bool empty() const { return sums_.empty(); }

  /// The draw of this number; a pure function of seed, stream, iteration and number.
  int64_t operator()(int64_t number) const {
    const double u = DrawUniform(seed_, stream_, counter_ | static_cast<uint64_t>(number));
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), u * sums_.back());
    return indices_[std::min<size_t>(found - sums_.begin(), sums_.size() - 1)];
  }

 private:
  uint64_t seed_;
  RandomStream stream_;
  uint64_t counter_;
  std::vector<double> sums_;
  std::vector<int64_t> indices_;
};

/// sources[k] = the draw numbered k.
std::vector<int64_t> DrawSources(const WeightedDraw& draw, int64_t count) {
  std::vector<int64_t> sources(count);
  ParallelBlocks(count, kMcmcGrain, [&](int64_t begin, int64_t end) {
    for (int64_t k = begin; k < end; ++k) sources[k] = draw(k);
  });
  return sources;
}

void CopyRow(Gaussians* gaussians, int64_t from, int64_t to) {
  gaussians->ForEach([&](const char*, Buffer<float>& t) {
    const int64_t row = t.count() / t.size(0);
    float* data = t.data();
    std::memcpy(data + to * row, data + from * row, row * sizeof(float));
  });
}

void ZeroMoments(Adam* adam, int64_t at) {
  adam->ForEachMoment([&](const char*, const char*, auto& t) {
    const int64_t row = t.shape().row();
    std::memset(t.data() + at * row, 0, row * sizeof(t[0]));
  });
}

/// Gives every drawn source its new opacity and scale and zero moments, then makes Gaussian copies[k] a copy of
/// sources[k].
struct Sharing {
  const std::vector<double>& opacities;
  const std::vector<int64_t>& sources;
  const std::vector<int64_t>& copies;
};
void Share(const Sharing& sharing, Gaussians* gaussians, Adam* adam) {
  std::vector<int> draws(sharing.opacities.size(), 0);
  for (const int64_t source : sharing.sources) ++draws[source];
  float* logits = gaussians->opacity_logits.data();
  float* log_scales = gaussians->log_scales.data();
  ParallelBlocks(static_cast<int64_t>(draws.size()), kMcmcGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      if (draws[i] == 0) continue;
      const Relocated relocated = Relocate(sharing.opacities[i], 1 + draws[i]);
      logits[i] = static_cast<float>(LogitOf(relocated.opacity));
      const double shrink = std::log(relocated.scale_ratio);
      for (int axis = 0; axis < 3; ++axis) log_scales[3 * i + axis] += static_cast<float>(shrink);
      ZeroMoments(adam, i);
    }
  });
  // Copies are distinct and none is a source.
  ParallelBlocks(static_cast<int64_t>(sharing.sources.size()), kMcmcGrain, [&](int64_t begin, int64_t end) {
    for (int64_t k = begin; k < end; ++k) CopyRow(gaussians, sharing.sources[k], sharing.copies[k]);
  });
}

void CheckSizes(const char* who, const Gaussians& gaussians, const Adam& adam) {
  gaussians.Check(who);
  adam.Check(who, gaussians.size());
}

class McmcDensifier final : public Densifier {
 public:
  explicit McmcDensifier(const DensifierSetup& setup) : options_(setup.options), plan_(setup.plan) {}

  bool AddsNoise() const override { return true; }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    if (options_.prune_floaters) PruneFloaters(plan_.photos(), gaussians);
    RelocateDead(iteration.seed, iteration.number, gaussians, &model->adam);
    AddGaussians(iteration.seed, iteration.number, options_.max_gaussians, gaussians, &model->adam);
    AddNoise({iteration.seed, iteration.number, iteration.rates.means}, gaussians);
  }

 private:
  const TrainOptions& options_;
  const LossPlan& plan_;
};

}  // namespace

const BinomialTable& Binomials() {
  static const BinomialTable table = [] {
    BinomialTable t{};
    for (int n = 0; n <= kMaxCopies; ++n) {
      t[n][0] = 1;
      for (int k = 1; k <= n; ++k) t[n][k] = t[n - 1][k - 1] + t[n - 1][k];
    }
    return t;
  }();
  return table;
}

Relocated Relocate(double opacity, int n) {
  n = std::clamp(n, 1, kMaxCopies);
  return RelocateBy(opacity, n, Binomials()[n].data());
}

int64_t RelocateDead(uint64_t seed, int64_t iteration, Gaussians* gaussians, Adam* adam) {
  CheckSizes("RelocateDead", *gaussians, *adam);
  const std::vector<double> opacities = Opacities(*gaussians);
  std::vector<double> weights = opacities;
  std::vector<int64_t> dead;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > static_cast<double>(kDeadOpacity)) continue;
    weights[i] = 0;
    dead.push_back(static_cast<int64_t>(i));
  }
  const WeightedDraw draw(weights, seed, RandomStream::kRelocate, iteration);
  if (dead.empty() || draw.empty()) return 0;
  const std::vector<int64_t> sources = DrawSources(draw, static_cast<int64_t>(dead.size()));
  Share({opacities, sources, dead}, gaussians, adam);
  return static_cast<int64_t>(dead.size());
}

int64_t AddGaussians(uint64_t seed, int64_t iteration, int64_t max_gaussians, Gaussians* gaussians, Adam* adam) {
  CheckSizes("AddGaussians", *gaussians, *adam);
  const int64_t n = gaussians->size();
  const int64_t added = GrowthOf(n, max_gaussians);
  if (added == 0) return 0;
  const std::vector<double> opacities = Opacities(*gaussians);
  const WeightedDraw draw(opacities, seed, RandomStream::kAdd, iteration);
  if (draw.empty()) return 0;
  const std::vector<int64_t> sources = DrawSources(draw, added);
  std::vector<int64_t> copies(added);
  for (int64_t k = 0; k < added; ++k) copies[k] = n + k;
  gaussians->ForEach([&](const char*, Buffer<float>& t) { t = t.GrownTo(n + added); });
  adam->GrowTo(n + added);
  Share({opacities, sources, copies}, gaussians, adam);
  return added;
}

bool Densifier::Acts(const Iteration& iteration) const { return iteration.refines; }

std::unique_ptr<Densifier> MakeMcmcDensifier(const DensifierSetup& setup) {
  return std::make_unique<McmcDensifier>(setup);
}

}  // namespace oraclegs

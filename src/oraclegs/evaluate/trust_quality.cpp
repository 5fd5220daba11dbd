#include "oraclegs/evaluate/trust_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/image/color_error.h"
#include "oraclegs/image/similarity.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr int64_t kMaxPixels = 4000000;  // of all views, that are ranked: more take memory and change no digit

/// The marks of the Gaussians as colors, [N,3]: support, uncertainty and 0, each 0 where it is not known.
Buffer<float> ColorsOf(const GaussianMarks& marks, int64_t n) {
  Buffer<float> colors = Buffer<float>::Zeros({n, 3});
  for (const auto& [channel, values] : {std::pair(0, &marks.support), std::pair(1, &marks.uncertainty)}) {
    if (values->empty()) continue;
    if (static_cast<int64_t>(values->size()) != n) {
      throw ShapeError("MeasureTrust: {} numbers of {} Gaussians", values->size(), n);
    }
    for (int64_t i = 0; i < n; ++i) colors[3 * i + channel] = (*values)[static_cast<size_t>(i)];
  }
  return colors;
}

/// The pixels that count, of all views.
struct TrustPixels {
  std::vector<float> error, support, of_gaussians, of_models;

  std::optional<OracleQuality> QualityOf(std::vector<float> uncertainty) const {
    if (error.empty() || uncertainty.empty()) return std::nullopt;
    for (float& value : uncertainty) value = ExpectedSimilarity(value);
    return OracleQuality::FromPixels(error, uncertainty);
  }
};

}  // namespace

SupportQuality SupportQuality::FromPixels(const std::vector<float>& error, const std::vector<float>& support) {
  if (error.size() != support.size()) {
    throw ShapeError("SupportQuality: {} errors of {} pixels", error.size(), support.size());
  }
  SupportQuality quality;
  quality.pixels = static_cast<int64_t>(error.size());
  for (size_t i = 0; i < error.size(); ++i) {
    Class& of = quality.classes[static_cast<size_t>(SupportClassOf(support[i]))];
    of.share += 1;
    of.mean_error += error[i];
  }
  for (Class& of : quality.classes) {
    of.mean_error = of.share > 0 ? of.mean_error / of.share : std::numeric_limits<double>::quiet_NaN();
    of.share /= std::max<double>(1, static_cast<double>(quality.pixels));
  }
  return quality;
}

nlohmann::json ToJson(const SupportQuality& quality) {
  nlohmann::json classes = nlohmann::json::array();
  for (size_t i = 0; i < kSupportClasses; ++i) {
    const SupportQuality::Class& of = quality.classes[i];
    classes.push_back({{"name", NameOf(static_cast<SupportClass>(i))},
                       {"share", of.share},
                       {"mean_error", std::isnan(of.mean_error) ? nlohmann::json() : nlohmann::json(of.mean_error)}});
  }
  return {{"pixels", quality.pixels}, {"classes", std::move(classes)}};
}

TrustQuality MeasureTrust(const Gaussians& gaussians, const GaussianMarks& marks, const std::vector<LoadedView>& views,
                          const RenderOptions& options, Uncertainty* models) {
  const Gaussians tinted = Recolored(gaussians, ColorsOf(marks, gaussians.size()));
  RenderOptions on_black = options;
  on_black.background = {0, 0, 0};
  on_black.sh_degree = 0;
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  int64_t pixels = 0;
  for (const LoadedView& view : views) pixels += int64_t{view.camera.width} * view.camera.height;
  const int64_t step = (pixels + kMaxPixels - 1) / kMaxPixels;
  TrustPixels all;
  for (const LoadedView& view : views) {
    ThrowIfInterrupted();
    const Buffer<float> said =
        rasterizer->Forward(tinted, view.camera, on_black, RenderPass::kInference).image.To(kCpu).Clone();
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference);
    const Buffer<float> alpha = out.alpha.To(kCpu), truth = ToBuffer(view.rgb);
    const Buffer<float> image = ColorCorrected(out.image.To(kCpu), truth, MaskOf(view));
    const std::vector<float> of_models = models != nullptr ? models->At(view.camera) : std::vector<float>();
    for (int64_t p = 0; p < alpha.count(); p += step) {
      if (alpha[p] < kDrawnAlpha || (!view.mask.empty() && view.mask[static_cast<size_t>(p)] == 0)) continue;
      all.error.push_back(ColorError(image.data() + 3 * p, truth.data() + 3 * p));
      all.support.push_back(std::clamp(said[3 * p], 0.f, 1.f));
      all.of_gaussians.push_back(std::clamp(said[3 * p + 1] / alpha[p], 0.f, 1.f));
      if (!of_models.empty()) all.of_models.push_back(of_models[static_cast<size_t>(p)]);
    }
  }
  TrustQuality quality;
  if (!marks.support.empty()) quality.support = SupportQuality::FromPixels(all.error, all.support);
  if (!marks.uncertainty.empty()) quality.of_gaussians = all.QualityOf(std::move(all.of_gaussians));
  quality.of_models = all.QualityOf(std::move(all.of_models));
  return quality;
}

}  // namespace oraclegs

#include "oraclegs/evaluate/trust_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/pixel_errors.h"
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

/// Lists of one number for each pixel of each view.
using OfViews = std::vector<std::vector<float>>;

std::vector<float> Pooled(const OfViews& of_views) {
  std::vector<float> all;
  for (const std::vector<float>& view : of_views) all.insert(all.end(), view.begin(), view.end());
  return all;
}

std::optional<UncertaintyQuality> QualityOf(const std::vector<PixelErrors>& errors, const OfViews& uncertainty) {
  OfViews error_of_views;
  for (const PixelErrors& view : errors) error_of_views.push_back(view.error);
  std::vector<float> confidence = Pooled(uncertainty);
  if (confidence.empty()) return std::nullopt;
  for (float& value : confidence) value = ExpectedSimilarity(value);
  return UncertaintyQuality{OracleQuality::FromPixels(Pooled(error_of_views), confidence),
                            PooledAuse(errors, uncertainty), MeanAuse(errors, uncertainty)};
}

std::vector<float> At(const std::vector<int64_t>& pixels, const std::vector<float>& values) {
  std::vector<float> at;
  for (const int64_t p : pixels) at.push_back(values[static_cast<size_t>(p)]);
  return at;
}

/// Every how many pixels count, so that they are at most kMaxPixels.
int64_t StepFor(const std::vector<LoadedView>& views) {
  int64_t pixels = 0;
  for (const LoadedView& view : views) pixels += int64_t{view.camera.width} * view.camera.height;
  return std::max<int64_t>(1, (pixels + kMaxPixels - 1) / kMaxPixels);
}

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

nlohmann::json ToJson(const UncertaintyQuality& quality) {
  nlohmann::json json = ToJson(quality.pixels);
  json["published_ause"] = {{"pooled", ToJson(quality.pooled)}, {"images", ToJson(quality.means)}};
  return json;
}

TrustQuality MeasureTrust(const Gaussians& gaussians, const GaussianMarks& marks, const std::vector<LoadedView>& views,
                          const RenderOptions& options, Uncertainty* models) {
  const Gaussians tinted = Recolored(gaussians, ColorsOf(marks, gaussians.size()));
  RenderOptions on_black = options;
  on_black.background = {0, 0, 0};
  on_black.sh_degree = 0;
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  const int64_t step = StepFor(views);
  std::vector<PixelErrors> errors;
  OfViews error, support, of_gaussians, of_models;
  for (const LoadedView& view : views) {
    ThrowIfInterrupted();
    const Buffer<float> said =
        rasterizer->Forward(tinted, view.camera, on_black, RenderPass::kInference).image.To(kCpu).Clone();
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference);
    const Buffer<float> alpha = out.alpha.To(kCpu);
    errors.push_back(ErrorsOf(out, view, step));
    error.push_back(errors.back().error);
    support.emplace_back(), of_gaussians.emplace_back();
    for (const int64_t p : errors.back().at) {
      support.back().push_back(std::clamp(said[3 * p], 0.f, 1.f));
      of_gaussians.back().push_back(std::clamp(said[3 * p + 1] / alpha[p], 0.f, 1.f));
    }
    if (models != nullptr) of_models.push_back(At(errors.back().at, models->At(view.camera)));
  }
  TrustQuality quality;
  if (!marks.support.empty()) quality.support = SupportQuality::FromPixels(Pooled(error), Pooled(support));
  if (!marks.uncertainty.empty()) quality.of_gaussians = QualityOf(errors, of_gaussians);
  quality.of_models = QualityOf(errors, of_models);
  for (size_t v = 0; v < of_models.size(); ++v) quality.errors_of_models.push_back({error[v], of_models[v]});
  return quality;
}

std::vector<ExpectedErrors> ErrorsAtUnseen(const Gaussians& gaussians, const std::vector<LoadedView>& views,
                                           const RenderOptions& options) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  Uncertainty uncertainty(gaussians, {}, options);
  const int64_t step = StepFor(views);
  std::vector<ExpectedErrors> all;
  for (const LoadedView& view : views) {
    ThrowIfInterrupted();
    const PixelErrors errors =
        ErrorsOf(rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference), view, step);
    all.push_back({errors.error, At(errors.at, uncertainty.At(view.camera))});
  }
  return all;
}

}  // namespace oraclegs

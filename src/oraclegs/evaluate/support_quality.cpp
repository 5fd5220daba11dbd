#include "oraclegs/evaluate/support_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/evaluate/oracle_quality.h"
#include "oraclegs/evaluate/rank_statistics.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr float kDrawn = 0.1f;           // alpha, from which on a pixel shows the model
constexpr int64_t kMaxPixels = 4000000;  // of all views, that are ranked: more take memory and change no digit

/// The values in three equal channels, [N,3].
Buffer<float> Gray(const std::vector<float>& values) {
  Buffer<float> colors = Buffer<float>::Empty({static_cast<int64_t>(values.size()), 3});
  for (size_t i = 0; i < values.size(); ++i) std::fill_n(colors.data() + 3 * i, 3, values[i]);
  return colors;
}

}  // namespace

SupportQuality SupportQuality::FromPixels(const std::vector<float>& error, const std::vector<float>& support) {
  if (error.size() != support.size()) {
    throw ShapeError("SupportQuality: {} errors of {} pixels", error.size(), support.size());
  }
  SupportQuality quality;
  quality.pixels = static_cast<int64_t>(error.size());
  std::vector<bool> large(error.size());
  for (size_t i = 0; i < error.size(); ++i) {
    Class& of = quality.classes[static_cast<size_t>(SupportClassOf(support[i]))];
    of.share += 1;
    of.mean_error += error[i];
    large[i] = error[i] > kLargeError;
  }
  for (Class& of : quality.classes) {
    of.mean_error = of.share > 0 ? of.mean_error / of.share : std::numeric_limits<double>::quiet_NaN();
    of.share /= std::max<double>(1, static_cast<double>(quality.pixels));
  }
  quality.auroc = AurocOfLowRank(Ranks(support), large);
  return quality;
}

SupportQuality MeasureSupport(const Gaussians& gaussians, const std::vector<float>& support,
                              const std::vector<LoadedView>& views, const RenderOptions& options) {
  const Gaussians tinted = Recolored(gaussians, Gray(support));
  RenderOptions on_black = options;
  on_black.background = {0, 0, 0};
  on_black.sh_degree = 0;
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  int64_t pixels = 0;
  for (const LoadedView& view : views) pixels += int64_t{view.camera.width} * view.camera.height;
  const int64_t step = (pixels + kMaxPixels - 1) / kMaxPixels;
  std::vector<float> errors, values;
  for (const LoadedView& view : views) {
    ThrowIfInterrupted();
    const Buffer<float> shown =
        rasterizer->Forward(tinted, view.camera, on_black, RenderPass::kInference).image.To(kCpu).Clone();
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference);
    const Buffer<float> image = out.image.To(kCpu), alpha = out.alpha.To(kCpu), truth = ToBuffer(view.rgb);
    for (int64_t p = 0; p < alpha.count(); p += step) {
      if (alpha[p] < kDrawn || (!view.mask.empty() && view.mask[static_cast<size_t>(p)] == 0)) continue;
      float error = 0;
      for (int c = 0; c < 3; ++c) {
        error += std::abs(std::clamp(image[3 * p + c], 0.f, 1.f) - truth[3 * p + c]) / 3;
      }
      errors.push_back(error);
      values.push_back(std::clamp(shown[3 * p], 0.f, 1.f));
    }
  }
  return SupportQuality::FromPixels(errors, values);
}

nlohmann::json ToJson(const SupportQuality& quality) {
  const auto number = [](double x) { return std::isnan(x) ? nlohmann::json() : nlohmann::json(x); };
  nlohmann::json classes = nlohmann::json::array();
  for (size_t i = 0; i < kSupportClasses; ++i) {
    classes.push_back({{"name", NameOf(static_cast<SupportClass>(i))},
                       {"share", quality.classes[i].share},
                       {"mean_error", number(quality.classes[i].mean_error)}});
  }
  return {{"auroc", number(quality.auroc)}, {"pixels", quality.pixels}, {"classes", std::move(classes)}};
}

}  // namespace oraclegs

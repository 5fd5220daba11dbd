#include "oraclegs/evaluate/evaluate.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/image_names.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr char kMeanExposureScore[] = "psnr_mean_exposure";

ViewMetrics Score(const LoadedView& view, const Buffer<float>& render, const Buffer<float>& truth,
                  const ImageScores& scores) {
  const Buffer<float> mask = MaskOf(view);
  ViewMetrics metrics;
  metrics.name = view.name;
  metrics.psnr = Psnr(render, truth, mask);
  metrics.ssim = Ssim(render, truth, mask);
  metrics.psnr_color_corrected = ColorCorrectedPsnr(render, truth, mask);
  if (scores.of) metrics.more = scores.of(WithMaskedFrom(render, truth, mask), truth);
  return metrics;
}

/// The scores; empty, with a warning, where a view is too small for them.
ImageScores Usable(const ImageScores& scores, const std::vector<LoadedView>& views, const Listener& listener) {
  for (const LoadedView& view : views) {
    if (!scores.of || std::min(view.camera.width, view.camera.height) >= scores.smallest_side) continue;
    std::vector<std::string> names;
    for (const auto& [name, convention] : scores.conventions) names.push_back(name);
    listener(Warning{fmt::format("{} has {} x {} pixels, too few for {}, which is left out", view.name,
                                 view.camera.width, view.camera.height, fmt::join(names, ", "))});
    return {};
  }
  return scores;
}

std::vector<std::string> NamesOf(const std::vector<LoadedView>& views) {
  std::vector<std::string> names;
  for (const LoadedView& view : views) names.push_back(view.name);
  return names;
}

bool CountsNowhere(const LoadedView& view) {
  return !view.mask.empty() && std::all_of(view.mask.begin(), view.mask.end(), [](uint8_t m) { return m == 0; });
}

void SetMeans(TestMetrics* metrics) {
  const auto n = static_cast<double>(metrics->views.size());
  if (n == 0) metrics->psnr = metrics->ssim = metrics->psnr_color_corrected = std::numeric_limits<double>::quiet_NaN();
  for (const ViewMetrics& view : metrics->views) {
    metrics->psnr += view.psnr / n;
    metrics->ssim += view.ssim / n;
    metrics->psnr_color_corrected += view.psnr_color_corrected / n;
    for (const auto& [name, value] : view.more) metrics->more[name] += value / n;
  }
}

}  // namespace

Buffer<float> MaskOf(const LoadedView& view) {
  if (view.mask.empty()) return {};
  const int64_t height = view.rgb.height, width = view.rgb.width;
  if (static_cast<int64_t>(view.mask.size()) != height * width) {
    throw ShapeError("Evaluate: the mask of {} has {} pixels, expected {}", view.name, view.mask.size(),
                     height * width);
  }
  Buffer<float> mask = Buffer<float>::Empty({height, width});
  std::copy(view.mask.begin(), view.mask.end(), mask.data());
  return mask;
}

TestMetrics Evaluate(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options,
                     const EvaluateExtras& extras, const Listener& listener) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  const std::vector<std::string> files = ImageNames(NamesOf(views));
  const ImageScores scores = Usable(extras.scores, views, listener);
  TestMetrics metrics;
  metrics.conventions = scores.conventions;
  if (extras.expose) metrics.conventions[kMeanExposureScore] = "PSNR of renders in the mean exposure of the photos";
  for (size_t i = 0; i < views.size(); ++i) {
    ThrowIfInterrupted();
    const LoadedView& view = views[i];
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference);
    const Buffer<float> truth = Quantized(ToBuffer(view.rgb));
    Buffer<float> render = Quantized(out.image.To(kCpu));
    std::optional<double> psnr_mean_exposure;
    if (extras.expose) {
      if (!CountsNowhere(view)) psnr_mean_exposure = Psnr(render, truth, MaskOf(view));
      Buffer<float> shown = out.image.To(kCpu).Clone();
      extras.expose(i, shown);
      render = Quantized(shown);
    }
    if (CountsNowhere(view)) {
      listener(Warning{fmt::format("{} is masked out completely and is not scored", view.name)});
    } else {
      metrics.views.push_back(Score(view, render, truth, scores));
      if (psnr_mean_exposure) metrics.views.back().more[kMeanExposureScore] = *psnr_mean_exposure;
    }
    if (!extras.renders.empty()) {
      WritePng(extras.renders / (files[i] + ".png"), ToImage8(render));
      WritePng(extras.renders / (files[i] + "_gt.png"), ToImage8(truth));
    }
    listener(StepDone{"evaluate", static_cast<int64_t>(i) + 1, static_cast<int64_t>(views.size()), "views", view.name});
  }
  SetMeans(&metrics);
  return metrics;
}

double MeanPsnr(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  double sum = 0;
  int scored = 0;
  for (const LoadedView& view : views) {
    if (CountsNowhere(view)) continue;
    const RenderOutput out = rasterizer->Forward(gaussians, view.camera, options, RenderPass::kInference);
    sum += Psnr(Quantized(out.image.To(kCpu)), Quantized(ToBuffer(view.rgb)), MaskOf(view));
    ++scored;
  }
  return scored == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / scored;
}

nlohmann::json ToJson(const TestMetrics& metrics) {
  nlohmann::json views = nlohmann::json::array();
  for (const ViewMetrics& view : metrics.views) {
    views.push_back({{"name", view.name},
                     {"psnr", view.psnr},
                     {"ssim", view.ssim},
                     {"psnr_color_corrected", view.psnr_color_corrected}});
    views.back().update(nlohmann::json(view.more));
  }
  const auto mean = [&](double value) { return metrics.views.empty() ? nlohmann::json() : nlohmann::json(value); };
  nlohmann::json json = {{"psnr", mean(metrics.psnr)},
                         {"ssim", mean(metrics.ssim)},
                         {"psnr_color_corrected", mean(metrics.psnr_color_corrected)},
                         {"views", std::move(views)}};
  if (metrics.more.empty()) return json;
  json.update(nlohmann::json(metrics.more));
  json["conventions"] = metrics.conventions;
  return json;
}

Image8 ToImage8(const Buffer<float>& image) {
  RequireShape("ToImage8", "image", image, {-1, -1, 3});
  const Buffer<float> on_host = image.To(kCpu);
  ImageF out{static_cast<int>(image.size(1)), static_cast<int>(image.size(0)), 3, {}};
  out.data.assign(on_host.data(), on_host.data() + on_host.count());
  return ToImage8(out);
}

Buffer<float> ToBuffer(const ImageF& image) {
  if (image.channels != 3) throw ShapeError("ToBuffer: {} channels, expected 3", image.channels);
  return Buffer<float>::From({image.height, image.width, 3}, std::span<const float>(image.data));
}

}  // namespace oraclegs

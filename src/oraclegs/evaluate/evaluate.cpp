#include "oraclegs/evaluate/evaluate.h"

#include <algorithm>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/evaluate/picture_names.h"

namespace oraclegs {
namespace {

/// The photo's mask [H,W], undefined when every pixel counts.
Buffer<float> MaskOf(const LoadedView& photo) {
  if (photo.mask.empty()) return {};
  const int64_t height = photo.rgb.height, width = photo.rgb.width;
  if (static_cast<int64_t>(photo.mask.size()) != height * width) {
    throw ShapeError("Evaluate: the mask of {} has {} pixels, expected {}", photo.name, photo.mask.size(),
                     height * width);
  }
  return torch::from_blob(const_cast<uint8_t*>(photo.mask.data()), {height, width}, torch::kByte).Clone();
}

ViewMetrics Score(const LoadedView& photo, const Buffer<float>& render, const Buffer<float>& truth, const PictureScores& scores) {
  const Buffer<float> mask = MaskOf(photo);
  ViewMetrics view;
  view.name = photo.name;
  view.psnr = Psnr(render, truth, mask);
  view.ssim = Ssim(render, truth, mask);
  view.psnr_color_corrected = ColorCorrectedPsnr(render, truth, mask);
  if (!scores.of) return view;
  const Buffer<float> shown = mask.defined() ? torch::where((mask > 0).unsqueeze(2), render, truth) : render;
  view.more = scores.of(shown, truth);
  return view;
}

/// The scores, or none where a photo is too small for them.
PictureScores Usable(const PictureScores& scores, const std::vector<LoadedView>& photos, const Listener& listener) {
  for (const LoadedView& photo : photos) {
    if (!scores.of || std::min(photo.camera.width, photo.camera.height) >= scores.smallest_side) continue;
    std::vector<std::string> names;
    for (const auto& [name, convention] : scores.conventions) names.push_back(name);
    listener(Warning{fmt::format("{} has {} x {} pixels, too few for {}, which is left out", photo.name,
                                 photo.camera.width, photo.camera.height, fmt::join(names, ", "))});
    return {};
  }
  return scores;
}

std::vector<std::string> NamesOf(const std::vector<LoadedView>& photos) {
  std::vector<std::string> names;
  for (const LoadedView& photo : photos) names.push_back(photo.name);
  return names;
}

bool CountsNowhere(const LoadedView& photo) {
  return !photo.mask.empty() && std::all_of(photo.mask.begin(), photo.mask.end(), [](uint8_t m) { return m == 0; });
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

TestMetrics Evaluate(const Gaussians& gaussians, const std::vector<LoadedView>& photos, const RenderOptions& options,
                     const EvaluateExtras& extras, const Listener& listener) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(gaussians.means.device());
  const std::vector<std::string> pictures = PictureNames(NamesOf(photos));
  const PictureScores scores = Usable(extras.scores, photos, listener);
  TestMetrics metrics;
  metrics.conventions = scores.conventions;
  for (size_t i = 0; i < photos.size(); ++i) {
    ThrowIfInterrupted();
    const LoadedView& photo = photos[i];
    const RenderOutput out = rasterizer->Forward(gaussians, photo.camera, options, RenderPass::kInference);
    const Buffer<float> render = Quantized(out.image.To(kCpu)), truth = Quantized(ToTensor(photo.rgb));
    if (CountsNowhere(photo)) {
      listener(Warning{fmt::format("{} is masked out completely and is not scored", photo.name)});
    } else {
      metrics.views.push_back(Score(photo, render, truth, scores));
    }
    if (!extras.renders.empty()) {
      WritePng(extras.renders / (pictures[i] + ".png"), ToImage8(render));
      WritePng(extras.renders / (pictures[i] + "_gt.png"), ToImage8(truth));
    }
    listener(
        StepDone{"evaluate", static_cast<int64_t>(i) + 1, static_cast<int64_t>(photos.size()), "views", photo.name});
  }
  SetMeans(&metrics);
  return metrics;
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
  const Buffer<float> bytes = torch::floor(image.To(kCpu).clamp(0, 1) * 255.f + 0.5f).to(torch::kByte);
  Image8 out;
  out.height = static_cast<int>(image.size(0));
  out.width = static_cast<int>(image.size(1));
  out.channels = 3;
  out.data.assign(bytes.data(), bytes.data() + bytes.count());
  return out;
}

Buffer<float> ToTensor(const ImageF& image) {
  if (image.channels != 3) throw ShapeError("ToTensor: {} channels, expected 3", image.channels);
  return torch::from_blob(const_cast<float*>(image.data.data()), {image.height, image.width, 3}, torch::kFloat).Clone();
}

}  // namespace oraclegs

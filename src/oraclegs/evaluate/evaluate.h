#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Scores beside PSNR and SSIM, supplied by a floor above.
struct ImageScores {
  /// Scores of a render against the truth, [H,W,3] in [0,1], by name; empty = none. The names are always the same.
  std::function<std::map<std::string, double>(const Buffer<float>& render, const Buffer<float>& truth)> of;
  std::map<std::string, std::string> conventions;  ///< name -> how it is computed
  int64_t smallest_side = 1;                       ///< least side of an image that can be scored, pixels
};

/// Optional outputs and scores of Evaluate.
struct EvaluateExtras {
  // Not explicit: renders alone are what most callers want.
  EvaluateExtras(std::filesystem::path renders_in = {}, ImageScores scores_in = {})
      : renders(std::move(renders_in)), scores(std::move(scores_in)) {}

  std::filesystem::path renders;  ///< receives NAME.png and NAME_gt.png (see ImageNames); empty = nothing is written
  ImageScores scores;
  /// Brings the render of a view, [H,W,3] in [0,1] on the host, to the exposure that a photo there is expected to have,
  /// in place; empty = renders are scored as they are. With it, the PSNR without is "psnr_mean_exposure" in
  /// ViewMetrics::more.
  std::function<void(size_t view, const Buffer<float>& render)> expose = {};
};

struct ViewMetrics {
  std::string name;
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
  std::map<std::string, double> more = {};  ///< scores of ImageScores by name
};

struct TestMetrics {
  std::vector<ViewMetrics> views;
  /// Means over views; NaN when no view is scored.
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
  std::map<std::string, double> more = {};
  std::map<std::string, std::string> conventions = {};  ///< conventions of the scores in `more`
};

/// Renders each view's camera, compares 8-bit images, and writes them as `extras` asks. Where a view's mask excludes,
/// the scores of `extras` get the view's image on both sides. When a view is too small for those scores they are left
/// out for all, with a warning.
TestMetrics Evaluate(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options,
                     const EvaluateExtras& extras, const Listener& listener);

/// Mean PSNR as Evaluate computes it, NaN when no view is scored. Does not check for interrupts: the trainer saves
/// first.
double MeanPsnr(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options);

/// {"psnr", "ssim", "psnr_color_corrected", "views": [{"name", "psnr", "ssim", "psnr_color_corrected"}]}; each further
/// score stands under its name beside these and in "conventions". The means are null when no view is scored.
nlohmann::json ToJson(const TestMetrics& metrics);

/// The view's mask [H,W] of 0 and 1, undefined when it has none. Throws ShapeError when it does not fit the camera.
Buffer<float> MaskOf(const LoadedView& view);

/// Converts a render [H,W,3] for writing: clamped to [0, 1], 8 bit.
Image8 ToImage8(const Buffer<float>& image);
/// Copies the image to a buffer [H,W,3]. Throws ShapeError unless it has 3 channels.
Buffer<float> ToBuffer(const ImageF& image);

}  // namespace oraclegs

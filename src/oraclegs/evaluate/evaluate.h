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

/// Scores beside PSNR and SSIM that a floor above knows how to compute.
struct ImageScores {
  /// name -> score of a render against the truth, [H,W,3] in [0,1]; empty = none. Always the same names.
  std::function<std::map<std::string, double>(const Buffer<float>& render, const Buffer<float>& truth)> of;
  std::map<std::string, std::string> conventions;  ///< name -> how it is computed
  int64_t smallest_side = 1;                       ///< pixels, of an image that can be scored
};

/// What Evaluate may do beside measuring.
struct EvaluateExtras {
  // Not explicit: renders alone are what most callers want.
  EvaluateExtras(std::filesystem::path renders_in = {}, ImageScores scores_in = {})
      : renders(std::move(renders_in)), scores(std::move(scores_in)) {}

  std::filesystem::path renders;  ///< receives NAME.png and NAME_gt.png (see ImageNames); empty = nothing is written
  ImageScores scores;
};

struct ViewMetrics {
  std::string name;
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
  std::map<std::string, double> more = {};  ///< of ImageScores
};

struct TestMetrics {
  std::vector<ViewMetrics> views;
  /// Means over views; NaN when no view is scored.
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
  std::map<std::string, double> more = {};
  std::map<std::string, std::string> conventions = {};  ///< of `more`
};

/// Renders each view's camera, compares 8-bit with 8-bit, and writes both as `extras` asks. Where a view's mask
/// excludes, the scores of `extras` see the view's image on both sides. A view too small for them leaves them out for
/// all, with a warning.
TestMetrics Evaluate(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options,
                     const EvaluateExtras& extras, const Listener& listener);

/// The mean PSNR of the same comparison, NaN when no view is scored. Does not look for interrupts: who trains saves
/// first.
double MeanPsnr(const Gaussians& gaussians, const std::vector<LoadedView>& views, const RenderOptions& options);

/// {"psnr", "ssim", "psnr_color_corrected", "views": [{"name", "psnr", "ssim", "psnr_color_corrected"}]}, and of each
/// further score its name in both and in "conventions"; the means are null when no view is scored.
nlohmann::json ToJson(const TestMetrics& metrics);

/// Converts a render [H,W,3] for writing: clamped, 8 bit.
Image8 ToImage8(const Buffer<float>& image);
/// The image as [H,W,3], copied. Throws ShapeError unless it has 3 channels.
Buffer<float> ToBuffer(const ImageF& image);

}  // namespace oraclegs

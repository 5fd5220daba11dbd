#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/photos.h"

namespace oraclegs {

struct ViewMetrics {
  std::string name;
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
};

struct TestMetrics {
  std::vector<ViewMetrics> views;
  /// Means over views; NaN when no view is scored.
  double psnr = 0, ssim = 0, psnr_color_corrected = 0;
};

/// Renders each photo's camera, compares 8-bit with 8-bit, and when `renders` is not empty writes
/// renders/NAME.png, renders/NAME_gt.png (see PictureNames).
TestMetrics Evaluate(const Gaussians& gaussians, const std::vector<Photo>& photos, const RenderOptions& options,
                     const std::filesystem::path& renders, const Listener& listener);

/// {"psnr", "ssim", "psnr_color_corrected", "views": [{"name", "psnr", "ssim", "psnr_color_corrected"}]}; the means
/// are null when no view is scored.
nlohmann::json ToJson(const TestMetrics& metrics);

/// Converts a render [H,W,3] for writing: clamped, 8 bit.
Image8 ToImage8(const Tensor& image);
/// [H,W,3] tensor of an image, copied.
Tensor ToTensor(const ImageF& image);

}  // namespace oraclegs

#pragma once
// The errors of a render, pixel by pixel.

#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/render/render.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Alpha, from which on a pixel shows the model.
inline constexpr float kDrawnAlpha = 0.1f;

/// Errors of the pixels of an image that count; lists of one length.
struct PixelErrors {
  std::vector<int64_t> at;      ///< the pixels, row by row
  std::vector<float> error;     ///< ColorError (image/color_error.h): RMS over the channels
  std::vector<float> absolute;  ///< mean over the channels of the absolute difference
  std::vector<float> dssim;     ///< (1 - SSIM) / 2, mean over the channels
};

/// The errors of a view's render at every `step`-th pixel that is drawn and not masked. Another exposure is no error:
/// the render is ColorCorrected.
PixelErrors ErrorsOf(const RenderOutput& render, const LoadedView& view, int64_t step = 1);

}  // namespace oraclegs

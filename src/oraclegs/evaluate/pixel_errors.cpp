#include "oraclegs/evaluate/pixel_errors.h"

#include <cmath>

#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/image/color_error.h"
#include "oraclegs/loss/photometric.h"

namespace oraclegs {

PixelErrors ErrorsOf(const RenderOutput& render, const LoadedView& view, int64_t step) {
  const Buffer<float> alpha = render.alpha.To(kCpu), truth = ToBuffer(view.rgb), mask = MaskOf(view);
  const Buffer<float> image = ColorCorrected(render.image.To(kCpu), truth, mask);
  const Buffer<float> ssim = SsimMap(WithMaskedFrom(image, truth, mask), truth);
  PixelErrors errors;
  for (int64_t p = 0; p < alpha.count(); p += step) {
    if (alpha[p] < kDrawnAlpha || (!view.mask.empty() && view.mask[static_cast<size_t>(p)] == 0)) continue;
    float absolute = 0, dssim = 0;
    for (int64_t c = 3 * p; c < 3 * p + 3; ++c) {
      absolute += std::abs(image[c] - truth[c]) / 3;
      dssim += (1 - ssim[c]) / 6;
    }
    errors.at.push_back(p);
    errors.error.push_back(ColorError(image.data() + 3 * p, truth.data() + 3 * p));
    errors.absolute.push_back(absolute);
    errors.dssim.push_back(dssim);
  }
  return errors;
}

}  // namespace oraclegs

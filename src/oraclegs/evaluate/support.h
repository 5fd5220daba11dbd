#pragma once
// Support of each Gaussian by the images and the proposals (docs/method.md#support).

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// A view that the Gaussians were trained on.
struct SupportView {
  Camera camera;
  Buffer<float> weight;      ///< [H,W] in [0,1]: the mask of an image, the confidence of a proposal; undefined = 1
  bool is_proposal = false;  ///< false: an image
  Buffer<uint8_t> weight_bytes = {};  ///< in place of weight: byte / 255
};

/// The support of each Gaussian, [N] in [0, 1]. A view sees a Gaussian when at least a tenth of its projected area is
/// unoccluded there. [0.75, 1]: two or more images see it; more with more images. [0.5, 0.75): one image. [0.25, 0.5):
/// no image; in the proposal that trusts it most, the mean confidence of the pixels that show it is at least 0.5. Below
/// 0.25: less confidence, or nothing sees it. Rendered on the device of the Gaussians; `options` gives the
/// antialiasing. Throws ShapeError for a weight that does not fit its camera.
std::vector<float> Support(const Gaussians& gaussians, const std::vector<SupportView>& views,
                           const RenderOptions& options);

}  // namespace oraclegs

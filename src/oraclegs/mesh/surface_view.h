#pragma once
// Surface measurements of one render: the pixels to trust, and their weights.

#include "oraclegs/render/surface.h"

namespace oraclegs {

struct SurfaceView {
  RenderedSurface surface;
  std::vector<float> weights;  ///< [H*W], 0 = not trusted
  Buffer<float> image;         ///< [H,W,3] on the host
};

/// A pixel is trusted when its surface is opaque, known, not seen at a grazing angle, and neither on an edge of depth,
/// where near and far mix, nor beside one. Its weight is the cosine of the angle to the normal over squared depth.
SurfaceView SurfaceViewOf(const RenderOutput& render, const Camera& camera);

}  // namespace oraclegs

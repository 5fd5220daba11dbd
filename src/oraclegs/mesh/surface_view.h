#pragma once
// What one render says about surfaces: which of its pixels can be believed, and how much.

#include "oraclegs/render/surface.h"

namespace oraclegs {

struct SurfaceView {
  RenderedSurface surface;
  std::vector<float> weights;  ///< [H*W], 0 = not believed
  Buffer<float> image;         ///< [H,W,3] on the host
};

/// A pixel is believed when the surface there is opaque, known, not seen at a grazing angle, and neither on an edge of
/// depth, where near and far mix, nor beside one. Its weight is the cosine of that angle over squared depth: what it
/// says about the place.
SurfaceView SurfaceViewOf(const RenderOutput& render, const Camera& camera);

}  // namespace oraclegs

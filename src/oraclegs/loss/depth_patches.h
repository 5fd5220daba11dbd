#pragma once
// Images and patches of the depth losses of the sparse-view baselines.

#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// A rendered depth-like image and its target, all [H,W] float32.
struct DepthImages {
  Buffer<float> rendered;
  Buffer<float> target;
  Buffer<float> mask;  ///< in [0,1], weight of each pixel; undefined = 1 everywhere

  int64_t height() const { return rendered.size(0); }
  int64_t width() const { return rendered.size(1); }
  double MaskAt(int64_t pixel) const { return mask.defined() ? static_cast<double>(mask[pixel]) : 1; }

  /// Throws ShapeError naming `who` where a shape does not fit, the image is empty, or `grad` (may be null or
  /// undefined) has another shape.
  void Check(const char* who, const Buffer<float>* grad) const;
};

/// Pixels [x, x + width) x [y, y + height) of an image.
struct ImagePatch {
  int64_t x = 0, y = 0, width = 0, height = 0;
};

/// Square patches at random places.
struct PatchSampling {
  int64_t side = 128;  ///< side in pixels, at most the image's. SparseGS: 128
  double share = 0.5;  ///< number of patches as a fraction of those that tile the image. SparseGS: 0.5
};

/// floor(share * floor(H / side) * floor(W / side)) patches, at least one, each with its corner uniform over all places
/// inside the image; they may overlap. A pure function of its arguments. Source: the public code of [Xiong 2023].
/// Throws ShapeError for a side below 1 or an empty image.
std::vector<ImagePatch> RandomPatches(int64_t height, int64_t width, const PatchSampling& sampling, uint64_t seed,
                                      int64_t iteration);

/// Whole patches of a grid that begins at the upper left corner; remainders at the right and lower borders are left
/// out. An image smaller than a patch is one patch. Throws ShapeError as RandomPatches.
std::vector<ImagePatch> GridPatches(int64_t height, int64_t width, int64_t side);

}  // namespace oraclegs

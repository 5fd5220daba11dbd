#pragma once
// Losses of depth and alpha: the program's own, and those of the sparse-view baselines with their images and patches.

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

/// weight * mean(|rendered - target| * mask) over all H*W pixels: the depth term, of inverse depths
/// (docs/method.md#depth-term), and the alpha term. All [H,W] float32; an undefined mask is 1 everywhere. Writes
/// dL/d(rendered) into grad (same shape), which may be null or undefined. Returns the weighted loss. Throws ShapeError.
double MaskedL1(const Buffer<float>& rendered, const Buffer<float>& target, const Buffer<float>& mask, double weight,
                Buffer<float>* grad);

// Depth as a correlation, which is independent of the scale and offset of a monocular depth: the depth term of FSGS
// [Zhu 2024] (section 3.3, eq. 6) and of SparseGS [Xiong 2023] (section 3.2).
//
// FSGS takes the smaller of the losses against a network's inverse depth, negated, and against 1 / (it + 200), because
// it renders a depth. Here both images are inverse depths, which grow together: one correlation suffices.

// As published. FSGS: 0.05 on training views until iteration 9500, 0.001 after. SparseGS: 0.05 on the image, 0.15 on
// patches.
inline constexpr double kFsgsDepthWeight = 0.05, kFsgsLateDepthWeight = 0.001;
inline constexpr double kSparseGsDepthWeight = 0.05, kSparseGsPatchDepthWeight = 0.15;

/// weight * (1 - r), r the Pearson correlation of the rendered image with the target, pixels weighed by the mask; in
/// [0, 2 weight]. Writes dL/d(rendered) into grad (same shape), which may be null or undefined. Value and gradient are
/// 0 where there is no correlation: the mask sums to less than 2, or an image is constant where the mask is above 0.
/// Pixels of mask 0 may hold anything. Throws ShapeError. The result does not depend on the number of threads.
double PearsonDepthLoss(const DepthImages& images, double weight, Buffer<float>* grad);

/// weight * the mean of 1 - r over the patches that have a correlation; 0 if none has. SparseGS: patches of
/// RandomPatches. Throws ShapeError, also for a patch that leaves the image.
double PatchPearsonDepthLoss(const DepthImages& images, const std::vector<ImagePatch>& patches, double weight,
                             Buffer<float>* grad);

// Global-local depth normalization of DNGaussian [Li 2024]: depths are compared by patches that are normalized first,
// so that small steps weigh as much as large ones. Constants and details are those of its public code.
//
// DNGaussian compares a rendered depth with 255 minus a network's inverse depth. Here rendered image and target are of
// one kind, both inverse depths, which grow together.

/// Divisor of a patch, after its mean is subtracted.
enum class DepthNormalization {
  kLocal,   ///< its own standard deviation
  kGlobal,  ///< the standard deviation of the whole image, without gradient
};

struct NormalizedDepthOptions {
  DepthNormalization normalization = DepthNormalization::kLocal;
  int64_t patch_side = 16;  ///< pixels, of GridPatches
  /// Tolerance of normalized depths: smaller differences are ignored. 0.00025 on LLFF, 0.001 on Blender scenes, 0.01 on
  /// DTU.
  double tolerance = 0.00025;
};

// As published: 0.1 times the local and 1 times the global loss, each of them with its own patch side in every
// iteration: 5 to 17 pixels on LLFF and Blender scenes, 17 to 53 on DTU.
inline constexpr double kLocalDepthWeight = 0.1, kGlobalDepthWeight = 1;

struct PatchSideRange {
  int64_t min = 5, max = 17;  ///< pixels, inclusive
};

/// Draws a side uniformly; a pure function of its arguments, and independent for each normalization.
int64_t DrawPatchSide(const PatchSideRange& range, DepthNormalization normalization, uint64_t seed, int64_t iteration);

/// weight * the mean of (x - y)^2 over the pixels with |x - y| > tolerance, x and y the normalized rendered image and
/// target: (value - mean of its patch) / (deviation + 0.01 * the deviation over all patches), deviations with n - 1.
/// The mask weighs each pixel in every mean and deviation; patches of total weight below 2 are left out, as are pixels
/// in no whole patch. Writes dL/d(rendered) into grad (same shape), which may be null or undefined. Value and gradient
/// are 0 where nothing differs, or where an image is constant. Pixels of mask 0 may hold anything. Throws ShapeError.
/// The result does not depend on the number of threads.
double NormalizedDepthLoss(const DepthImages& images, const NormalizedDepthOptions& options, double weight,
                           Buffer<float>* grad);

}  // namespace oraclegs

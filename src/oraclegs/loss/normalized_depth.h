#pragma once
// Global-local depth normalization of DNGaussian [Li 2024]: depths are compared by patches that are normalized first,
// so that small steps weigh as much as large ones. Constants and details are those of its public code.
//
// DNGaussian compares a rendered depth with 255 minus a network's inverse depth. Here rendered image and target are of
// one kind, both inverse depths, which grow together.

#include "oraclegs/loss/depth_patches.h"

namespace oraclegs {

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

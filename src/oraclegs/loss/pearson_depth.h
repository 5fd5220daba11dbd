#pragma once
// Depth as a correlation, which is independent of the scale and offset of a monocular depth: the depth term of FSGS
// [Zhu 2024] (section 3.3, eq. 6) and of SparseGS [Xiong 2023] (section 3.2).
//
// FSGS takes the smaller of the losses against a network's inverse depth, negated, and against 1 / (it + 200), because
// it renders a depth. Here both images are inverse depths, which grow together: one correlation suffices.

#include "oraclegs/loss/depth_patches.h"

namespace oraclegs {

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

}  // namespace oraclegs

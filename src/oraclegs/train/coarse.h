#pragma once
// Coarse-to-fine training: the first iterations see photos of half the size, which show coarse structure and take a
// quarter of the time.

#include "oraclegs/train/train_view.h"
#include "oraclegs/train/view_sampler.h"

namespace oraclegs {

/// The view at half the size (rounded up), camera included. Every pixel is an area average weighted by the mask: colors
/// by confidence, inverse depths by depth_mask; confidence and depth_mask themselves are plain averages. Masked pixels
/// do not contribute. A fully masked pixel of a photo becomes 0, since no loss reads it; that of a proposal becomes the
/// plain average, since SSIM windows of unmasked pixels reach into it.
TrainView HalfSize(const TrainView& view, ViewKind kind = ViewKind::kPhoto);

/// Number of first iterations that train at half size; less than `iterations`.
int64_t CoarseIterations(double coarse_share, int64_t iterations);

}  // namespace oraclegs

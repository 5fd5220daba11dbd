#pragma once
// Coarse to fine: the first part of a run sees small photos, which show where things are before what they are
// made of, and take a quarter of the time.

#include "oraclegs/train/train_view.h"
#include "oraclegs/train/view_sampler.h"

namespace oraclegs {

/// The view at half the size (rounded up), camera included. Every pixel is the area average over the pixels that count:
/// colors by confidence, inverse depths by depth_mask; confidence and depth_mask themselves are averaged over all.
/// What does not count leaves no trace. A pixel none of whose parts counts is zero in a photo, where nothing looks
/// at it; in a proposal it is the plain average, which windows of SSIM that belong to pixels that count reach into.
TrainView HalfSize(const TrainView& view, ViewKind kind = ViewKind::kPhoto);

/// Iterations 1 .. CoarseIterations are trained at half size. Never the last.
int64_t CoarseIterations(double coarse_share, int64_t iterations);

}  // namespace oraclegs

#pragma once
// Coarse to fine: the first part of a run sees small photographs, which show where things are before what they are
// made of, and take a quarter of the time.

#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The view at half the size (rounded up), camera included. Every pixel is the area average over the pixels that count:
/// colours by confidence, inverse depths by depth_mask; confidence and depth_mask themselves are averaged over all.
/// What does not count leaves no trace, and a pixel none of whose parts counts is zero.
TrainView HalfSize(const TrainView& view);

/// Iterations 1 .. CoarseIterations are trained at half size. Never the last.
int64_t CoarseIterations(double coarse_share, int64_t iterations);

}  // namespace oraclegs

#pragma once
// Floater pruning of SparseGS [Xiong 2023] (its section on advanced floater pruning): where the Gaussian that a pixel
// shows most of lies far before the depth that all blend to, it and all before it are taken to be floaters. How far is
// far follows from how much the differences fall into two heaps. Constants and details are those of the public code.

#include "oraclegs/train/baselines/ray_modes.h"

namespace oraclegs {

struct ModeFloaterOptions {
  double percentile = 98;       ///< of a view's positive differences, at a dip of 0: the threshold
  double dip_rate = 7.5;        ///< the percentile is percentile * exp(-dip_rate * dip). Also published: 7
  double min_percentile = 80;   ///< and no less than this
  double min_log_falloff = -4;  ///< Gaussians whose falloff at a pixel is below exp of this are no floaters of it
};

/// (blended - mode) / (blended + c) of each pixel, c the larger of the least blended depth and their mean less three
/// standard deviations (n - 1); empty pixels take part with depth 0. 0 where it is not a number.
std::vector<float> ModeDifferences(const RayModes& modes);

/// The percentile that the mean over the views of the dip of their positive differences leads to.
double FloaterPercentile(double mean_dip, const ModeFloaterOptions& options);

/// 1 for each Gaussian to prune: in any view, at a pixel whose difference is above the percentile of the view's
/// positive differences (by linear interpolation), what RayView::MarkUpToMode marks. SparseGS prunes once, after
/// iteration 20000 of 30000. The same for any number of threads. Throws ShapeError as RayView.
std::vector<uint8_t> FindModeFloaters(const Gaussians& gaussians, const std::vector<Camera>& cameras,
                                      const RenderOptions& render, const ModeFloaterOptions& options);

}  // namespace oraclegs

#pragma once
// Relative exposures of images, from surfaces that several of them show (docs/method.md#exposure-gains).

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// For each view and channel, its brightness of a surface relative to the geometric mean of all views: the
/// least-squares solution of the median log ratios of colors over the common confident pixels of views that are near
/// each other; of a view without depth, over those of the others in its frame. 1 for views that share too few pixels
/// with others. `views` correspond to `maps`.
std::vector<Eigen::Vector3f> EstimateGains(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views);

/// Root mean square of ln(gain) over views and channels: 0 for views of one exposure.
double ExposureSpread(const std::vector<Eigen::Vector3f>& gains);

}  // namespace oraclegs

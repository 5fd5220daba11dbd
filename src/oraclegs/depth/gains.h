#pragma once
// How differently images are exposed, from the surfaces that several of them show (docs/method.md#exposure-gains).

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// For each view, per channel, how much brighter it shows a surface than the geometric mean of all views: the
/// least-squares solution of the median log ratios of colors over each pair's common confident pixels. 1 for views
/// that share too few pixels with others. `views` belong to `maps`, one by one.
std::vector<Eigen::Vector3f> EstimateGains(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views);

/// Root mean square of ln(gain) over views and channels: 0 for views of one exposure.
double ExposureSpread(const std::vector<Eigen::Vector3f>& gains);

}  // namespace oraclegs

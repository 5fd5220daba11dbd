#pragma once
// How differently photographs are exposed, told by the surfaces that several of them show.

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Of each photograph, per channel, how much brighter it shows a surface than the photographs do in the (geometric)
/// mean: the least-squares solution of the median log ratios of colours over each pair's common confident pixels. 1 for
/// photographs that share too few pixels with others. `photos` belong to `maps`, one by one.
std::vector<Eigen::Vector3f> EstimateGains(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& photos);

/// Root mean square of ln(gain) over photographs and channels: 0 for photographs of one exposure.
double ExposureSpread(const std::vector<Eigen::Vector3f>& gains);

}  // namespace oraclegs

#pragma once
// Fusion of depth maps to one point cloud (docs/method.md#depth-fusion).

#include <Eigen/Core>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

struct DensePoint {
  Eigen::Vector3f xyz;     ///< world
  Eigen::Vector3f normal;  ///< world, unit, toward the cameras
  Eigen::Vector3f rgb;     ///< [0, 1]
  float confidence = 0;    ///< [0, 1], that of the most confident pixel
  float pixel_size = 0;    ///< size of a pixel at the point, world units, in the view that found it first
  float detail = 0;        ///< [0, 1], change of the image around it
  int views = 1;           ///< number of views that show it
};

struct FusionOptions {
  float min_confidence = kConfident;
  float max_depth_difference = 0.01f;    ///< limit of the relative difference between pixels of one point
  std::vector<Eigen::Vector3f> gains{};  ///< gain of each view (gains.h), a divisor of colors; empty = all 1
};

/// One point for each surface patch that pixels of at least `min_confidence` show: the weighted mean of the
/// corresponding pixels of all views. `views` correspond to `maps`.
std::vector<DensePoint> FuseDepth(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                  const FusionOptions& options);

/// Points that `add(view, &points)` appends for each of `views` views, in their order. Throws Interrupted.
std::vector<DensePoint> PointsOfViews(size_t views, FunctionRef<void(size_t, std::vector<DensePoint>*)> add);

/// Random choice of at most `budget` points, in their order; more where the images show detail. Depends on the
/// arguments only.
std::vector<DensePoint> Thinned(const std::vector<DensePoint>& points, size_t budget, uint64_t seed);

}  // namespace oraclegs

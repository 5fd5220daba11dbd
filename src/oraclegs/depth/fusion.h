#pragma once
// From depth maps to one cloud of points (docs/method.md#depth-fusion).

#include <Eigen/Core>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

struct DensePoint {
  Eigen::Vector3f xyz;     ///< world
  Eigen::Vector3f normal;  ///< world, unit, towards the cameras
  Eigen::Vector3f rgb;     ///< [0, 1]
  float confidence = 0;    ///< [0, 1], of the most confident pixel
  float pixel_size = 0;    ///< world units that a pixel covers there, in the view that found it first
  float detail = 0;        ///< [0, 1], how much the image changes around it
  int views = 1;           ///< that show it
};

struct FusionOptions {
  float min_confidence = kConfident;
  float max_depth_difference = 0.01f;    ///< relative, of pixels that are one point
  std::vector<Eigen::Vector3f> gains{};  ///< of the views (gains.h), which colors are divided by; empty = all 1
};

/// One point for each surface patch that pixels of at least `min_confidence` show: the weighted mean of the pixels that
/// all views have of it. `views` belong to `maps`, one by one.
std::vector<DensePoint> FuseDepth(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                  const FusionOptions& options);

/// What `add(view, &points)` appends for view 0, 1, ..., `views` - 1, in this order. Throws Interrupted.
std::vector<DensePoint> PointsOfViews(size_t views, FunctionRef<void(size_t, std::vector<DensePoint>*)> add);

/// At most `budget` of the points, more where the images show detail, drawn at random by the seed alone. In their
/// order.
std::vector<DensePoint> Thinned(const std::vector<DensePoint>& points, size_t budget, uint64_t seed);

}  // namespace oraclegs

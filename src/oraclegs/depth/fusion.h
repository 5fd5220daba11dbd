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

/// Least confidence of a pixel that makes a point: 0.2 of six views or fewer, kConfident from eight on, and halfway of
/// seven. Confidence counts the views that agree, of which few have few, and a wrong point, which training can move,
/// harms less than a hole, which it cannot fill. kConfident, too, where a tenth of the pixels or less are confident
/// (the others are chance there), and with a network's depth, which makes points of its own (PriorPoints).
float ConfidenceOfPoints(const std::vector<DepthMap>& maps);

struct FusionOptions {
  float min_confidence = kConfident;
  float max_depth_difference = 0.01f;    ///< limit of the relative difference between pixels of one point
  std::vector<Eigen::Vector3f> gains{};  ///< gain of each view (gains.h), a divisor of colors; empty = all 1
};

/// One point for each surface patch that pixels of at least `min_confidence` show: the weighted mean of the
/// corresponding pixels of the views around. `views` correspond to `maps`, of which some may be empty, here and below.
std::vector<DensePoint> FuseDepth(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                  const FusionOptions& options);

/// Points that `add(view, &points)` appends for each of `views` views, in their order. Throws Interrupted.
std::vector<DensePoint> PointsOfViews(size_t views, FunctionRef<void(size_t, std::vector<DensePoint>*)> add);

/// Random choice of at most `budget` points, in their order; more where the images show detail. Depends on the
/// arguments only.
std::vector<DensePoint> Thinned(const std::vector<DensePoint>& points, size_t budget, uint64_t seed);

// Extrapolation of planes into textureless regions: lawns, plain walls, table tops
// (docs/method.md#plane-extrapolation).

/// A coarse grid of points on pixels without a confident depth. A region without depth continues the plane of the scene
/// (scene_planes.h) of most confident pixels of its color around it: a lawn continues the lawn and not the wall behind
/// it. One of the other views with the place in frame must show the same color there, and none may see through it; a
/// place that no other view has in frame is accepted. `points` are those of FuseDepth with the same arguments. A point
/// has confidence 0 and one view. No points outside silhouettes, where there are any (silhouettes.h), or where a mask
/// excludes. The result does not depend on the number of threads. Throws Interrupted.
std::vector<DensePoint> FillPlanes(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                   const std::vector<DensePoint>& points, const FusionOptions& options);

// Points where only a network has depth (docs/method.md#plane-extrapolation).

/// A coarse grid of points on the pixels of monocular maps that are not confident. Excluded are pixels covered by one
/// of `points` or by a point added for an earlier view (points far behind cover nothing), and points that a confident
/// depth of another view sees through. A point has the confidence of its pixel and one view. `views` correspond to
/// `maps`. Empty without monocular maps.
std::vector<DensePoint> PriorPoints(const std::vector<DepthMap>& maps, const std::vector<LoadedView>& views,
                                    const std::vector<DensePoint>& points, const FusionOptions& options);

}  // namespace oraclegs

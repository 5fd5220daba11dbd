#pragma once
// Alignment of a network's inverse depths, whose scale and offset are unknown, with known depths of the same image
// (docs/method.md#depth-alignment).

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Inverse depth of one image, of unknown scale and offset; larger is nearer.
struct RelativeDepth {
  int width = 0, height = 0;
  std::vector<float> values;  ///< width * height, row by row, finite
};

/// Bilinear sample at column u, row v, where whole numbers are the pixels' centers; the border is replicated.
double SampleAt(const RelativeDepth& map, double u, double v);

/// A known inverse depth at a place in an image.
struct KnownDepth {
  double x = 0, y = 0;   ///< pixels of the camera, whose first pixel has its center at (0.5, 0.5)
  double inv_depth = 0;  ///< 1/z, 1/world unit; not positive behind the camera
};

/// Known depths of view `view` (an index of ScenePoint::views): the points that it saw.
std::vector<KnownDepth> KnownDepths(const std::vector<ScenePoint>& points, int view, const Camera& camera);

struct AlignmentRule {
  int min_points = 11;
  double min_span = 1e-3;  ///< least span of the known inverse depths that fixes a scale, 1/world unit
  double center = 0.5;     ///< coordinate of the first pixel's center in the map; the public scripts take 0
};

/// inverse depth = scale * relative + offset.
struct Alignment {
  double scale = 0, offset = 0;                        ///< a scale of 0 means: not fixed
  int points = 0;                                      ///< number of points used
  double known_median = 0, known_deviation = 0;        ///< deviation: mean distance from the median
  double relative_median = 0, relative_deviation = 0;  ///< median and deviation of the map at the points

  double At(double relative) const { return scale * relative + offset; }
};

/// Aligns the map so that its median and mean deviation equal those of the known depths, which few wrong points move
/// little. Scale 0 where there are too few points or all have one distance.
Alignment Align(const RelativeDepth& map, const Camera& camera, const std::vector<KnownDepth>& known,
                const AlignmentRule& rule);

/// For each view: whether its scale is within a factor of five of the median of all positive scales.
std::vector<bool> AreReliable(const std::vector<Alignment>& alignments);

/// AlignmentRule::min_span for a scene in any unit: a thousandth of the median known inverse depth; 0 without known
/// depths.
double MinSpan(const std::vector<std::vector<KnownDepth>>& known);

}  // namespace oraclegs

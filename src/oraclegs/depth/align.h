#pragma once
// A network's inverse depths have an unknown scale and offset. Known depths of the same image fix both
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

/// Bilinear at column u, row v, where whole numbers are pixels' centers; the border is replicated.
double SampleAt(const RelativeDepth& map, double u, double v);

/// An inverse depth that is known somewhere in an image.
struct KnownDepth {
  double x = 0, y = 0;   ///< pixels of the camera, whose first pixel has its center at (0.5, 0.5)
  double inv_depth = 0;  ///< 1/z, 1/world unit; not positive behind the camera
};

/// The points that view `view` (an index of ScenePoint::views) saw, as it sees them.
std::vector<KnownDepth> KnownDepths(const std::vector<ScenePoint>& points, int view, const Camera& camera);

struct AlignmentRule {
  int min_points = 11;
  double min_span = 1e-3;  ///< of the known inverse depths, 1/world unit; less fixes no scale
  double center = 0.5;     ///< of the first pixel, in the map; the public scripts take 0
};

/// inverse depth = scale * relative + offset.
struct Alignment {
  double scale = 0, offset = 0;                        ///< a scale of 0: not fixed
  int points = 0;                                      ///< that were used
  double known_median = 0, known_deviation = 0;        ///< deviation: mean distance from the median
  double relative_median = 0, relative_deviation = 0;  ///< of the map where the points are

  double At(double relative) const { return scale * relative + offset; }
};

/// Makes the medians and mean deviations of both equal, which a minority of wrong points moves little. Scale 0 where
/// there are too few points or all have one distance.
Alignment Align(const RelativeDepth& map, const Camera& camera, const std::vector<KnownDepth>& known,
                const AlignmentRule& rule);

/// For each view of a scene: its scale is within a factor of five of the median of all positive ones.
std::vector<bool> AreReliable(const std::vector<Alignment>& alignments);

/// AlignmentRule::min_span for a scene of any unit: a thousandth of the median known inverse depth. 0 without any.
double MinSpan(const std::vector<std::vector<KnownDepth>>& known);

}  // namespace oraclegs

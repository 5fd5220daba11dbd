#pragma once
// Local correction of a network's depth. With one scale and offset for a whole image it is wrong by tens of percent in
// places; known depths correct it by a scale and an offset that vary slowly over the image
// (docs/method.md#depth-alignment).

#include <cstddef>
#include <vector>

namespace oraclegs {

/// An inverse depth and its true value.
struct DepthSample {
  float x = 0, y = 0;   ///< pixels
  float inv_depth = 0;  ///< before the warp, 1/world unit
  float truth = 0;      ///< > 0
  float weight = 1;     ///< >= 0
};

struct LocalWarpOptions {
  int cells = 16;            ///< grid cells along the image's larger side
  double smoothness = 0.03;  ///< weight of a change from node to node, relative to that of an equal relative error
};

/// inverse depth -> (1 + a) * inverse depth + b, with a and b bilinear between the nodes of a coarse grid.
class LocalWarp {
 public:
  /// Fits the grid to the samples by least squares: of their relative errors, with outliers down-weighted, and of the
  /// changes between neighboring nodes. Nodes without samples continue their neighbors, a little weaker with each.
  /// Without any sample the identity. The image is width x height pixels.
  LocalWarp(int width, int height, const std::vector<DepthSample>& samples, const LocalWarpOptions& options = {});

  float operator()(float x, float y, float inv_depth) const;

 private:
  /// The four nodes around a place and their bilinear weights.
  struct Corners {
    size_t node[4];
    float weight[4];
  };
  Corners CornersOf(float x, float y) const;

  float cell_ = 1;  // pixels
  int across_ = 0, down_ = 0;
  std::vector<float> factor_, addend_;  // a, and b in 1/world unit
};

}  // namespace oraclegs

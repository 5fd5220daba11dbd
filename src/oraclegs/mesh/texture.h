#pragma once
// The texture of a mesh: its charts side by side in a square image.

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/mesh/charts.h"
#include "oraclegs/mesh/vertex_colors.h"

namespace oraclegs {

inline constexpr int kMaxTextureSide = 16384;  ///< pixels; more is beyond what GPUs draw

/// Places of a mesh's surface in a texture, and the points of the surface whose colors it needs.
class TextureAtlas {
 public:
  /// Takes a mesh with normals. A texel covers as much as a pixel of the nearest camera, or more where the texture
  /// would be larger than `max_side` pixels. Throws UsageError for a side that is too small for the charts.
  TextureAtlas(const TriangleMesh& mesh, const std::vector<Camera>& cameras, int max_side);

  /// Positions and normals of the texels, without triangles.
  const TriangleMesh& points() const { return points_; }
  int side() const { return side_; }  ///< pixels

  /// The mesh with the texture of these colors of points(); the nearest seen texel's in the others.
  TriangleMesh Textured(const VertexColors& colors) const;

 private:
  struct Rectangle {
    int x = 0, y = 0, width = 0, height = 0;  // pixels
  };

  bool Pack(double share, int side);
  void Draw(const TriangleMesh& mesh, size_t chart);
  void Fill(const Rectangle& rectangle, std::vector<uint8_t>* seen, Image8* texture) const;
  int64_t Texel(int x, int y) const { return static_cast<int64_t>(y) * side_ + x; }

  std::vector<Chart> charts_;
  std::vector<double> densities_;  // of the charts, texels per scene unit at full size
  std::vector<Rectangle> rectangles_;
  int side_ = 0;
  double share_ = 1;  // of the densities
  TriangleMesh mesh_, points_;
  std::vector<int64_t> texels_;     // of points_
  std::vector<uint8_t> has_point_;  // [side * side]
};

}  // namespace oraclegs

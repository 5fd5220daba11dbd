#pragma once
// Triangle mesh of the surfaces that a model of Gaussians shows.

#include <string>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/mesh/texture.h"
#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

struct MeshOptions {
  Auto<double> voxel;
  Auto<double> truncation;
  int renders = 60;
  double adaptivity = 0.1;
  double min_part = 0.01;
  Auto<int> min_renders;
  int triangles = 300'000;
  Auto<int> texture;
  double unit = 1;  ///< length of a scene unit in mesh units, a factor of the mesh; lengths above are in mesh units

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("voxel", self.voxel,
          "Side of a voxel in units of the mesh: the finest detail; auto is what a pixel covers at the scene's depth",
          Range{1e-9, 1e9});
    visit("trunc", self.truncation,
          "Depths that differ by less are averaged, in units of the mesh; auto is 4 voxels or 1 % of the scene's depth",
          Range{1e-9, 1e9});
    visit("renders", self.renders,
          "Renders whose depth is fused: from the training views, and from cameras between them, up to this number",
          Range{1, 1e5});
    visit("adaptivity", self.adaptivity, "More makes larger triangles where the surface is flat", Range{0, 1});
    visit("min-part", self.min_part, "Parts of less than this share of the whole area are left out", Range{0, 1});
    visit("min-renders", self.min_renders,
          "Surface that fewer renders show is left out; auto is a tenth of them, at most 6", Range{1, 1e5});
    visit("triangles", self.triangles, "At most this many triangles, 0 = all", Range{0, 1e9});
    visit("texture", self.texture,
          "Largest side of the texture in pixels, 0 = a color at each vertex; auto is 4096 for .glb and .obj",
          Range{0, kMaxTextureSide});
  }
};

/// Throws UsageError for options that no scene could have, the ranges among them.
void CheckMesh(const MeshOptions& options);

/// The cameras, and further ones on the smooth path through them in NearestOrder, up to `count` in all.
std::vector<Camera> MeshCameras(const std::vector<Camera>& cameras, int count);

struct FusedMesh {
  TriangleMesh mesh;      ///< with normals and colors, or a texture; empty when the renders show no surface
  double voxel = 0;       ///< voxel side that was used, units of the mesh
  double truncation = 0;  ///< truncation that was used, units of the mesh
};

/// Renders depth and color from MeshCameras, fuses the depth in a truncated signed distance, extracts the part of its
/// surface that renders show, simplifies it and gives it the means of the rendered colors, at its vertices or, with
/// `texture` above 0, in a texture (an automatic one is none). Renders each view three or four times and stores none.
/// Throws UsageError for voxels so small that the machine's memory does not hold them, with a size that fits.
FusedMesh FuseModel(const Gaussians& gaussians, const RenderOptions& render, const std::vector<Camera>& cameras,
                    const MeshOptions& options, const Listener& listener);

}  // namespace oraclegs

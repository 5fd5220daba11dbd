#pragma once
// From a distance on voxels to triangles: OpenVDB's work, in a library of its own that is loaded when it is asked for,
// because it triples the time and the memory that a program takes to start.

#include <filesystem>

#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/mesh/tsdf.h"

namespace oraclegs {

/// Sparse blocks of voxels (tsdf.h), for the library.
struct VoxelField {
  double voxel = 1;
  const std::vector<std::array<int32_t, 3>>* blocks = nullptr;
  const std::vector<float>* distances = nullptr;
  const std::vector<float>* weights = nullptr;
  double adaptivity = 0;  ///< 0..1; more makes larger triangles where the surface is flat
  int threads = 1;
};

/// The surface of distance 0, without normals and colors. Only between observed voxels (weight > 0): where observed
/// inside meets what nobody saw, there is no surface. Throws UsageError when this build has no OpenVDB.
TriangleMesh Isosurface(const VoxelField& field);

/// Throws UsageError, which says what to install, where Isosurface would.
void RequireIsosurface();

/// liboraclegs_openvdb.so beside the program's other libraries. Exported by it as "oraclegs_openvdb_isosurface".
using IsosurfaceFunction = void(const VoxelField& field, TriangleMesh* mesh);

}  // namespace oraclegs

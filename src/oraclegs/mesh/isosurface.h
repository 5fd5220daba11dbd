#pragma once
// Triangles from a distance on voxels: OpenVDB's work, in a library of its own that is loaded on demand, because it
// triples the time and the memory that a program takes to start.

#include <filesystem>

#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/mesh/tsdf.h"

namespace oraclegs {

/// Sparse blocks of voxels (tsdf.h), the input of the library.
struct VoxelField {
  double voxel = 1;
  const std::vector<std::array<int32_t, 3>>* blocks = nullptr;
  const std::vector<float>* distances = nullptr;
  const std::vector<float>* weights = nullptr;
  double adaptivity = 0;  ///< 0..1; larger values make larger triangles where the surface is flat
  int threads = 1;
};

/// The surface of distance 0, without normals and colors, only between observed voxels (weight > 0): the border between
/// observed inside and unobserved voxels is no surface. Throws UsageError when this build has no OpenVDB.
TriangleMesh Isosurface(const VoxelField& field);

/// Throws the UsageError of Isosurface, which says what to install, when this build has no OpenVDB.
void RequireIsosurface();

/// Function of liboraclegs_openvdb.so, which is beside the program's other libraries. Exported as
/// "oraclegs_openvdb_isosurface".
using IsosurfaceFunction = void(const VoxelField& field, TriangleMesh* mesh);

}  // namespace oraclegs

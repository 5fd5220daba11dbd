// The library behind mesh/isosurface.h. The only file that includes OpenVDB, whose headers take as long to compile as a
// floor.

#include <openvdb/Grid.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/mesh/isosurface.h"

namespace oraclegs {
namespace {

using openvdb::BoolGrid;
using openvdb::Coord;
using openvdb::FloatGrid;
static_assert(FloatGrid::TreeType::LeafNodeType::DIM == kBlockSide);

/// The blocks as leaves; observed voxels are active.
FloatGrid::Ptr GridOf(const VoxelField& field) {
  FloatGrid::Ptr grid = FloatGrid::create(1.f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(field.voxel));
  for (size_t b = 0; b < field.blocks->size(); ++b) {
    const auto& block = (*field.blocks)[b];
    const Coord origin(block[0] * kBlockSide, block[1] * kBlockSide, block[2] * kBlockSide);
    FloatGrid::TreeType::LeafNodeType* leaf = grid->tree().touchLeaf(origin);
    const float* distances = field.distances->data() + b * kBlockVoxels;
    const float* weights = field.weights->data() + b * kBlockVoxels;
    for (openvdb::Index i = 0; i < kBlockVoxels; ++i) {
      if (weights[i] > 0) leaf->setValueOn(i, distances[i]);
    }
  }
  return grid;
}

/// Cells, named by their lowest corner, whose eight corners are all observed.
BoolGrid::Ptr WholeCells(const FloatGrid& grid) {
  BoolGrid::Ptr cells = BoolGrid::create(false);
  cells->setTransform(grid.transform().copy());
  cells->tree().topologyUnion(grid.tree());
  std::vector<BoolGrid::TreeType::LeafNodeType*> leaves;
  cells->tree().getNodes(leaves);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, leaves.size()), [&](const tbb::blocked_range<size_t>& range) {
    FloatGrid::ConstAccessor observed = grid.getConstAccessor();
    for (size_t l = range.begin(); l < range.end(); ++l) {
      BoolGrid::TreeType::LeafNodeType::NodeMaskType whole;
      for (auto it = leaves[l]->cbeginValueOn(); it; ++it) {
        bool all = true;
        for (int corner = 1; corner < 8 && all; ++corner) {
          all = observed.isValueOn(it.getCoord().offsetBy(corner & 1, corner >> 1 & 1, corner >> 2));
        }
        if (all) whole.setOn(it.pos());
      }
      for (openvdb::Index i = 0; i < kBlockVoxels; ++i) leaves[l]->setValueOnly(i, whole.isOn(i));
      leaves[l]->setValueMask(whole);
    }
  });
  return cells;
}

Eigen::Vector3f ToEigen(const openvdb::Vec3s& v) { return {v.x(), v.y(), v.z()}; }

/// Two triangles of a quadrilateral, along its shorter diagonal.
void AddQuad(const openvdb::Vec4I& quad, TriangleMesh* mesh) {
  const auto at = [&](int k) { return mesh->positions[quad[k]]; };
  const bool along02 = (at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm();
  const auto first = along02 ? 0 : 1;
  const auto vertex = [&](int k) { return quad[(first + k) % 4]; };
  mesh->triangles.push_back({vertex(0), vertex(1), vertex(2)});
  mesh->triangles.push_back({vertex(0), vertex(2), vertex(3)});
}

}  // namespace
}  // namespace oraclegs

extern "C" void oraclegs_openvdb_isosurface(const oraclegs::VoxelField& field, oraclegs::TriangleMesh* mesh);

void oraclegs_openvdb_isosurface(const oraclegs::VoxelField& field, oraclegs::TriangleMesh* mesh) {
  using namespace oraclegs;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<size_t>(std::max(1, field.threads)));
  const FloatGrid::Ptr grid = GridOf(field);
  openvdb::tools::VolumeToMesh mesher(0.0, field.adaptivity, true);
  mesher.setSurfaceMask(WholeCells(*grid));
  mesher(*grid);
  mesh->positions.reserve(mesher.pointListSize());
  for (size_t i = 0; i < mesher.pointListSize(); ++i) mesh->positions.push_back(ToEigen(mesher.pointList()[i]));
  for (size_t p = 0; p < mesher.polygonPoolListSize(); ++p) {
    const openvdb::tools::PolygonPool& pool = mesher.polygonPoolList()[p];
    for (size_t i = 0; i < pool.numQuads(); ++i) AddQuad(pool.quad(i), mesh);
    for (size_t i = 0; i < pool.numTriangles(); ++i) {
      const openvdb::Vec3I& t = pool.triangle(i);
      mesh->triangles.push_back({t[0], t[1], t[2]});
    }
  }
}

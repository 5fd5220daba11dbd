#pragma once
// A truncated signed distance on sparse blocks of voxels [Curless 1996]: what many views agree on about a surface.

#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/mesh/surface_view.h"

namespace oraclegs {

inline constexpr int kBlockSide = 8;  ///< voxels, of OpenVDB's leaves
inline constexpr int64_t kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;
/// Memory that a block takes until its surface is a mesh: distances, weights, OpenVDB's copies and what it derives.
inline constexpr int64_t kBlockBytes = 16 * 1024;

/// The blocks near the surfaces of some views, for a size of voxels.
class TsdfBlocks {
 public:
  /// `voxel`: side of a voxel, `truncation`: distance behind and before a surface that is kept; scene units.
  TsdfBlocks(double voxel, double truncation) : voxel_(voxel), truncation_(truncation) {}

  /// Adds those around the believed pixels of a view. Throws UsageError when a place is more than a million blocks from
  /// the origin.
  void Add(const SurfaceView& view);

  double voxel() const { return voxel_; }
  double truncation() const { return truncation_; }
  int64_t count() const { return static_cast<int64_t>(keys_.size()); }
  /// How many there would be for voxels of twice the size, `doublings` times.
  int64_t CountAt(int doublings) const;
  /// Coordinates in blocks: the block's voxels have their centers at voxel * (8 * block + 0 .. 7).
  std::vector<std::array<int32_t, 3>> Coordinates() const;

 private:
  double voxel_, truncation_;
  std::vector<uint64_t> keys_;  // sorted
};

/// Throws UsageError when the blocks need more than the `available` bytes, with a size of voxels that fits; 0 = not
/// known.
void RequireRoom(const TsdfBlocks& blocks, uint64_t available);

class TsdfVolume {
 public:
  explicit TsdfVolume(const TsdfBlocks& blocks);

  /// Adds what a view says about every voxel: its distance to the surface on the line of sight, where it is not hidden
  /// behind it by more than the truncation.
  void Integrate(const SurfaceView& view);

  double voxel() const { return voxel_; }
  const std::vector<std::array<int32_t, 3>>& blocks() const { return blocks_; }
  /// [blocks, 8, 8, 8] with z the fastest; distance over truncation in [-1, 1], negative inside; 1 where not observed.
  const std::vector<float>& distances() const { return distances_; }
  const std::vector<float>& weights() const { return weights_; }  ///< of the same shape; 0 = not observed

 private:
  double voxel_;
  float truncation_;
  std::vector<std::array<int32_t, 3>> blocks_;
  std::vector<float> distances_, weights_;
};

}  // namespace oraclegs

#pragma once
// Truncated signed distance on sparse blocks of voxels [Curless 1996]: the fused surface of many views.

#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/mesh/surface_view.h"

namespace oraclegs {

inline constexpr int kBlockSide = 8;  ///< voxels per side, those of OpenVDB's leaves
inline constexpr int64_t kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;
/// Memory of a block until its surface is a mesh: distances, weights, OpenVDB's copies and its intermediate results.
inline constexpr int64_t kBlockBytes = 16 * 1024;

/// The blocks near the surfaces of some views, for one voxel size.
class TsdfBlocks {
 public:
  /// Starts without blocks. `voxel`: side of a voxel; `truncation`: distance behind and before a surface that is kept;
  /// scene units.
  TsdfBlocks(double voxel, double truncation) : voxel_(voxel), truncation_(truncation) {}

  /// Adds the blocks around the trusted pixels of a view. Throws UsageError for a place more than a million blocks from
  /// the origin.
  void Add(const SurfaceView& view);

  double voxel() const { return voxel_; }
  double truncation() const { return truncation_; }
  int64_t count() const { return static_cast<int64_t>(keys_.size()); }
  /// Number of blocks for voxels of 2^doublings times the size.
  int64_t CountAt(int doublings) const;
  /// Coordinates in blocks: the block's voxels have their centers at voxel * (8 * block + 0 .. 7).
  std::vector<std::array<int32_t, 3>> Coordinates() const;

 private:
  double voxel_, truncation_;
  std::vector<uint64_t> keys_;  // sorted
};

/// Throws UsageError when the blocks need more than the `available` bytes (0 = unknown); the message names a voxel size
/// that fits.
void RequireRoom(const TsdfBlocks& blocks, uint64_t available);

class TsdfVolume {
 public:
  explicit TsdfVolume(const TsdfBlocks& blocks);

  /// Fuses a view into every voxel: its distance to the surface on the line of sight, unless it is hidden behind that
  /// by more than the truncation.
  void Integrate(const SurfaceView& view);

  double voxel() const { return voxel_; }
  const std::vector<std::array<int32_t, 3>>& blocks() const { return blocks_; }
  /// [blocks, 8, 8, 8] with z the fastest; distance over truncation in [-1, 1], negative inside; 1 where not observed.
  const std::vector<float>& distances() const { return distances_; }
  const std::vector<float>& weights() const { return weights_; }  ///< [blocks, 8, 8, 8]; 0 = not observed

 private:
  double voxel_;
  float truncation_;
  std::vector<std::array<int32_t, 3>> blocks_;
  std::vector<float> distances_, weights_;
};

}  // namespace oraclegs

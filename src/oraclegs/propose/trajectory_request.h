#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/depth/fusion.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// What is known of a scene when targets are chosen.
struct TrajectoryRequest {
  std::vector<Camera> train;  ///< at least one; generated targets have the intrinsics of the first
  std::vector<Camera> test;   ///< never a target
  std::vector<Target> spare;  ///< posed views that are neither, named like their image ("left/0001.jpg")
  const std::vector<DepthMap>* maps = nullptr;      ///< of the training views
  const std::vector<DensePoint>* points = nullptr;  ///< where surfaces are
  uint64_t seed = 0;
};

}  // namespace oraclegs

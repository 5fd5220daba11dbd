#pragma once
// VGGT's camera head (docs/method.md#vggt-camera-head).

#include <vector>

#include "oraclegs/networks/common/transformer_block.h"

namespace oraclegs::vggt {

struct CameraHeadConfig {
  int64_t width = 2048;  ///< twice the aggregator's width
  int64_t depth = 4, heads = 16, mlp_ratio = 4;
  int64_t iterations = 4;
};

struct CameraHead {
  CameraHeadConfig config;
  Tensor empty_pose;  ///< [1, 1, 9]
  Linear embed_pose, modulation;
  LayerNorm token_norm, trunk_norm;
  std::vector<Block> trunk;
  Mlp pose_branch;
};
CameraHead LoadCameraHead(const ParameterScope& at, const CameraHeadConfig& config);

/// Encodings [S, 9] float32 after each iteration; the last is the result: translation, quaternion x y z w (not
/// normalized), vertical and horizontal field of view in radians. tokens [S, width]: camera tokens of the aggregator's
/// last layer. Throws ShapeError.
std::vector<Tensor> CameraEncodings(const CameraHead& head, const Tensor& tokens);

struct DecodedCameras {
  Tensor extrinsics;                   ///< [S, 3, 4] float32, world to camera, x right, y down, z forward
  Tensor intrinsics;                   ///< [S, 3, 3] float32 in pixels of the network's input
  std::vector<int64_t> without_focal;  ///< views whose field of view is 0: their focal length is infinite
};
/// height, width: size of the network's input. Throws ShapeError.
DecodedCameras DecodeCameras(const Tensor& encoding, int64_t height, int64_t width);

}  // namespace oraclegs::vggt

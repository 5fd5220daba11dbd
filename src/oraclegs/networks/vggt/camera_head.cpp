#include "oraclegs/networks/vggt/camera_head.h"

#include <cmath>

namespace oraclegs::vggt {
namespace {

constexpr int64_t kPose = 9;
constexpr double kBlockEps = 1e-5;
constexpr double kAdaptiveEps = 1e-6;

/// Camera tokens modulated by the current pose: an affine map of the normed tokens, gated, added to the tokens.
Tensor Modulated(const CameraHead& head, const Tensor& tokens, const Tensor& pose) {
  const Tensor parts = Forward(head.modulation, at::silu(Forward(head.embed_pose, pose)));
  const auto split = parts.chunk(3, -1);  // shift, scale, gate
  const Tensor plain = at::layer_norm(tokens, {tokens.size(-1)}, {}, {}, kAdaptiveEps);
  return split[2] * (plain * (1 + split[1]) + split[0]) + tokens;
}

}  // namespace

CameraHead LoadCameraHead(const ParameterScope& at, const CameraHeadConfig& config) {
  CameraHead head;
  head.config = config;
  head.empty_pose = at.Get("empty_pose_tokens", {1, 1, kPose});
  head.embed_pose = LoadLinear(at / "embed_pose", kPose, config.width);
  head.modulation = LoadLinear(at / "poseLN_modulation" / 1, config.width, 3 * config.width);
  head.token_norm = LoadLayerNorm(at / "token_norm", config.width, kBlockEps);
  head.trunk_norm = LoadLayerNorm(at / "trunk_norm", config.width, kBlockEps);
  for (int64_t i = 0; i < config.depth; ++i) {
    head.trunk.push_back(LoadBlock(at / "trunk" / i, {config.width, config.heads, config.mlp_ratio, kBlockEps}));
  }
  head.pose_branch = LoadMlp(at / "pose_branch", {config.width, config.width / 2, kPose});
  return head;
}

std::vector<Tensor> CameraEncodings(const CameraHead& head, const Tensor& tokens) {
  if (tokens.dim() != 2 || tokens.size(1) != head.config.width) {
    throw ShapeError("CameraEncodings: the tokens are [{}], expected [any, {}]", fmt::join(tokens.sizes(), ", "),
                     head.config.width);
  }
  const int64_t views = tokens.size(0);
  const Tensor normed = Forward(head.token_norm, tokens.to(head.empty_pose.options())).unsqueeze(0);  // [1, S, width]
  Tensor pose;
  std::vector<Tensor> encodings;
  for (int64_t i = 0; i < head.config.iterations; ++i) {
    Tensor x = Modulated(head, normed, pose.defined() ? pose : head.empty_pose.expand({1, views, kPose}));
    for (const Block& block : head.trunk) x = Forward(block, x);
    const Tensor step = Forward(head.pose_branch, Forward(head.trunk_norm, x));
    pose = pose.defined() ? pose + step : step;
    // The pose that is fed back is not rectified.
    encodings.push_back(at::cat({pose.slice(2, 0, 7), at::relu(pose.slice(2, 7))}, 2)[0].to(torch::kFloat));
  }
  return encodings;
}

DecodedCameras DecodeCameras(const Tensor& encoding, int64_t height, int64_t width) {
  if (encoding.dim() != 2 || encoding.size(1) != kPose) {
    throw ShapeError("DecodeCameras: the encoding is [{}], expected [any, 9]", fmt::join(encoding.sizes(), ", "));
  }
  const Tensor e = encoding.to(torch::kCPU, torch::kDouble).contiguous();
  const int64_t views = e.size(0);
  DecodedCameras out{torch::empty({views, 3, 4}, torch::kDouble), torch::zeros({views, 3, 3}, torch::kDouble), {}};
  const auto in = e.accessor<double, 2>();
  auto extrinsics = out.extrinsics.accessor<double, 3>(), intrinsics = out.intrinsics.accessor<double, 3>();
  for (int64_t v = 0; v < views; ++v) {
    const double x = in[v][3], y = in[v][4], z = in[v][5], w = in[v][6];
    const double s = 2 / (x * x + y * y + z * z + w * w);
    const double rows[3][4] = {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), in[v][0]},
                               {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), in[v][1]},
                               {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), in[v][2]}};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) extrinsics[v][r][c] = rows[r][c];
    }
    const double half_height = static_cast<double>(height) / 2, half_width = static_cast<double>(width) / 2;
    intrinsics[v][0][0] = half_width / std::tan(in[v][8] / 2);
    intrinsics[v][1][1] = half_height / std::tan(in[v][7] / 2);
    intrinsics[v][0][2] = half_width;
    intrinsics[v][1][2] = half_height;
    intrinsics[v][2][2] = 1;
    if (in[v][7] == 0 || in[v][8] == 0) out.without_focal.push_back(v);
  }
  out.extrinsics = out.extrinsics.to(torch::kFloat);
  out.intrinsics = out.intrinsics.to(torch::kFloat);
  return out;
}

}  // namespace oraclegs::vggt

#pragma once
// The last stage of the backward pass with a consumer of the gradients: one thread per Gaussian computes them and hands
// them over in registers, so that they need not go through memory. The consumer is a small struct, copied to the
// device, with
//
//   __device__ void ConsumeSmall(int64_t i, const GaussianGrad& grad) const;
//   __device__ void ConsumeSh(int64_t i, int first, float4 grad) const;
//
// ConsumeSmall is called once for each Gaussian i, seen or not. ConsumeSh is called after it, and sees what it wrote,
// for first = 0, 4, 8, ... below 3 (degree + 1)^2 with dL/d(sh) of floats [first, first + 4) of row i, zero above the
// active degree; neighboring lanes have neighboring floats. Both may change row i of the parameters, and no other:
// ConsumeSh that of sh, ConsumeSmall the rest.

#include "oraclegs/render/cuda/warp-inl.cuh"

namespace oraclegs::cuda {

/// dL/d(raw parameter) of one Gaussian; SH: the constant coefficient only. Zero where it was not seen.
struct GaussianGrad {
  float mean[3] = {}, log_scale[3] = {}, quat[4] = {}, logit = 0, sh0[3] = {};
};

/// Pairs of a Gaussian above which the whole warp sums them.
inline constexpr uint32_t kMaxPairsPerThread = 16;

/// Sums one Gaussian's records, in an order that depends on their number only.
__device__ inline void SumRecords(const GaussianBackwardInput& in, uint32_t begin, uint32_t count, float* sums) {
  const int lane = LaneInWarp();
  for (int k = 0; k < kRecord; ++k) sums[k] = 0;
  const auto add = [&in](uint32_t pair, float* to) {
    const float2* from = reinterpret_cast<const float2*>(in.records + int64_t{kRecord} * pair);
    for (int k = 0; k < kRecord / 2; ++k) {
      const float2 v = from[k];
      to[2 * k] += v.x, to[2 * k + 1] += v.y;
    }
  };
  if (count <= kMaxPairsPerThread) {
    for (uint32_t j = 0; j < count; ++j) add(begin + j, sums);
  }
  for (unsigned left = __ballot_sync(kAllLanes, count > kMaxPairsPerThread); left != 0; left &= left - 1) {
    const int from = __ffs(static_cast<int>(left)) - 1;
    const uint32_t first = __shfl_sync(kAllLanes, begin, from), n = __shfl_sync(kAllLanes, count, from);
    float part[kRecord] = {};
    for (uint32_t j = static_cast<uint32_t>(lane); j < n; j += kWarp) add(first + j, part);
    for (int k = 0; k < kRecord; ++k) {
      const float sum = WarpSum(part[k]);
      if (lane == from) sums[k] = sum;
    }
  }
}

/// Gradient of the small parameters of one seen Gaussian. `row`: its SH, which becomes dL/d(sh). `camera_terms`: null =
/// not watched.
__device__ inline GaussianGrad BackwardOfOne(const GaussianBackwardInput& in, int64_t i, const float* sums, float* row,
                                             CameraTerms<float>* camera_terms) {
  const SplatCamera<float>& camera = in.camera;
  const RawSplat<float> raw = LoadRaw(in.parameters, i);
  const SplatChain<float> chain = EvaluateChain(raw, camera);
  const ProjectedSplat<float> p = Project(chain, camera);
  const ProjectedGrad<float> g = ProjectedGradOf(
      p, BlendSums<float>{sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6], sums[7], sums[8], sums[9]});
  if (in.screen_sums != nullptr) {
    const float x = g.mx * (0.5f * static_cast<float>(camera.width));
    const float y = g.my * (0.5f * static_cast<float>(camera.height));
    in.screen_sums[i] += sqrtf(x * x + y * y);
    in.screen_views[i] += 1;
  }
  const CameraSpaceGrad<float> space_grad = ProjectBackward(chain, camera, g);
  const RawGrad<float> small = RawBackward(chain, camera, space_grad);
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  const auto store = [row, coefficients](const float* basis, const Vec3<float>& g_color) {
#pragma unroll
    for (int k = 0; k < kMaxShTerms; ++k) {
      if (k >= coefficients) break;
      row[3 * k] = basis[k] * g_color.x, row[3 * k + 1] = basis[k] * g_color.y, row[3 * k + 2] = basis[k] * g_color.z;
    }
  };
  const Vec3<float> from_color =
      ColorBackward(camera, raw.mean, ShRow{row}, Vec3<float>{sums[6], sums[7], sums[8]}, store);

  GaussianGrad out;
  out.mean[0] = small.mean.x + from_color.x;
  out.mean[1] = small.mean.y + from_color.y;
  out.mean[2] = small.mean.z + from_color.z;
  out.log_scale[0] = small.log_scale.x, out.log_scale[1] = small.log_scale.y, out.log_scale[2] = small.log_scale.z;
  out.quat[0] = small.qw, out.quat[1] = small.qx, out.quat[2] = small.qy, out.quat[3] = small.qz;
  out.logit = small.logit;
  if (camera_terms != nullptr) {
    *camera_terms = CameraBackward(chain, camera, g, space_grad, Vec3<float>{out.mean[0], out.mean[1], out.mean[2]});
  }
  return out;
}

/// Blocks per multiprocessor for which registers suffice without spills.
inline constexpr int BlocksOf(bool watches_camera) { return watches_camera ? 5 : 6; }

template <bool kWatchesCamera, class Consumer>
__global__ void __launch_bounds__(kShThreads, BlocksOf(kWatchesCamera))
    GaussianBackwardKernel(GaussianBackwardInput in, Consumer consumer) {
  __shared__ float sh_rows[kShThreads * kShRowStride];
  const int64_t i = ThreadInGrid();
  const int lane = LaneInWarp();
  const int64_t n = in.parameters.n, first = i - lane;
  if (first >= n) return;  // a whole warp
  const uint32_t count = i < n ? in.counts[i] : 0;
  float sums[kRecord];
  SumRecords(in, count > 0 ? in.begins[i] : 0, count, sums);

  const int floats = 3 * (in.camera.sh_degree + 1) * (in.camera.sh_degree + 1), chunks = (floats + 3) / 4;
  float* rows = sh_rows + threadIdx.x / kWarp * kWarp * kShRowStride;
  float* row = rows + lane * kShRowStride;
  LoadShRows(in.parameters.sh, first, __ballot_sync(kAllLanes, count > 0), floats, rows);
  GaussianGrad grad;
  int zeros_from = 0;
  [[maybe_unused]] CameraTerms<float> camera_terms{};
  if (count > 0) {
    grad = BackwardOfOne(in, i, sums, row, kWatchesCamera ? &camera_terms : nullptr);
    zeros_from = floats;
  }
  if constexpr (kWatchesCamera) {
    for (int k = 0; k < kCameraSums; ++k) {
      const float sum = WarpSum(camera_terms.of[k]);
      if (lane == 0) in.camera_sums[k * WarpsOf(n) + i / kWarp] = sum;
    }
  }
  for (int k = zeros_from; k < 4 * chunks; ++k) row[k] = 0;
  for (int k = 0; k < 3; ++k) grad.sh0[k] = row[k];
  if (i < n) consumer.ConsumeSmall(i, grad);
  __syncwarp();
  for (int item = lane; item < kWarp * chunks; item += kWarp) {
    const int row_of_warp = item / chunks, at = item % chunks * 4;
    if (first + row_of_warp >= n) break;
    const float* from = rows + row_of_warp * kShRowStride + at;
    consumer.ConsumeSh(first + row_of_warp, at, make_float4(from[0], from[1], from[2], from[3]));
  }
}

/// Queues the stage on its stream: computes all gradients and hands them to copies of `consumer`. `name` appears in
/// errors.
template <class Consumer>
void RunGaussianBackward(const char* name, const GaussianBackwardInput& in, const Consumer& consumer) {
  const auto kernel =
      in.camera_sums != nullptr ? GaussianBackwardKernel<true, Consumer> : GaussianBackwardKernel<false, Consumer>;
  Launch(name, kernel, LaunchShape::For(in.parameters.n, kShThreads), in.stream, in, consumer);
}

}  // namespace oraclegs::cuda

#include "oraclegs/train/cuda/outliers.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr int kBlock = 256;

/// Adds the view's vote where it contributes one (train/outliers.cpp).
__device__ void Vote(const DepthView& view, const float* mean, FloaterVotes* votes) {
  double point[3];
  for (int row = 0; row < 3; ++row) {
    const double* m = view.cam_from_world + 4 * row;
    point[row] = m[0] * static_cast<double>(mean[0]) + m[1] * static_cast<double>(mean[1]) +
                 m[2] * static_cast<double>(mean[2]) + m[3];
  }
  if (!(point[2] > static_cast<double>(kNearPlane))) return;
  const double x = view.fx * point[0] / point[2] + view.cx, y = view.fy * point[1] / point[2] + view.cy;
  if (!(x >= 0 && y >= 0 && x < view.width && y < view.height)) return;
  const int64_t pixel = static_cast<int64_t>(y) * view.width + static_cast<int64_t>(x);
  if (view.depth_mask.At(pixel) > kTrustedDepth) votes->Add(point[2] * static_cast<double>(view.inv_depth[pixel]));
}

__global__ void FindFloaters(FloatersInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i >= in.count) return;
  in.floats[i] = 0;
  if (!(OpacityOf(in.params.opacity_logits[i]) > static_cast<double>(kDeadOpacity))) return;
  FloaterVotes votes;
  for (int view = 0; view < in.num_views; ++view) Vote(in.views[view], in.params.means + 3 * i, &votes);
  atomicAdd(in.counts, 1);
  if (!votes.IsFloater()) return;
  in.floats[i] = 1;
  atomicAdd(in.counts + 1, 1);
}

__global__ void LowerFloaters(FloatersInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < in.count && in.floats[i] && in.counts[0] != in.counts[1]) in.params.opacity_logits[i] = kPrunedLogit;
}

__global__ void CapScales(ScaleCapInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i >= in.count) return;
  const float cap = LogScaleCap(in.params.means + 3 * i, in.centers, in.num_centers, in.log_share);
  for (int64_t k = 3 * i; k < 3 * i + 3; ++k) {
    if (in.params.log_scales[k] > cap) in.params.log_scales[k] = cap;
  }
}

}  // namespace

void RunPruneFloaters(const FloatersInput& in, cudaStream_t stream) {
  Check(cudaMemsetAsync(in.counts, 0, 2 * sizeof(int), stream), "pruning floaters");
  Launch("floaters", FindFloaters, LaunchShape::For(in.count, kBlock), stream, in);
  Launch("pruning of floaters", LowerFloaters, LaunchShape::For(in.count, kBlock), stream, in);
}

void RunCapScales(const ScaleCapInput& in, cudaStream_t stream) {
  if (in.num_centers == 0) return;
  Launch("the cap of scales", CapScales, LaunchShape::For(in.count, kBlock), stream, in);
}

}  // namespace oraclegs::cuda

#include "oraclegs/render/cuda/projection.h"

#include "oraclegs/render/cuda/warp-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Computes the tiles of [center - half, center + half] along one axis as [*first, *last); returns whether there are
/// any. Exact but for rounding, which widens them (docs/method.md#tiles-and-sorting). NaN is not visible.
__device__ inline bool TilesAlong(float center, float half, int size, uint16_t* first, uint16_t* last) {
  const float slack = 1e-3f;  // of a pixel: many ulp at any image size
  const float low = ceilf(center - half - 0.5f - slack), high = floorf(center + half - 0.5f + slack);
  const float end = static_cast<float>(size - 1);
  if (!(low <= high && high >= 0.f && low <= end)) return false;
  *first = static_cast<uint16_t>(static_cast<int>(Max(0.f, Min(low, end))) / kTile);
  *last = static_cast<uint16_t>(static_cast<int>(Max(0.f, Min(high, end))) / kTile + 1);
  return true;
}

__global__ void __launch_bounds__(kShThreads)
    ProjectKernel(SplatCamera<float> camera, GaussianParameters parameters, Splat* splats, TileRect* rects) {
  __shared__ float sh_rows[kShThreads * kShRowStride];
  const int64_t i = ThreadInGrid();
  bool visible = i < parameters.n;
  ProjectedSplat<float> p{};
  Vec3<float> mean{};
  float log_opacity = 0;
  TileRect rect{};
  if (visible) {
    const RawSplat<float> raw = LoadRaw(parameters, i);
    mean = raw.mean;
    p = Project(EvaluateChain(raw, camera), camera);
    if (parameters.opacity_factors != nullptr) p.opacity *= parameters.opacity_factors[i];
    // alpha >= 1/255 inside |d|_K <= k, k^2 = 2 ln(255 o'), whose bounding box is k sqrt(diag(cov)).
    log_opacity = logf(Max(p.opacity, 1e-30f));
    const float k2 = Max(2.f * (log_opacity + kLog255), 0.f);
    visible = p.z > kNearPlane && p.opacity >= kAlphaMin &&
              TilesAlong(p.mx, Sqrt(k2 * p.cov_a), camera.width, &rect.x0, &rect.x1) &&
              TilesAlong(p.my, Sqrt(k2 * p.cov_c), camera.height, &rect.y0, &rect.y1);
    rects[i] = visible ? rect : TileRect{};
  }
  const unsigned mask = __ballot_sync(kAllLanes, visible);
  if (mask == 0) return;
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  float* rows = sh_rows + threadIdx.x / kWarp * kWarp * kShRowStride;
  LoadShRows(parameters.sh, i - LaneInWarp(), mask, 3 * coefficients, rows);
  if (!visible) return;
  float basis[16], inv_distance;
  ShBasis(camera.sh_degree, ViewDirection(mean, camera, &inv_distance), basis);
  const Vec3<float> color = RawColor(rows + LaneInWarp() * kShRowStride, basis, coefficients);
  Splat s;
  s.mx = p.mx, s.my = p.my;
  s.ax = Sqrt(0.5f * kLog2E / p.cov_a);
  s.by = Sqrt(0.5f * kLog2E * p.conic_c);
  s.slope = p.conic_b / p.conic_c;
  s.log2_opacity = kLog2E * log_opacity;
  s.depth = p.z;
  s.unused = 0;
  s.r = Max(color.x, 0.f), s.g = Max(color.y, 0.f), s.b = Max(color.z, 0.f);
  s.inv_z = 1.f / p.z;
  splats[i] = s;
}

}  // namespace

void ProjectSplats(const SplatCamera<float>& camera, const GaussianParameters& parameters, Splat* splats,
                   TileRect* rects, cudaStream_t stream) {
  Launch("projection", ProjectKernel, LaunchShape::For(parameters.n, kShThreads), stream, camera, parameters, splats,
         rects);
}

}  // namespace oraclegs::cuda

#include "oraclegs/render/cuda/stages.h"

#include "oraclegs/render/cuda/warp-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Computes the tiles of [center - half, center + half] along one axis as [*first, *last); returns whether there are
/// any.
__device__ inline bool TilesAlong(float center, float half, int size, uint16_t* first, uint16_t* last) {
  PixelSpan<float> span;
  if (!SpanAlong(center, half, size, &span)) return false;
  *first = static_cast<uint16_t>(static_cast<int>(span.first) / kTile);
  *last = static_cast<uint16_t>(static_cast<int>(span.last) / kTile + 1);
  return true;
}

__global__ void __launch_bounds__(kShThreads)
    ProjectKernel(SplatCamera<float> camera, GaussianParameters parameters, Splat* splats, TileRect* rects) {
  __shared__ float sh_rows[kShThreads * kShRowStride];
  const int64_t i = ThreadInGrid();
  bool visible = i < parameters.n;
  ProjectedSplat<float> p{};
  Vec3<float> mean{};
  Ellipse<float> ellipse{};
  TileRect rect{};
  if (visible) {
    const RawSplat<float> raw = LoadRaw(parameters, i);
    mean = raw.mean;
    p = Project(EvaluateChain(raw, camera), camera);
    if (parameters.opacity_factors != nullptr) p.opacity *= parameters.opacity_factors[i];
    ellipse = EllipseOf(p);
    visible = IsVisible(p) && TilesAlong(p.mx, ellipse.half_x, camera.width, &rect.x0, &rect.x1) &&
              TilesAlong(p.my, ellipse.half_y, camera.height, &rect.y0, &rect.y1);
    rects[i] = visible ? rect : TileRect{};
  }
  const unsigned mask = __ballot_sync(kAllLanes, visible);
  if (mask == 0) return;
  const int coefficients = (camera.sh_degree + 1) * (camera.sh_degree + 1);
  float* rows = sh_rows + threadIdx.x / kWarp * kWarp * kShRowStride;
  LoadShRows(parameters.sh, i - LaneInWarp(), mask, 3 * coefficients, rows);
  if (!visible) return;
  float basis[kMaxShTerms], inv_distance;
  ShBasis(camera.sh_degree, ViewDirection(mean, camera, &inv_distance), basis);
  float s[sizeof(Splat) / sizeof(float)];
  SplatFields(p, ellipse.log_opacity, RawColor(ShRow{rows + LaneInWarp() * kShRowStride}, basis, coefficients), s);
  splats[i] = {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9], s[10], s[11]};
}

}  // namespace

void ProjectSplats(const SplatCamera<float>& camera, const GaussianParameters& parameters, Splat* splats,
                   TileRect* rects, cudaStream_t stream) {
  Launch("projection", ProjectKernel, LaunchShape::For(parameters.n, kShThreads), stream, camera, parameters, splats,
         rects);
}

}  // namespace oraclegs::cuda

#include <type_traits>

#include "oraclegs/render/cuda/falloff-inl.cuh"
#include "oraclegs/render/cuda/stages.h"

namespace oraclegs::cuda {
namespace {

constexpr int kWarpsPerBlock = 4;                          // share a bucket, two patches of the tile each
constexpr int kPatches = kTilePixels / kWarp;              // of a tile: 8 x 4 pixels, a lane each
constexpr int kPatchWidth = 8, kPatchHeight = 4;           // px
constexpr int kBatch = 16;                                 // Gaussians whose terms are summed at once
constexpr int kRowsALane = kPatchHeight * kBatch / kWarp;  // of a patch, when terms are summed
constexpr int kTermRow = kWarp + 1;                        // the lanes that sum meet no bank twice
constexpr unsigned kFirst = 0x80000000u;                   // of a run, in a mask
static_assert(kWarp == kPatchWidth * kPatchHeight && kRowsALane > 0 && kRun == kWarp);

/// Contribution of a pixel to the sums of a Gaussian: h and w of BlendBackward's records.
struct alignas(8) Term {
  float change, weight;
};

/// Shared memory of one warp.
template <int kLength>
struct Room {
  float4 gradients[kWarp];  // of the patch's pixels: dL/d(rgb), dL/d(inv_depth)
  Term terms[kBatch][kTermRow];
  float sums[kRecord][kLength];  // of the bucket's entries
};

/// Place of a bucket in its tile.
struct Place {
  int tile, x, y;  // px
  uint32_t first;  // entry of the tile's list
  int count;       // entries
  int64_t begin;   // of the bucket in the sorted list
  const float* states;
};

/// A pixel that passes the Gaussians of a bucket, near to far.
struct Ray {
  float x = 0, y = 0;                         // its center, px
  int end = 0;                                // first entry of the bucket that does not contribute
  float4 gradient = make_float4(0, 0, 0, 0);  // dL/d(rgb), dL/d(inv_depth)
  float transmittance = 0;
  float rest = 0;  // what the rest of the list, and the background, add to the loss

  __device__ Term Pass(const Splat& s, bool contributes) {
    const float e = Log2Alpha(s, x - s.mx, y - s.my);
    const float full = contributes && e >= kLog2AlphaMin ? Exp2(e) : 0.f, alpha = Min(full, kAlphaMax);
    const float value = gradient.x * s.r + gradient.y * s.g + gradient.z * s.b + gradient.w * s.inv_z;
    const float weight = alpha * transmittance;
    rest = fmaf(-weight, value, rest);
    const float d_alpha = fmaf(transmittance, value, -rest * Reciprocal(1.f - alpha));
    transmittance = NextTransmittance(alpha, transmittance);
    return {full < kAlphaMax ? alpha * d_alpha : 0.f, weight};
  }
};

/// Pixel `i` of the tile as the bucket finds it.
__device__ inline Ray LoadRay(const BlendBackwardInput& in, const Place& place, int i) {
  const SplatCamera<float>& camera = in.forward.camera;
  const int x = place.x + PixelX(i), y = place.y + PixelY(i);
  Ray ray;
  ray.x = static_cast<float>(x) + 0.5f, ray.y = static_cast<float>(y) + 0.5f;
  const uint32_t end = in.kept.ends[int64_t{place.tile} * kTilePixels + i];  // 0 outside the image
  if (end <= place.first) return ray;
  ray.end = static_cast<int>(end - place.first);
  const int64_t pixel = int64_t{y} * camera.width + x;
  float4& g = ray.gradient;
  if (in.upstream.image != nullptr) {
    const float* from = in.upstream.image + 3 * pixel;
    g.x = from[0], g.y = from[1], g.z = from[2];
  }
  if (in.upstream.inv_depth != nullptr) g.w = in.upstream.inv_depth[pixel];
  const float* states = place.states + i;
  ray.transmittance = states[0];
  // The image is the sum of the Gaussians and the background; subtracting what is in front leaves what is behind.
  const float* image = in.image.image + 3 * pixel;
  const float g_alpha = in.upstream.alpha != nullptr ? in.upstream.alpha[pixel] : 0.f;
  ray.rest = g.x * (image[0] - states[kTilePixels]) + g.y * (image[1] - states[2 * kTilePixels]) +
             g.z * (image[2] - states[3 * kTilePixels]) + g.w * (in.image.inv_depth[pixel] - states[4 * kTilePixels]) -
             (1.f - in.image.alpha[pixel]) * g_alpha;
  return ray;
}

/// Adds the terms of the patch whose first pixel center is (x, y) to the sums of up to kBatch entries. Each lane has
/// some rows of pixels of one Gaussian: entry `mine`, in `slot` of the terms; negative: none.
template <int kLength>
__device__ inline void AddBatch(const Splat* splats, float x, float y, int mine, Room<kLength>* room) {
  __syncwarp();
  const int lane = LaneInWarp(), slot = lane % kBatch, first_row = lane / kBatch * kRowsALane;
  float sums[kRecord] = {};
  if (mine >= 0) {
    const Splat& s = splats[mine];
    const float left = x - s.mx, top = y + static_cast<float>(first_row) - s.my;
    const Term* terms = room->terms[slot] + first_row * kPatchWidth;
    const float4* gradients = room->gradients + first_row * kPatchWidth;
#pragma unroll
    for (int row = 0; row < kRowsALane; ++row) {
      const float dy = top + static_cast<float>(row);
      float h = 0, hx = 0, hxx = 0;  // of this row
#pragma unroll
      for (int column = 0; column < kPatchWidth; ++column) {
        const Term term = terms[row * kPatchWidth + column];
        const float4 g = gradients[row * kPatchWidth + column];
        const float dx = left + static_cast<float>(column), change_x = term.change * dx;
        h += term.change, hx += change_x, hxx = fmaf(change_x, dx, hxx);
        sums[6] = fmaf(term.weight, g.x, sums[6]), sums[7] = fmaf(term.weight, g.y, sums[7]);
        sums[8] = fmaf(term.weight, g.z, sums[8]), sums[9] = fmaf(term.weight, g.w, sums[9]);
      }
      const float hy = h * dy;
      sums[0] += h, sums[1] += hx, sums[2] += hy;
      sums[3] += hxx, sums[4] = fmaf(hx, dy, sums[4]), sums[5] = fmaf(hy, dy, sums[5]);
    }
  }
#pragma unroll
  for (int k = 0; k < kRecord; ++k) {
    float sum = sums[k];
    for (int step = kWarp / 2; step >= kBatch; step /= 2) sum += __shfl_down_sync(kAllLanes, sum, step);
    if (first_row == 0 && mine >= 0) room->sums[k][mine] += sum;
  }
  __syncwarp();  // the next batch overwrites the terms, the next patch the gradients
}

/// Adds the terms of one patch's pixels to the sums of the bucket's entries. Returns how many entries reach the patch.
template <int kLength>
__device__ inline int AddPatch(const BlendBackwardInput& in, const Place& place, const Splat* splats, int patch,
                               Room<kLength>* room) {
  const int lane = LaneInWarp(), slot = lane % kBatch;
  Ray ray = LoadRay(in, place, patch * kWarp + lane);
  int last = ray.end;
  for (int step = kWarp / 2; step > 0; step /= 2) {
    const int other = __shfl_xor_sync(kAllLanes, last, step);
    last = last > other ? last : other;
  }
  last = last < place.count ? last : place.count;
  room->gradients[lane] = ray.gradient;
  const float x = static_cast<float>(place.x + PixelX(patch * kWarp)) + 0.5f;
  const float y = static_cast<float>(place.y + PixelY(patch * kWarp)) + 0.5f;
  int held = 0, mine = -1, reached = 0;
  for (int run = 0; run < last; run += kRun) {
    // Each lane tests whether one Gaussian reaches the patch; the nearest is the last lane's, the highest bit.
    const int candidate = run + kWarp - 1 - lane;
    const bool reaches =
        candidate < last && Reaches(ReachOf(splats[candidate]), x, y, kPatchWidth - 1, kPatchHeight - 1);
    unsigned left = __ballot_sync(kAllLanes, reaches);
    reached += __popc(left);
    do {
      for (Term* term = &room->terms[held][lane]; left != 0 && held < kBatch; ++held, term += kTermRow) {
        const int nearest = __clz(static_cast<int>(left)), entry = run + nearest;
        left ^= kFirst >> nearest;
        *term = ray.Pass(splats[entry], entry < ray.end);
        if (slot == held) mine = entry;
      }
      const bool is_all = left == 0 && run + kRun >= last;
      if (held < kBatch && !is_all) break;
      AddBatch(splats, x, y, mine, room);
      held = 0, mine = -1;
    } while (left != 0);
  }
  return reached;
}

template <int kRuns>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarp, 4)
    BlendBackwardKernel(BlendBackwardInput in, float* records, Counters* counters) {
  constexpr int kLength = kRuns * kRun;
  __shared__ Splat splats[kLength];
  __shared__ Room<kLength> rooms[kWarpsPerBlock];
  const SplatCamera<float>& camera = in.forward.camera;
  const Bucket bucket = in.kept.buckets.buckets[blockIdx.x];
  const TileRange range = in.forward.ranges[bucket.tile];
  const uint32_t begin = range.begin + bucket.first, behind = range.end - begin;
  const Place place{static_cast<int>(bucket.tile),
                    static_cast<int>(bucket.tile % camera.tiles_x) * kTile,
                    static_cast<int>(bucket.tile / camera.tiles_x) * kTile,
                    bucket.first,
                    behind < kLength ? static_cast<int>(behind) : kLength,
                    begin,
                    in.kept.buckets.states + int64_t{blockIdx.x} * kStateFloats * kTilePixels};
  const int thread = static_cast<int>(threadIdx.x), warp = thread / kWarp;
  Room<kLength>* const room = rooms + warp;
  for (int i = thread; i < place.count; i += kWarpsPerBlock * kWarp) {
    splats[i] = in.forward.splats[in.forward.entry_ids[place.begin + i]];
  }
  for (int i = LaneInWarp(); i < kRecord * kLength; i += kWarp) room->sums[i / kLength][i % kLength] = 0;
  __syncthreads();
  unsigned long long reached = 0;
  for (int patch = warp; patch < kPatches; patch += kWarpsPerBlock) {
    reached += AddPatch(in, place, splats, patch, room);
  }
  if (thread % kWarp == 0 && reached != 0) atomicAdd(&counters->pixel_pairs_backward, kWarp * reached);
  __syncthreads();
  for (int i = thread; i < place.count; i += kWarpsPerBlock * kWarp) {
    float2* to = reinterpret_cast<float2*>(records + int64_t{kRecord} * in.sorted_numbers[place.begin + i]);
    for (int k = 0; k < kRecord; k += 2) {
      float2 sum = make_float2(0, 0);
      for (const Room<kLength>& of_warp : rooms) sum.x += of_warp.sums[k][i], sum.y += of_warp.sums[k + 1][i];
      to[k / 2] = sum;
    }
  }
}

}  // namespace

void BlendBackward(const BlendBackwardInput& in, float* records, Counters* counters, cudaStream_t stream) {
  const auto launch = [&](auto runs) {
    Launch("blending backward", BlendBackwardKernel<decltype(runs)::value>, {in.buckets, kWarpsPerBlock * kWarp},
           stream, in, records, counters);
  };
  static_assert(kMaxRuns == 4);
  switch (in.kept.buckets.runs) {
    case 1:
      return launch(std::integral_constant<int, 1>());
    case 2:
      return launch(std::integral_constant<int, 2>());
    default:
      return launch(std::integral_constant<int, 4>());
  }
}

}  // namespace oraclegs::cuda

#include "oraclegs/render/cuda/blend.h"
#include "oraclegs/render/cuda/falloff-inl.cuh"

namespace oraclegs::cuda {
namespace {

// Buckets differ in work, and a block's room is free when its last warp is done: as few warps as fill a multiprocessor
// that takes 16 blocks.
constexpr int kWarpsPerBlock = 2;
constexpr unsigned kRing = 2 * kWarp;  // pixels under way between the first lane and the last, and those read ahead
static_assert(kRun == kWarp);

/// A pixel's centre in px, and the first entry that does not contribute to it. One load of 16 bytes.
struct alignas(16) Place {
  float x, y;
  uint32_t end;
};

/// What the lanes read of a pixel under way. 48 bytes: eight lanes that read 16 bytes of eight neighbours meet no bank
/// twice.
struct Pixel {
  float4 gradient;  // dL/d(rgb), dL/d(inv_depth)
  Place place;
  float2 state;  // transmittance, and what the rest of the list adds to the loss: before the run, then behind it
};

/// A warp's pixels: those under way, and the numbers of those that reach its run.
struct Pixels {
  Pixel ring[kRing];
  uint8_t list[kTilePixels];
};

struct Tile {
  const uint32_t* ends;  // as BlendKept's, of this tile
  int x, y;              // px
  float* states;         // of the bucket; behind the first run [256] transmittance, [256] rest
};

/// Pixel `i` of the tile as the run finds it.
__device__ inline void LoadPixel(const BlendBackwardInput& in, const Tile& tile, bool first_run, int i,
                                 Pixel* pixel_of_ring) {
  const float* states = tile.states;
  const SplatCamera<float>& camera = in.forward.camera;
  const int x = tile.x + PixelX(i), y = tile.y + PixelY(i);
  const int64_t pixel = int64_t{y} * camera.width + x;
  float4 g = make_float4(0, 0, 0, 0);
  if (in.upstream.image != nullptr) {
    const float* from = in.upstream.image + 3 * pixel;
    g.x = from[0], g.y = from[1], g.z = from[2];
  }
  if (in.upstream.inv_depth != nullptr) g.w = in.upstream.inv_depth[pixel];
  float rest = states[kTilePixels + i];
  if (first_run) {
    // The image is what the Gaussians and the background add up to; less what is in front, it is what follows.
    const float* image = in.image.image + 3 * pixel;
    const float g_alpha = in.upstream.alpha != nullptr ? in.upstream.alpha[pixel] : 0.f;
    rest = g.x * (image[0] - rest) + g.y * (image[1] - states[2 * kTilePixels + i]) +
           g.z * (image[2] - states[3 * kTilePixels + i]) +
           g.w * (in.image.inv_depth[pixel] - states[4 * kTilePixels + i]) - (1.f - in.image.alpha[pixel]) * g_alpha;
  }
  pixel_of_ring->gradient = g;
  pixel_of_ring->place = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, tile.ends[i]};
  pixel_of_ring->state = make_float2(states[i], rest);
}

/// One Gaussian's sums, as BlendBackward's records.
struct Sums {
  float h = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, r = 0, g = 0, b = 0, inv_z = 0;

  /// Adds the pixel at (dx, dy) from the centre. `state` is that in front of the Gaussian, and becomes that behind it.
  __device__ void Accumulate(const Splat& s, float dx, float dy, const float4& gradient, float2* state) {
    const float e = Log2Alpha(s, dx, dy);
    if (e < kLog2AlphaMin) return;
    const float full = Exp2(e), alpha = Min(full, kAlphaMax);
    const float value = gradient.x * s.r + gradient.y * s.g + gradient.z * s.b + gradient.w * s.inv_z;
    const float weight = alpha * state->x;
    state->y = fmaf(-weight, value, state->y);
    const float d_alpha = fmaf(state->x, value, -state->y * Reciprocal(1.f - alpha));
    const float change = full < kAlphaMax ? alpha * d_alpha : 0.f;
    state->x = NextTransmittance(alpha, state->x);
    const float hx = change * dx, hy = change * dy;
    h += change;
    x += hx, y += hy;
    xx = fmaf(hx, dx, xx), xy = fmaf(hx, dy, xy), yy = fmaf(hy, dy, yy);
    r = fmaf(weight, gradient.x, r), g = fmaf(weight, gradient.y, g), b = fmaf(weight, gradient.z, b);
    inv_z = fmaf(weight, gradient.w, inv_z);
  }

  __device__ void Store(float* record) const {
    float2* to = reinterpret_cast<float2*>(record);
    to[0] = make_float2(h, x), to[1] = make_float2(y, xx), to[2] = make_float2(xy, yy);
    to[3] = make_float2(r, g), to[4] = make_float2(b, inv_z);
  }
};

/// The numbers of the tile's pixels that entry `first` finds open go to `list`. Returns how many.
__device__ inline int ListOpenPixels(const uint32_t* ends, uint32_t first, uint8_t* list) {
  const int lane = LaneInWarp();
  int count = 0;
  for (int i = lane; i < kTilePixels; i += kWarp) {
    const bool open = ends[i] > first;  // 0 outside the image
    const unsigned mask = __ballot_sync(kAllLanes, open);
    if (open) list[count + __popc(mask & ((1u << lane) - 1))] = static_cast<uint8_t>(i);
    count += __popc(mask);
  }
  __syncwarp();
  return count;
}

/// What pixels [from, to) of the list carry on to the bucket's next run.
__device__ inline void KeepStates(const Pixels& pixels, int from, int to, float* states) {
  for (int k = from + LaneInWarp(); k < to; k += kWarp) {
    const float2 state = pixels.ring[static_cast<unsigned>(k) % kRing].state;
    states[pixels.list[k]] = state.x;
    states[kTilePixels + pixels.list[k]] = state.y;
  }
}

__global__ void __launch_bounds__(kWarpsPerBlock* kWarp)
    BlendBackwardKernel(BlendBackwardInput in, float* records, Counters* counters) {
  __shared__ Pixels shared[kWarpsPerBlock];
  const uint32_t number = blockIdx.x * kWarpsPerBlock + threadIdx.x / kWarp;
  if (number >= in.buckets) return;
  Pixels* const pixels = shared + threadIdx.x / kWarp;
  const int lane = LaneInWarp();
  const SplatCamera<float>& camera = in.forward.camera;
  const Bucket bucket = in.kept.buckets.buckets[number];
  const Tile tile{in.kept.ends + int64_t{bucket.tile} * kTilePixels,
                  static_cast<int>(bucket.tile % camera.tiles_x) * kTile,
                  static_cast<int>(bucket.tile / camera.tiles_x) * kTile,
                  in.kept.buckets.states + int64_t{number} * kStateFloats * kTilePixels};
  const TileRange range = in.forward.ranges[bucket.tile];
  const uint32_t entries = range.end - range.begin, bucket_end = bucket.first + in.kept.buckets.Length();
  const uint32_t last = bucket_end < entries ? bucket_end : entries;
  unsigned long long visited = 0;

  for (uint32_t run = bucket.first; run < last; run += kRun) {
    const int count = ListOpenPixels(tile.ends, run, pixels->list);
    if (count == 0) break;  // the rest of the list reaches no pixel
    const uint32_t mine = run + static_cast<uint32_t>(lane);
    const bool has_entry = mine < entries, carries = run + kRun < last, is_last = lane == kWarp - 1;
    Splat splat{};
    if (has_entry) splat = in.forward.splats[in.forward.entry_ids[range.begin + mine]];
    Sums sums;
    float2 state = make_float2(0, 0);
    const uint32_t entry = has_entry ? mine : ~0u;  // none contributes where there is no Gaussian
    const int steps = count + kWarp - 1;
    int kept = 0;
    for (int first = 0; first < steps; first += kWarp) {
      __syncwarp();
      // The last lane is through with all but the newest pixels, whose places in the ring are not yet taken again.
      if (carries && first > kWarp) {
        KeepStates(*pixels, kept, first - kWarp, tile.states);
        kept = first - kWarp;
        __syncwarp();
      }
      const int ahead = first + lane;
      if (ahead < count) {
        LoadPixel(in, tile, run == bucket.first, pixels->list[ahead],
                  &pixels->ring[static_cast<unsigned>(ahead) % kRing]);
      }
      __syncwarp();
      const int end = first + kWarp < steps ? first + kWarp : steps;
      for (int step = first; step < end; ++step) {
        // Each lane hands its pixel on to the next Gaussian.
        state.x = __shfl_up_sync(kAllLanes, state.x, 1);
        state.y = __shfl_up_sync(kAllLanes, state.y, 1);
        const unsigned at = static_cast<unsigned>(step - lane);
        if (at >= static_cast<unsigned>(count)) continue;
        Pixel* const pixel = &pixels->ring[at % kRing];
        if (lane == 0) state = pixel->state;
        const Place place = pixel->place;
        if (entry < place.end) {
          sums.Accumulate(splat, place.x - splat.mx, place.y - splat.my, pixel->gradient, &state);
        }
        if (carries && is_last) pixel->state = state;
      }
    }
    __syncwarp();
    if (carries) KeepStates(*pixels, kept, count, tile.states);
    if (has_entry) sums.Store(records + int64_t{kRecord} * in.sorted_numbers[range.begin + mine]);
    visited += static_cast<unsigned long long>(count) * kRun;
    __syncwarp();  // the next run overwrites the list, and reads what was kept
  }
  if (lane == 0 && visited != 0) atomicAdd(&counters->pixel_pairs_backward, visited);
}

}  // namespace

void BlendBackward(const BlendBackwardInput& in, float* records, Counters* counters, cudaStream_t stream) {
  Launch("blending backward", BlendBackwardKernel, LaunchShape::For(in.buckets * kWarp, kWarpsPerBlock * kWarp), stream,
         in, records, counters);
}

}  // namespace oraclegs::cuda

// Forward blending, tile by tile. The tile's list is read near to far in segments; each 4 x 4 block walks the
// positions that reach it with its 16 pixels in vector lanes, and is done when every pixel is opaque.
// Kept for backward: final transmittance and the end of each pixel's contributions, 8 bytes a pixel. Nothing is
// allocated.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/render/cpu/blend_forward.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>

#include "oraclegs/render/cpu/blocks-inl.h"
#include "oraclegs/render/cpu/falloff-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Steps between checks of whether a block is opaque. Nothing contributes to a pixel that became opaque in between, and
/// its running product cannot reach the subnormal numbers within so few steps.
inline constexpr int kSteps = 8;

/// Blending state of a block's pixels.
struct HWY_ALIGN BlockState {
  float left[16];  ///< product of all 1 - alpha; 0 for pixels known to be opaque or outside the image
  float t[16], r[16], g[16], b[16], inv_z[16];
  int32_t end[16];  ///< as BlendImage::end
};

struct Visit {
  int steps;  ///< evaluated Gaussians
  bool open;  ///< whether some pixel is not opaque yet
};

/// n + 1 in the lanes of `where`, n elsewhere.
HWY_INLINE IntVec CountedWhere(hn::Mask<IntTag> where, IntVec n) {
  const IntTag d;
#if HWY_TARGET <= HWY_AVX3
  return hn::IfThenElse(where, hn::Add(n, hn::Set(d, 1)), n);
#else
  return hn::Sub(n, hn::VecFromMask(d, where));
#endif
}

/// One vector of a BlockState, while a segment is blended.
struct PixelSums {
  FloatVec left, t, r, g, b, inv_z;
  IntVec steps;  ///< contributing steps of the segment, which are its first ones

  PixelSums() = default;
  HWY_INLINE PixelSums(const BlockState& state, int at) {
    const FloatTag d;
    left = hn::Load(d, state.left + at);
    t = hn::Load(d, state.t + at);
    r = hn::Load(d, state.r + at);
    g = hn::Load(d, state.g + at);
    b = hn::Load(d, state.b + at);
    inv_z = hn::Load(d, state.inv_z + at);
    steps = hn::Zero(IntTag());
  }

  /// Writes the sums back. `first`: Segment::FirstStep.
  HWY_INLINE void Store(int32_t first, int at, BlockState* state) const {
    const FloatTag d;
    const IntTag di;
    hn::Store(left, d, state->left + at);
    hn::Store(t, d, state->t + at);
    hn::Store(r, d, state->r + at);
    hn::Store(g, d, state->g + at);
    hn::Store(b, d, state->b + at);
    hn::Store(inv_z, d, state->inv_z + at);
    const IntVec end =
        hn::IfThenElse(hn::Gt(steps, hn::Zero(di)), hn::Add(steps, hn::Set(di, first)), hn::Load(di, state->end + at));
    hn::Store(end, di, state->end + at);
  }

  /// Blends splat i of the segment behind the splats so far.
  HWY_INLINE void Add(const Segment& segment, int i, FloatVec alpha) {
    const FloatTag d;
    const FloatVec next = hn::NegMulAdd(alpha, left, left);
    // The product never grows: a pixel is open while the transmittance after the Gaussian is large enough, so no flag
    // or branch is needed.
    const FloatMask contributes = hn::Ge(next, hn::Set(d, kTransmittanceEnd));
    const FloatVec weight = hn::IfThenElseZero(contributes, hn::Mul(alpha, left));
    left = next;
    t = hn::IfThenElse(contributes, next, t);
    steps = CountedWhere(hn::RebindMask(IntTag(), contributes), steps);
    r = hn::MulAdd(weight, hn::Set(d, segment.r[i]), r);
    g = hn::MulAdd(weight, hn::Set(d, segment.g[i]), g);
    b = hn::MulAdd(weight, hn::Set(d, segment.b[i]), b);
    inv_z = hn::MulAdd(weight, hn::Set(d, segment.inv_z[i]), inv_z);
  }
};

/// Closes opaque pixels, so that nothing more contributes to them. Returns whether others remain.
HWY_INLINE bool CloseOpaque(PixelSums* sums) {
  const FloatTag d;
  bool open = false;
  for (int v = 0; v < kVecs; ++v) {
    const FloatMask is_open = hn::Ge(sums[v].left, hn::Set(d, kTransmittanceEnd));
    sums[v].left = hn::IfThenElseZero(is_open, sums[v].left);
    open |= !hn::AllFalse(d, is_open);
  }
  return open;
}

/// Blends the segment's splats of one block; `first`: Segment::FirstStep. Not inlined: on its own, GCC 12 keeps the
/// loop's numbers in registers.
HWY_NOINLINE Visit BlendBlock(const Segment& segment, int block, int32_t first, BlockState* state) {
  const FloatTag d;
  PixelSums sums[kVecs];
  for (int v = 0; v < kVecs; ++v) sums[v] = PixelSums(*state, v * kLanes);
  const BlockPixels pixels(block);
  const int32_t* HWY_RESTRICT positions = segment.positions[block];
  const int count = segment.counts[block];
  bool open = true;
  int j = 0;
  while (j < count && open) {
    // Opacity is tested apart from the blending, so that a long latency chain does not fill the reorder window.
    const int stop = std::min(j + kSteps, count);
    HWY_ALIGN float alphas[kSteps][16];
    for (int step = j; step < stop; ++step) {
      FloatVec alpha[kVecs];
      segment.Alphas(positions[step], pixels, alpha);
      for (int v = 0; v < kVecs; ++v) hn::Store(alpha[v], d, alphas[step - j] + v * kLanes);
    }
    for (int v = 0; v < kVecs; ++v) {
      PixelSums pixel = sums[v];  // of one vector: they stay in registers
      for (int step = j; step < stop; ++step) {
        pixel.Add(segment, positions[step], hn::Load(d, alphas[step - j] + v * kLanes));
      }
      sums[v] = pixel;
    }
    j = stop;
    open = CloseOpaque(sums);
  }
  for (int v = 0; v < kVecs; ++v) sums[v].Store(first, v * kLanes, state);
  return {j, open};
}

HWY_INLINE void StartBlock(const BlockPlace& place, BlockState* s) {
  const FloatTag d;
  const IntTag di;
  for (int i = 0; i < 16; i += kLanes) {
    for (float* one : {s->left, s->t}) hn::Store(hn::Set(d, 1.f), d, one + i);
    for (float* sum : {s->r, s->g, s->b, s->inv_z}) hn::Store(hn::Zero(d), d, sum + i);
    hn::Store(hn::Zero(di), di, s->end + i);
  }
  if (HWY_LIKELY(place.Whole())) return;
  for (int i = 0; i < 16; ++i) {
    if (!place.Holds(i)) s->left[i] = 0;  // nothing contributes to it, and backward skips it
  }
}

/// A block's pixels on the background.
struct HWY_ALIGN BlockImage {
  float rgb[48], alpha[16];
};

HWY_INLINE void Composite(const BlockState& s, const float* background, BlockImage* out) {
  const FloatTag d;
  for (int i = 0; i < 16; i += kLanes) {
    const FloatVec t = hn::Load(d, s.t + i);
    hn::StoreInterleaved3(hn::MulAdd(t, hn::Set(d, background[0]), hn::Load(d, s.r + i)),
                          hn::MulAdd(t, hn::Set(d, background[1]), hn::Load(d, s.g + i)),
                          hn::MulAdd(t, hn::Set(d, background[2]), hn::Load(d, s.b + i)), d, out->rgb + 3 * i);
    hn::Store(hn::Sub(hn::Set(d, 1.f), t), d, out->alpha + i);
  }
}

HWY_NOINLINE int64_t BlendTile(const cpu::TileWork& tile, const cpu::BlendImage& out) {
  BlockState states[cpu::kBlocksPerTile];
  uint32_t open = 0;
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    const BlockPlace place(tile, block, out.width, out.height);
    StartBlock(place, &states[block]);
    if (place.Empty()) continue;
    open |= 1u << block;
    PrefetchPlane<3>(out.image, place);
    PrefetchPlane<1>(out.alpha, place);
    PrefetchPlane<1>(out.inv_depth, place);
  }
  const uint32_t inside = open;
  Segment segment;
  int64_t visited = 0;
  for (int64_t begin = 0; begin < tile.count && open != 0; begin += Segment::kSize) {
    const int n = static_cast<int>(std::min<int64_t>(Segment::kSize, tile.count - begin));
    segment.Fill(tile, begin, n, open);
    const Upcoming next{tile.splats, tile.entries + begin + n,
                        std::min<int64_t>(Segment::kSize, tile.count + tile.next_count - begin - n)};
    for (uint32_t left = open; left != 0; left &= left - 1) {
      const int block = __builtin_ctz(left);
      next.Prefetch(block);
      const Visit visit = BlendBlock(segment, block, Segment::FirstStep(begin), &states[block]);
      if (!visit.open) open &= ~(1u << block);
      visited += visit.steps;
    }
  }
  // In two loops: a row of pixels spans the vectors just written, and reading it at once would stall.
  BlockImage pixels[cpu::kBlocksPerTile];
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    Composite(states[block], out.background, &pixels[block]);
  }
  for (uint32_t left = inside; left != 0; left &= left - 1) {
    const int block = __builtin_ctz(left);
    const BlockPlace place(tile, block, out.width, out.height);
    CopyToPlane<3>(pixels[block].rgb, place, out.image);
    CopyToPlane<1>(pixels[block].alpha, place, out.alpha);
    CopyToPlane<1>(states[block].inv_z, place, out.inv_depth);
  }
  if (out.transmittance != nullptr) {
    for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
      const int64_t offset = tile.index * kTilePixels + block * 16;
      std::memcpy(out.transmittance + offset, states[block].t, sizeof(states[block].t));
      std::memcpy(out.end + offset, states[block].end, sizeof(states[block].end));
    }
  }
  return visited * 16;
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
HWY_EXPORT(BlendTile);

namespace cpu {
int64_t BlendTile(const TileWork& tile, const BlendImage& out) { return HWY_DYNAMIC_DISPATCH(BlendTile)(tile, out); }
}  // namespace cpu
}  // namespace oraclegs
#endif

#pragma once
// Dissimilarity of a patch of one image and another image, the inner loop of stereo (docs/method.md#stereo).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "oraclegs/depth/plane.h"
#include "oraclegs/depth/plane_math.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

inline constexpr int kPatchSlots = 48;  ///< samples, padded to whole vectors

struct PatchOffsets {
  alignas(64) std::array<float, kPatchSlots> x{};  ///< pixels from the center, zero in the padding
  alignas(64) std::array<float, kPatchSlots> y{};
};
const PatchOffsets& Offsets();

/// An image in 8 bits, laid out so that one 32-bit load fetches the four pixels of a bilinear sample: word (x, y) of a
/// channel holds, lowest byte first, the pixels (x, y), (x+1, y), (x, y+1), (x+1, y+1); beyond the border the last
/// pixel repeats.
struct GatherImage {
  int width = 0, height = 0;
  std::vector<std::vector<uint32_t>> channels;  ///< each height * width words

  uint8_t Value(int channel, int x, int y) const {
    return static_cast<uint8_t>(channels[static_cast<size_t>(channel)][static_cast<size_t>(y) * width + x]);
  }
};

/// Packs every channel of `image`, whose values in [0, 1] are rounded to 8 bits.
GatherImage Pack(const ImageF& image);

/// Rec. 601 luma of an RGB image, one channel.
ImageF Luma(const ImageF& rgb);

/// A pixel's surroundings in the reference view, weighed by similarity to the pixel and by distance.
struct Patch {
  float u = 0, v = 0;                                         ///< the pixel's center
  alignas(64) float weight[kPatchSlots] = {};                 ///< sum 1, zero in the padding
  alignas(64) float centerd[kMaxChannels][kPatchSlots] = {};  ///< weight * (value - weighted mean), 8-bit units
  float variance = 0;  ///< sum over channels of the weighted variance, squared units
};

/// The patch around pixel (x, y); samples beyond the border or with usable == 0 are ignored. `usable` may be null.
Patch MakePatch(const GatherImage& image, int x, int y, const uint8_t* usable);

/// Another view to compare with.
struct PatchSource {
  const GatherImage* image = nullptr;  ///< as many channels as the patch's
  PixelMap map;                        ///< from the reference view
};

/// Planes and sources to compare: every plane in every active source.
struct PatchHypotheses {
  std::span<const PatchSource> sources;
  const uint8_t* active = nullptr;  ///< for each source: 0 = not compared
  std::span<const Plane> planes;    ///< inverse depth at the patch's center
};

/// Computes costs[p * sources.size() + s] = 1 - ZNCC, in [0, 2], of the patch on planes[p] in sources[s]. The
/// correlation runs over all channels at once; a constant in the denominator keeps noise in flat patches from
/// correlating. kWorstCost where the plane takes the center out of the image or part of the patch behind the camera,
/// and for inactive sources.
void PatchCosts(const Patch& patch, const PatchHypotheses& hypotheses, float* costs);

}  // namespace oraclegs

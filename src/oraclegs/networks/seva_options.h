#pragma once
// Options of Stable Virtual Camera, without its network.

#include <cstdint>

#include "oraclegs/core/options.h"

namespace oraclegs {
namespace seva {

/// Schedule of the two UNet evaluations of a guided step: with and without the input images.
enum class Halves {
  kBatched,  ///< two at once
  kInTurn    ///< one after the other, with half the memory
};

/// Number type of the networks.
enum class Precision {
  kFloat32,
  kBFloat16,
  kFloat16,
  kAutocast  ///< as its authors run it: weights and norms in float32, products in float16 (in bfloat16 on a CPU)
};

}  // namespace seva

template <>
struct EnumWords<seva::Halves> {
  static constexpr EnumWord<seva::Halves> kWords[] = {{seva::Halves::kBatched, "batched"},
                                                      {seva::Halves::kInTurn, "in-turn"}};
};

template <>
struct EnumWords<seva::Precision> {
  static constexpr EnumWord<seva::Precision> kWords[] = {{seva::Precision::kFloat32, "float32"},
                                                         {seva::Precision::kBFloat16, "bfloat16"},
                                                         {seva::Precision::kFloat16, "float16"},
                                                         {seva::Precision::kAutocast, "autocast"}};
};

/// Defaults are the paper's.
struct SevaOptions {
  int frames = 80, short_side = 576, steps = 50, candidates = 1;
  double cfg = 3;
  Auto<seva::Halves> halves;
  seva::Precision precision = seva::Precision::kFloat32;
  int64_t seed = 23;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("seva-frames", self.frames, "Frames that seva denoises together; more agree better and need more memory",
          Range{2, 1000});
    visit("seva-short-side", self.short_side, "Shorter side of the images that seva works on, a multiple of 64 is used",
          Range{64, 4096});
    visit("seva-steps", self.steps, "Denoising steps", Range{1, 1000}, Tier::kSetting);
    visit("candidates", self.candidates, "Samples that seva draws for each view; the oracle picks", Range{1, 64},
          Tier::kSetting);
    visit("seva-cfg", self.cfg, "Strength of classifier-free guidance, but for frames at the place of a photo",
          Range{0, 100}, Tier::kSetting);
    visit("seva-halves", self.halves,
          "Guidance computes every step twice: batched = at once, in-turn = with half the memory, auto = what fits",
          Tier::kSetting);
    visit("seva-precision", self.precision,
          "Number type of seva's networks; autocast = as its authors run it: weights and norms in float32, products in "
          "float16, on a CPU in bfloat16",
          Tier::kSetting);
    visit("seva-seed", self.seed, "Seed of seva's noise", Range{0, 9e15}, Tier::kSetting);
  }
};

}  // namespace oraclegs

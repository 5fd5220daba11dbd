#pragma once
// Options of Stable Virtual Camera, without its network.

#include <cstdint>

#include "oraclegs/core/options.h"

namespace oraclegs {
namespace seva {

/// Frames that get the full strength of guidance.
enum class Guider {
  kMultiView,  ///< all but frames at the place of an input image
  kTemporal,   ///< the farther from an input image, the more
  kPlain       ///< all
};

/// Strategy that chooses the frames that are denoised together.
enum class Chunking { kNearestGt, kNearest, kGt, kGtNearest, kGtLtr, kInterp, kInterpGt };

/// Strategy of the first of two passes.
enum class FirstChunking { kGtNearest, kGtLtr, kGt, kNearestGt, kNearest };

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
struct EnumWords<seva::Guider> {
  static constexpr EnumWord<seva::Guider> kWords[] = {
      {seva::Guider::kMultiView, "multi-view"}, {seva::Guider::kTemporal, "temporal"}, {seva::Guider::kPlain, "plain"}};
};

template <>
struct EnumWords<seva::Chunking> {
  using C = seva::Chunking;
  static constexpr EnumWord<C> kWords[] = {
      {C::kNearestGt, "nearest-gt"}, {C::kNearest, "nearest"}, {C::kGt, "gt"},
      {C::kGtNearest, "gt-nearest"}, {C::kGtLtr, "gt-ltr"},    {C::kInterp, "interp"},
      {C::kInterpGt, "interp-gt"}};
};

template <>
struct EnumWords<seva::FirstChunking> {
  using C = seva::FirstChunking;
  static constexpr EnumWord<C> kWords[] = {{C::kGtNearest, "gt-nearest"},
                                           {C::kGtLtr, "gt-ltr"},
                                           {C::kGt, "gt"},
                                           {C::kNearestGt, "nearest-gt"},
                                           {C::kNearest, "nearest"}};
};

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
  int frames = 80, short_side = 576, steps = 50, passes = 2, candidates = 1;
  double cfg = 3, cfg_min = 1.2, camera_scale = 2, anchor_ratio = 1;
  Auto<double> memory;
  seva::Guider guider = seva::Guider::kMultiView;
  seva::Chunking chunking = seva::Chunking::kNearestGt;
  seva::FirstChunking first_chunking = seva::FirstChunking::kGtNearest;
  Auto<seva::Halves> halves;
  seva::Precision precision = seva::Precision::kFloat32;
  int64_t seed = 23;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("seva-frames", self.frames, "Frames that seva denoises together; more agree better and need more memory",
          Range{2, 1000});
    visit("seva-short-side", self.short_side, "Shorter side of the images that seva works on, a multiple of 64 is used",
          Range{64, 4096});
    visit("seva-steps", self.steps, "Denoising steps", Range{1, 1000});
    visit("seva-passes", self.passes, "2 = first frames all around, then the views between them, 1 = the views alone",
          Range{1, 2});
    visit("candidates", self.candidates, "Samples that seva draws for each view; the oracle picks", Range{1, 64});
    visit("seva-cfg", self.cfg, "Strength of classifier-free guidance", Range{0, 100});
    visit("seva-cfg-min", self.cfg_min, "The same for frames at the place of a photo", Range{0, 100});
    visit("seva-guider", self.guider,
          "Which frames get the full guidance: multi-view = all but frames at a photo's place, temporal = the more the "
          "farther from a photo, plain = all");
    visit("seva-camera-scale", self.camera_scale,
          "Distance of a chunk's first camera from the scene's middle, for seva", Range{1e-3, 1e3});
    visit("seva-chunking", self.chunking, "Which frames seva denoises together");
    visit("seva-first-chunking", self.first_chunking, "The same in the first of two passes");
    visit("seva-anchor-ratio", self.anchor_ratio, "Frames of the first pass for interp, as a share of what it needs",
          Range{0.1, 10});
    visit("seva-halves", self.halves,
          "Guidance computes every step twice: batched = at once, in-turn = with half the memory, auto = what fits");
    visit("seva-precision", self.precision,
          "Number type of seva's networks; autocast = as its authors run it: weights and norms in float32, products in "
          "float16, on a CPU in bfloat16");
    visit("seva-memory", self.memory, "GB that seva may use, auto = what is free", Range{0, 1e6});
    visit("seva-seed", self.seed, "Seed of seva's noise", Range{0, 9e15});
  }
};

}  // namespace oraclegs

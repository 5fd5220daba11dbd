#pragma once

#include <cstdint>
#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// How SEVA generates views; the defaults are the paper's.
struct SevaOptions {
  int frames = 80, short_side = 576, steps = 50, passes = 2, candidates = 1;
  double cfg = 3, cfg_min = 1.2, camera_scale = 2, anchor_ratio = 1, memory = 0;
  std::string guider = "multi-view", chunking = "nearest-gt", first_chunking = "gt-nearest";
  std::string halves = "auto", precision = "float32";
  int64_t seed = 23;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("seva-frames", self.frames, "Frames that seva denoises together; more agree better and need more memory",
          Range{2, 1000});
    visit("seva-short-side", self.short_side, "Shorter side of the pictures that seva works on, a multiple of 64 is used",
          Range{64, 4096});
    visit("seva-steps", self.steps, "Denoising steps", Range{1, 1000});
    visit("seva-passes", self.passes, "2 = first frames all around, then the views between them, 1 = the views alone",
          Range{1, 2});
    visit("candidates", self.candidates, "Samples that seva draws for each view; the oracle picks", Range{1, 64});
    visit("seva-cfg", self.cfg, "Strength of guidance by the photographs", Range{0, 100});
    visit("seva-cfg-min", self.cfg_min, "The same for frames at the place of a photograph", Range{0, 100});
    visit("seva-guider", self.guider,
          "Who gets the full guidance: multi-view = all but frames at a photograph's place, temporal = the more the "
          "farther from a photograph, plain = all",
          Choice{{"multi-view", "temporal", "plain"}});
    visit("seva-camera-scale", self.camera_scale, "Distance of a chunk's first camera from the scene's middle, for seva",
          Range{1e-3, 1e3});
    visit("seva-chunking", self.chunking, "Which frames seva denoises together",
          Choice{{"nearest-gt", "nearest", "gt", "gt-nearest", "gt-ltr", "interp", "interp-gt"}});
    visit("seva-first-chunking", self.first_chunking, "The same in the first of two passes",
          Choice{{"gt-nearest", "gt-ltr", "gt", "nearest-gt", "nearest"}});
    visit("seva-anchor-ratio", self.anchor_ratio, "Frames of the first pass for interp, as a share of what it needs",
          Range{0.1, 10});
    visit("seva-halves", self.halves,
          "Guidance computes every step twice: batched = at once, in-turn = with half the memory, auto = what fits",
          Choice{{"auto", "batched", "in-turn"}});
    visit("seva-precision", self.precision, "Number type of seva's networks", Choice{{"float32", "bfloat16", "float16"}});
    visit("seva-memory", self.memory, "GB that seva may use, 0 = what is free", Range{0, 1e6});
    visit("seva-seed", self.seed, "Seed of seva's noise", Range{0, 9e15});
  }
};

}  // namespace oraclegs

#pragma once
// Parts of published methods for few photos that this program's own training does without (docs/baselines.md).

#include "oraclegs/core/options.h"

namespace oraclegs {

/// How Gaussians are added and moved.
enum class Densify {
  kMcmc,      ///< relocation and growth by opacity, noise on positions [Kheradmand 2024]
  kAdaptive,  ///< clone, split, prune and reset of opacities [Kerbl 2023]
};
template <>
struct EnumWords<Densify> {
  static constexpr EnumWord<Densify> kWords[] = {{Densify::kMcmc, "mcmc"}, {Densify::kAdaptive, "adaptive"}};
};

/// Parts of other methods, all off; on a CPU only, but for covisibility_weights.
struct BaselineOptions {
  Densify densify = Densify::kMcmc;
  double densify_gradient = 0.0002;
  double densify_opacity = 0;
  double prune_opacity = 0.005;
  bool split_lonely = false;
  int opacity_reset = 3000;
  Auto<int> opacity_reset_first = {};
  double opacity_reset_to = 0.01;
  bool keep_large = false;
  int unpool_until = 0;
  bool two_fields = false;
  double co_prune_distance = 5;
  int co_start = 500;
  bool random_background = false;
  double pseudo_depth_weight = 0;
  int pseudo_depth_start = 2000;
  int pseudo_depth_every = 10;
  bool hard_depth = false;
  int soft_depth_start = 0;
  int depth_step_every = 10;
  double depth_tolerance = 0.001;
  int prune_modes_at = 0;
  bool covisibility_weights = false;

  bool StepsByDepth() const { return hard_depth || soft_depth_start > 0; }
  bool UsesDepth() const { return StepsByDepth() || covisibility_weights || pseudo_depth_weight > 0; }

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("densify", self.densify,
          "How Gaussians become more: mcmc = dead ones move to living ones, all move at random (3DGS-MCMC, Kheradmand "
          "et al. 2024); adaptive = those that the photos pull at are cloned or split, the transparent ones are "
          "removed, opacities are reset (3DGS, Kerbl et al. 2023), on the CPU only");
    visit("densify-gradient", self.densify_gradient,
          "Of --densify adaptive: mean gradient of a Gaussian's place in the image, in units of half the image, from "
          "which it is cloned or split",
          Range{1e-9, 1});
    visit("densify-opacity", self.densify_opacity,
          "Of --densify adaptive: only Gaussians of more than this opacity are cloned or split; DNGaussian uses 0.1",
          Range{0, 1});
    visit("prune-opacity", self.prune_opacity,
          "Of --densify adaptive: Gaussians of less than this opacity are removed; DNGaussian uses 0.01, SparseGS 0.05",
          Range{0, 0.5});
    visit("split-lonely", self.split_lonely,
          "Of --densify adaptive: also split Gaussians that are larger than the cameras' extent and stand far from "
          "their three neighbors, whatever their gradient (FSGS and CoR-GS)");
    visit("opacity-reset", self.opacity_reset,
          "Of --densify adaptive: iterations between resets of all opacities to at most --opacity-reset-to; 0 = never",
          Range{0, 1e7});
    visit("opacity-reset-first", self.opacity_reset_first,
          "Iteration of the first of these resets; auto = --opacity-reset, and before a white background also "
          "--refine-start",
          Range{1, 1e7});
    visit("opacity-reset-to", self.opacity_reset_to,
          "What these resets leave; FSGS and CoR-GS have 0.05 in place of 3DGS's 0.01", Range{0.006, 1});
    visit("keep-large", self.keep_large,
          "Of --densify adaptive: do not remove Gaussians larger than a tenth of the cameras' extent, which 3DGS does "
          "after --opacity-reset iterations and methods for few photos do not");
    visit(
        "unpool-until", self.unpool_until,
        "Of --densify adaptive: before this iteration Gaussians that stand alone grow new ones halfway to their three "
        "neighbors (FSGS, Zhu et al., ECCV 2024, uses 2000); 0 = never",
        Range{0, 1e7});
    visit("two-fields", self.two_fields,
          "Of --densify adaptive: train two models beside each other, pull their renders from between the photos "
          "together, and remove what only one of them has (CoR-GS, Zhang et al., ECCV 2024); the first one is the "
          "result");
    visit("co-prune-distance", self.co_prune_distance,
          "Of --two-fields: a Gaussian farther than this (units of the run) from all of the other model is removed, "
          "every "
          "500 iterations; CoR-GS uses 5, 10 or 20 by dataset",
          Range{1e-9, 1e9});
    visit("co-start", self.co_start, "Of --two-fields: iteration from which renders are pulled together",
          Range{1, 1e7});
    visit("random-background", self.random_background,
          "Render photos without transparency before another color in each iteration, so that the scene becomes opaque "
          "where they show it (CoR-GS)");
    visit(
        "pseudo-depth-weight", self.pseudo_depth_weight,
        "Weight of the correlation between the depth of renders from between the photos and the depth that the network "
        "of --depth-prior sees in them, or, where that is stereo alone, what stereo knows there (FSGS, Zhu et al., "
        "ECCV 2024, uses 0.05; 0.5 on LLFF, 0.03 on Mip-NeRF 360); 0 = off; on the CPU only",
        Range{0, 1e3});
    visit("pseudo-depth-start", self.pseudo_depth_start,
          "Of --pseudo-depth-weight: iteration after which it begins, growing over 500 iterations", Range{0, 1e7});
    visit("pseudo-depth-every", self.pseudo_depth_every,
          "Of --pseudo-depth-weight: iterations between these renders; FSGS uses 10, and 1 on LLFF", Range{1, 1e7});
    visit("hard-depth", self.hard_depth,
          "While Gaussians become more, let steps of the positions alone fit the depth of a render whose Gaussians all "
          "have opacity 0.95 to that of the photo, by patches that are normalized first (DNGaussian, Li et al., CVPR "
          "2024); on the CPU only");
    visit("soft-depth-start", self.soft_depth_start,
          "After this iteration do the same with steps of the opacities alone (DNGaussian uses 1000 on LLFF and DTU, "
          "never on Blender scenes); 0 = never; on the CPU only",
          Range{0, 1e7});
    visit("depth-step-every", self.depth_step_every,
          "Of --hard-depth and --soft-depth-start: iterations between these steps; DNGaussian uses 10 on Blender "
          "scenes, 1 on LLFF and DTU",
          Range{1, 1e7});
    visit("depth-tolerance", self.depth_tolerance,
          "Of the same: normalized depths that differ by less are left alone; DNGaussian uses 0.001 on Blender scenes, "
          "0.00025 on LLFF, 0.01 on DTU",
          Range{0, 1e3});
    visit("prune-modes-at", self.prune_modes_at,
          "At this iteration remove what hangs far before the surface that it hides: Gaussians up to the one that a "
          "pixel shows most of, where that lies far before its mean depth (SparseGS, Xiong et al. 2023, uses 20000 of "
          "30000); 0 = never; on the CPU only",
          Range{0, 1e7});
    visit("covisibility-weights", self.covisibility_weights,
          "Weigh each pixel of a photo by 1 / (1 + number of other photos whose depth shows the same point), in units "
          "of the mean weight: what few photos show counts more (CoMapGS, Jang and Perez-Pellitero, CVPR 2025)");
  }
};

}  // namespace oraclegs

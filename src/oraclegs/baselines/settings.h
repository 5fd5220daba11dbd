#pragma once
// Settings of published methods for few photos, as their authors have them; this program's own training does without
// (docs/baselines.md). baselines/methods.h has those of each method.

#include <optional>
#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

struct BaselineSettings {
  // Adaptive density control [Kerbl 2023]; without it the training is that of 3DGS-MCMC.
  bool adaptive = false;
  double densify_gradient = 0.0002;  ///< mean screen gradient from which a Gaussian is cloned or split
  double densify_opacity = 0;        ///< only Gaussians of more than this opacity are cloned or split
  double prune_opacity = 0.005;      ///< Gaussians of less are removed
  bool proximity_split = false;      ///< also splits Gaussians larger than the cameras' extent and far from others
  int opacity_reset = 3000;          ///< iterations between resets of all opacities; 0 = never
  std::optional<int> opacity_reset_first =
      {};                          ///< nullopt = opacity_reset, and before a white background also --refine-start
  double opacity_reset_to = 0.01;  ///< the largest opacity that a reset leaves
  bool keep_large = false;         ///< keeps Gaussians larger than a tenth of the cameras' extent
  int unpool_until = 0;            ///< before this iteration isolated Gaussians grow new ones (FSGS); 0 = never

  // Two models beside each other [Zhang 2024].
  bool two_fields = false;
  double co_prune_distance = 5;  ///< from the other model, units of the run; what is farther is removed
  int co_start = 500;            ///< iteration from which renders are pulled together
  bool random_background = false;

  // Depth of renders from between the photos [Zhu 2024].
  double pseudo_depth_weight = 0;  ///< 0 = off
  int pseudo_depth_start = 2000;   ///< iteration after which it begins
  int pseudo_depth_every = 10;     ///< iterations

  // Steps of positions and of opacities by depth alone [Li 2024].
  bool hard_depth = false;
  int soft_depth_start = 0;        ///< iteration after which opacities are stepped; 0 = never
  int depth_step_every = 10;       ///< iterations
  double depth_tolerance = 0.001;  ///< normalized depths that differ by less are left alone

  // Correlation between the depth of a photo and of its render [Zhu 2024, Xiong 2023].
  double depth_correlation = 0;    ///< weight; 0 = off
  double late_correlation = 1;     ///< factor of that weight in the last twentieth of the run
  double patched_correlation = 0;  ///< weight of the mean over random patches; 0 = off

  int prune_modes_at = 0;  ///< iteration that removes what hangs far before a surface [Xiong 2023]; 0 = never
  bool covisibility_weights = false;  ///< what few photos show counts more [Jang 2025]

  bool StepsByDepth() const { return hard_depth || soft_depth_start > 0; }
  bool UsesDepth() const {
    return StepsByDepth() || covisibility_weights || pseudo_depth_weight > 0 || depth_correlation > 0;
  }
};

/// Published method whose densifier and parts the training has (baselines/methods.h).
struct MethodOptions {
  std::string method;  ///< "" = this program's own training

  /// Settings of the method; those of none where it is not given. Throws UsageError for a word that is none.
  BaselineSettings Settings() const;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("method", self.method,
          "Densify and regularize as this published method does; `oraclegs bench` sets it together with the other "
          "options of the method (docs/baselines.md)",
          Tier::kSetting);
  }
};

}  // namespace oraclegs

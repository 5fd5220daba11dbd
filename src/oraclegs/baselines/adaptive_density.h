#pragma once
// Adaptive density control [Kerbl 2023, section 5.2]: Gaussians with large screen gradients are cloned where they are
// small and split where they are large, the transparent ones are removed, and opacities are reset now and then.
// Constants and order are those of the authors' program.

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "oraclegs/baselines/settings.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {

inline constexpr double kDenseShare = 0.01;  ///< fraction of the extent; larger Gaussians are split, others are cloned
inline constexpr double kSplitShrink = 1.6;  ///< divisor of the scales of the two halves
inline constexpr double kLargeShare = 0.1;   ///< fraction of the extent; larger ones are removed after the first reset

/// Settings of one refinement.
struct DensityControl {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double gradient = 0.0002;  ///< mean screen gradient from which a Gaussian is cloned or split
  double extent = 1;         ///< scene extent (SpatialExtent), world units
  int64_t max_gaussians = 0;
  double least_opacity = 0.005;  ///< Gaussians below are removed
  double opacity_to_grow = 0;    ///< Gaussians at or below are neither cloned nor split
  bool removes_large = false;    ///< removes Gaussians larger than kLargeShare
  bool splits_isolated = false;  ///< proximity split: splits Gaussians beyond ProximityLimits::Split, too
};

/// Adds Gaussians of its own, with their moments, after clones and splits and before the transparent are removed.
using AlsoGrow = std::function<void(Gaussians* gaussians, Adam* adam)>;

struct DensityChange {
  int64_t cloned = 0, split = 0, removed = 0;
};

/// Clones, splits and removes. gradients: [N] mean ScreenGradients. A clone is appended with zero moments; the original
/// keeps its own. A split Gaussian is replaced by two with zero moments, drawn from its own density, with scales
/// divided by kSplitShrink. Where `max_gaussians` leaves no room for all, the largest gradients come first. Gaussians
/// below the least opacity and too large ones are removed, but never all of them. The structs get new memory. Throws
/// ShapeError.
DensityChange ControlDensity(const DensityControl& control, const std::vector<float>& gradients, Gaussians* gaussians,
                             Adam* adam, const AlsoGrow& also = {});

/// Lowers opacities above `most` to it and zeroes the moments of all opacities.
void ResetOpacities(double most, Gaussians* gaussians, Adam* adam);

/// Whether all opacities are reset after this iteration: at opacity_reset_first and every opacity_reset after it,
/// before --refine-stop. Before a white background 3DGS does so once more, when densification begins.
bool ResetsOpacities(const BaselineSettings& settings, const TrainOptions& options, bool is_background_white,
                     int64_t iteration);

/// Maker of the densifier that watches the screen gradients and refines by them, on a CPU or a GPU. background: that of
/// the run.
DensifierMaker AdaptiveDensifierMaker(const BaselineSettings& settings, const std::array<float, 3>& background);

}  // namespace oraclegs

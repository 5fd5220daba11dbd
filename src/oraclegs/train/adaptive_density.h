#pragma once
// Adaptive density control [Kerbl 2023, section 5.2]: Gaussians that the photos pull at are cloned where they are small
// and split where they are large, the transparent ones are removed, and opacities are reset now and then. Constants and
// order are those of the authors' program.

#include <functional>
#include <memory>
#include <vector>

#include "oraclegs/train/densify.h"

namespace oraclegs {

inline constexpr double kDenseShare = 0.01;  ///< of the extent; larger Gaussians are split, others are cloned
inline constexpr double kSplitShrink = 1.6;  ///< scales of the two halves are divided by it
inline constexpr double kLargeShare = 0.1;   ///< of the extent; larger ones are removed after the first reset

/// What one refinement goes by.
struct DensityControl {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double gradient = 0.0002;  ///< from which a Gaussian is cloned or split
  double extent = 1;         ///< of the scene, world units
  int64_t max_gaussians = 0;
  double least_opacity = 0.005;  ///< below: removed
  double opacity_to_grow = 0;    ///< only above: cloned or split
  bool removes_large = false;    ///< those of more than kLargeShare
  bool splits_lonely = false;    ///< also, whatever their gradient, the lonely of baselines/unpool.h
};

/// Adds Gaussians of its own, with their moments, after clones and splits and before the transparent are removed.
using AlsoGrow = std::function<void(Gaussians* gaussians, Adam* adam)>;

struct DensityChange {
  int64_t cloned = 0, split = 0, removed = 0;
};

/// Clones, splits and removes. gradients: [N] mean ScreenGradients. A clone stands behind the others with zero moments;
/// the original keeps its own. A Gaussian that is split gives way to two, drawn from its own density, of scales
/// 1 / kSplitShrink, with zero moments. Where `max_gaussians` leaves no room for all, those of the largest gradients
/// come first. Removed is what is below the least opacity and what is too large; never all of them. Both structs get
/// new memory. Throws ShapeError.
DensityChange ControlDensity(const DensityControl& control, const std::vector<float>& gradients, Gaussians* gaussians,
                             Adam* adam, const AlsoGrow& also = {});

/// Opacities above `most` fall to it; the moments of all opacities become zero.
void ResetOpacities(double most, Gaussians* gaussians, Adam* adam);

/// Keeps the Gaussians of these rows, with their moments, in this order.
void KeepRows(const std::vector<int64_t>& rows, Gaussians* gaussians, Adam* adam);

/// The densifier of --densify adaptive: watches the screen gradients, then refines by them.
std::unique_ptr<Densifier> MakeAdaptiveDensifier(const DensifierSetup& setup);

}  // namespace oraclegs

#pragma once
// A color map for each photo: a camera chooses exposure and white balance anew for every image, and what it
// chose is no property of the scene.

#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {

/// shown = A rendered + b: the 3x4 matrix [A b], row by row.
using ExposureMap = std::array<float, 12>;
inline constexpr ExposureMap kIdentityExposure = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// dL/d(map), in the map's layout.
using ExposureGradient = std::array<double, 12>;

/// What a checkpoint holds of the maps; all of one length, the number of photos, 0 when they are not trained.
struct ExposureState {
  std::vector<ExposureMap> maps;
  std::vector<ExposureMap> m, v;  ///< Adam's moments
  std::vector<int64_t> steps;     ///< Adam's counters
};

/// The maps of all photos, their gradients and their Adam (beta 0.9, 0.999, epsilon 1e-8).
///
/// Only differences between photos can be known: all maps after a common one G are the same images as before,
/// with the scene's colors changed by the inverse of G. That freedom is taken away by keeping the mean of the maps at
/// the identity, with the G that does it: after every step (A, b) becomes (A M^-1, b - A M^-1 c), where (M, c) is the
/// mean map. So a photo keeps its exposure relative to any other through it, the rendered scene has the mean
/// exposure of the photos, and a single photo keeps the identity.
class Exposures {
 public:
  /// From maps in any gauge. Throws ShapeError when there is none, one is not finite or their mean has no inverse.
  explicit Exposures(std::vector<ExposureMap> start);

  /// shown = A image + b, pixel by pixel. Both [H,W,3] and contiguous.
  void Apply(int view, const Buffer<float>& image, const Buffer<float>& shown) const;

  /// The adjoint of Apply: turns `grad`, dL/d(shown), into dL/d(image) in place and returns dL/d(map). The same bits
  /// for any number of threads.
  ExposureGradient Backward(int view, const Buffer<float>& image, const Buffer<float>& grad);

  /// The regularization toward identity, weight / 2 * |map - identity|^2; adds its gradient.
  double AddRegularizer(int view, double weight, ExposureGradient* gradient) const;

  /// A step of Adam for one photo, and the mean back at the identity.
  void Step(int view, const ExposureGradient& gradient, double learning_rate);

  const std::vector<ExposureMap>& maps() const { return state_.maps; }
  const ExposureState& state() const { return state_; }
  /// Throws InputError when the state is of another number of photos.
  void Restore(const ExposureState& state);

 private:
  void FixGauge();

  ExposureState state_;
  std::vector<ExposureGradient> sums_;  // of blocks of pixels
};

}  // namespace oraclegs

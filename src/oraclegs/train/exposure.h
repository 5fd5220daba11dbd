#pragma once
// A color map for each photo: a camera chooses exposure and white balance anew for every photo, and its choice is no
// property of the scene.

#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/buffer.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {

/// shown = A rendered + b: the 3x4 matrix [A b], row by row.
using ExposureMap = std::array<float, 12>;
inline constexpr ExposureMap kIdentityExposure = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// The map that a photo taken by `camera` would have: the mean of the photos' maps with weights exp(-s^2), s the
/// distance to a photo in units of that to the second nearest one. Distances are those of centers, in radii of the ball
/// that the photos look at, plus the angle between the rotations. A photo's own place has its own map. `maps`
/// correspond to `photos`, of which there is at least one.
ExposureMap ExposureAt(const Camera& camera, const std::vector<Camera>& photos, const std::vector<ExposureMap>& maps);

/// Replaces an image, [H,W,3] on the host, by what it shows through a map: A rgb + b.
void ShowThrough(const ExposureMap& map, const Buffer<float>& image);

/// dL/d(map), in the map's layout.
using ExposureGradient = std::array<double, 12>;

/// State of the maps in a checkpoint. All members have one length, the number of photos; 0 when no maps are trained.
struct ExposureState {
  std::vector<ExposureMap> maps;
  std::vector<ExposureMap> m, v;  ///< Adam's moments
  std::vector<int64_t> steps;     ///< Adam's counters
};

/// The maps of all photos, their gradients and their Adam (beta 0.9, 0.999, epsilon 1e-8).
///
/// Only differences between photos are observable: applying a common map G before all maps gives the same images, with
/// the scene's colors changed by the inverse of G. The mean of the maps is kept at the identity to remove that freedom:
/// after every step (A, b) becomes (A M^-1, b - A M^-1 c), where (M, c) is the mean map. So a photo keeps its exposure
/// relative to any other, the rendered scene has the mean exposure of the photos, and a single photo keeps the
/// identity.
class Exposures {
 public:
  /// Takes maps in any gauge. Throws ShapeError when there is none, one is not finite or their mean is singular.
  explicit Exposures(std::vector<ExposureMap> start);

  /// Writes A image + b to `shown`, pixel by pixel. Images are [H,W,3] and contiguous.
  void Apply(int view, const Buffer<float>& image, const Buffer<float>& shown) const;

  /// The adjoint of Apply: turns `grad`, dL/d(shown), into dL/d(image) in place and returns dL/d(map). The result does
  /// not depend on the number of threads.
  ExposureGradient Backward(int view, const Buffer<float>& image, const Buffer<float>& grad);

  /// The regularization toward identity, weight / 2 * |map - identity|^2. Adds its gradient to `gradient`.
  double AddRegularizer(int view, double weight, ExposureGradient* gradient) const;

  /// Takes a step of Adam for one photo's map, then moves the mean of all maps back to the identity.
  void Step(int view, const ExposureGradient& gradient, double learning_rate);

  const std::vector<ExposureMap>& maps() const { return state_.maps; }
  const ExposureState& state() const { return state_; }
  /// Restores the state. Throws InputError when it is of another number of photos.
  void Restore(const ExposureState& state);

 private:
  void FixGauge();

  ExposureState state_;
  std::vector<ExposureGradient> sums_;  // of blocks of pixels
};

}  // namespace oraclegs

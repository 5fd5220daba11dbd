#pragma once
// Check that a picture as a whole shows the scene from its pose. A picture of another scene, pose, scale or orientation
// contradicts the images nearly everywhere, while a tampered one still agrees in parts
// (docs/method.md#tamper-trained-oracle).

#include <optional>
#include <vector>

#include "oraclegs/propose/warp_device.h"

namespace oraclegs {

/// Share [0, 1] of the textured cells, on a grid over the pixels that views show, in which the picture has the same
/// structure. nullopt where there are too few such cells. Throws ShapeError for images of different sizes.
std::optional<double> Agreement(const ImageF& picture, const WarpedView& warped);

class PictureCheck {
 public:
  /// Learns the least agreement from that of right pictures and of entirely wrong ones, at held-out poses. Without
  /// either, nothing is rejected.
  void Learn(std::vector<double> right, std::vector<double> wrong);

  bool Rejects(const std::optional<double>& agreement) const { return agreement && *agreement < least_; }
  double least() const { return least_; }

 private:
  double least_ = 0;
};

}  // namespace oraclegs

#pragma once
// Does a picture as a whole show the scene from its pose? One of another scene, pose, scale or orientation contradicts
// the images nearly everywhere, where a tampered one still agrees in parts (docs/method.md#tamper-trained-oracle).

#include <optional>
#include <vector>

#include "oraclegs/propose/warp_device.h"

namespace oraclegs {

/// Share [0, 1] of the cells with texture, of a grid over what the views show, in which the picture has the same
/// structure. Nothing where there are too few such cells to tell. Throws ShapeError for images of different sizes.
std::optional<double> Agreement(const ImageF& picture, const WarpedView& warped);

class PictureCheck {
 public:
  /// Learns the least agreement from that of pictures that are right and that are wrong as a whole, at held-out poses.
  /// Without either, nothing is rejected.
  void Learn(std::vector<double> right, std::vector<double> wrong);

  bool Rejects(const std::optional<double>& agreement) const { return agreement && *agreement < least_; }
  double least() const { return least_; }

 private:
  double least_ = 0;
};

}  // namespace oraclegs

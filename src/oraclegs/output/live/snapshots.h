#pragma once
// The model as it stands, for those that look on while it is trained.

#include <filesystem>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Decides when a snapshot is due, so that all of them together cost less than a fiftieth of the training's time.
class SnapshotClock {
 public:
  /// `now` and `cost` are seconds of any one clock. The first one is due at once, the next ones 3 seconds after the end
  /// of the last, or 50 times what that one cost.
  bool IsDue(double now) const { return now >= next_; }
  void Took(double end, double cost);

 private:
  double next_ = 0;
};

/// Writes Gaussians of any device to a .splat file, in place of the last ones. Returns the seconds it took. Throws
/// RunError.
double WriteSnapshot(const std::filesystem::path& path, const Gaussians& gaussians);

}  // namespace oraclegs

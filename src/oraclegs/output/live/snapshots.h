#pragma once
// Snapshots of the model while it is trained.

#include <filesystem>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Decides when a snapshot is due, so that all of them together take less than a fiftieth of the training's time.
class SnapshotClock {
 public:
  /// `now` and `cost` are seconds of any one clock. The first snapshot is due at once; each next one 3 seconds after
  /// the end of the last, or 50 times the cost of the last, whichever is later.
  bool IsDue(double now) const { return now >= next_; }
  void Took(double end, double cost);

 private:
  double next_ = 0;
};

/// Writes Gaussians on any device to a .splat file, replacing it. Returns the seconds it took. Throws RunError.
double WriteSnapshot(const std::filesystem::path& path, const Gaussians& gaussians);

}  // namespace oraclegs

#include "oraclegs/output/live/snapshots.h"

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/formats/splat.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {
namespace {

constexpr double kMinPause = 3;  // seconds
constexpr double kPauseOfCost = 50;

}  // namespace

void SnapshotClock::Took(double end, double cost) { next_ = end + std::max(kMinPause, kPauseOfCost * cost); }

double WriteSnapshot(const std::filesystem::path& path, const Gaussians& gaussians) {
  const Stopwatch watch;
  ReplaceFile(path, EncodeSplat(gaussians.To(kCpu)));
  return watch.Seconds();
}

}  // namespace oraclegs

#pragma once
// Target poses, when only a few views exist.

#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/propose/target_check.h"

namespace oraclegs {

/// So many views with a pose that neither train nor test are taken as poses by the automatic trajectory.
inline constexpr size_t kMinSpareForDataset = 4;

enum class Trajectory { kDataset, kOrbit, kSpiral, kInterpolate, kCoverage };

template <>
struct EnumWords<Trajectory> {
  static constexpr EnumWord<Trajectory> kWords[] = {{Trajectory::kDataset, "dataset"},
                                                    {Trajectory::kOrbit, "orbit"},
                                                    {Trajectory::kSpiral, "spiral"},
                                                    {Trajectory::kInterpolate, "interpolate"},
                                                    {Trajectory::kCoverage, "coverage"}};
};

/// Poses that --proposals auto asks for: images are slow to make, renders of proxy models are not.
inline constexpr int kUsualProposals = 32, kProxyProposals = 96;

struct TrajectoryOptions {
  Auto<Trajectory> trajectory;
  Auto<int> proposals;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("trajectory", self.trajectory,
          "Camera poses of the proposals: dataset = poses of the scene that neither train nor test, orbit, spiral, "
          "interpolate = a path through the training poses, coverage = where the photos leave most unseen, auto = "
          "dataset when it has at least 4 poses, else coverage");
    visit(
        "proposals", self.proposals,
        "Poses to propose images for; 0 = none, train on the photos alone; auto = 96 where proxy models alone propose, "
        "else 32",
        Range{0, 10000});
  }
};

/// At most options.proposals targets (kUsualProposals unless given), none of them a test pose, a training pose or the
/// same pose twice, inside geometry or one that sees next to nothing (target_check.h). orbit, spiral and interpolate
/// lose what is rejected; dataset picks evenly from what is usable, coverage the best of up to 4096 candidates. Names:
/// of dataset the view's without extension, '/' as '_'; else "orbit_0000". `listener` gets one Note of how many were
/// chosen; one Warning with counts and reasons when more than half were rejected, or that nothing is left and what to
/// try. The same request gives the same targets. Throws UsageError for an option out of range, std::invalid_argument
/// without training cameras.
std::vector<Target> ChooseTargets(const TrajectoryRequest& request, const TrajectoryOptions& options,
                                  const Listener& listener);

}  // namespace oraclegs

#pragma once
// Target poses where only a few views exist.

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/depth/fusion.h"
#include "oraclegs/propose/target_check.h"

namespace oraclegs {

/// Number of posed views that are neither training nor test views from which the automatic trajectory uses them as
/// poses.
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
        "Poses to propose images for; 0 = none, train on the photos alone; auto = none where the photos leave nothing "
        "open, 96 where proxy models alone propose, else 32",
        Range{0, 10000});
  }
};

/// Poses to choose.
struct TargetPlan {
  int count = 0;
  Trajectory trajectory = Trajectory::kCoverage;
  bool or_coverage = false;  ///< coverage where fewer than kMinSpareForDataset poses of `trajectory` can be used
};

/// At most plan.count targets, none of them a test pose, a training pose, a duplicate, inside geometry or a pose that
/// sees next to nothing (target_check.h). orbit, spiral and interpolate return fewer after rejections; dataset picks
/// evenly from the usable ones, coverage the best of up to 4096 candidates. Names: for dataset the view's without
/// extension, '/' as '_'; else "orbit_0000". `listener` gets one Note with the number of targets, and one Warning when
/// more than half were rejected (with counts and reasons) or nothing is left (with advice). Deterministic. Throws
/// std::invalid_argument without training cameras.
std::vector<Target> ChooseTargets(const TrajectoryRequest& request, const TargetPlan& plan, const Listener& listener);

/// Indices of at most `count` candidates, best first. Each next one sees the most points from directions in which no
/// training camera and no candidate chosen before has seen them: a point (PointsSeen) has the weight 1 - exp(-angle /
/// 10 degrees), with the angle to the nearest such direction. Ends when nothing is gained any more.
std::vector<size_t> ChooseByCoverage(const std::vector<DensePoint>& points, const std::vector<Camera>& train,
                                     const std::vector<Camera>& candidates, int count);

/// How much photos leave open, [0, 1]: the median over them of how new what one shows is beside all others, which is
/// the mean weight of its points as in ChooseByCoverage. 1 for a photo without points, and without photos.
double Openness(const std::vector<DensePoint>& points, const std::vector<Camera>& train);

}  // namespace oraclegs

#include "oraclegs/propose/trajectory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/text.h"
#include "oraclegs/propose/candidates.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/propose/target_check.h"

namespace oraclegs {
namespace {

constexpr int kCandidatesPerTarget = 8, kMinCandidates = 256, kMaxCandidates = 4096;
constexpr size_t kPointsTimesCandidates = 20000000;  // memory of the choice by coverage: 20 bytes for each
constexpr size_t kMinCoveragePoints = 1000;
constexpr size_t kStandInPoints = 2000;
constexpr double kStandInReach = 0.5;  // of the distance looked at

/// Accepted candidates, and why the others were rejected.
struct Sifted {
  std::vector<Target> good;
  size_t total = 0, test = 0, known = 0, inside = 0, nothing = 0;

  size_t rejected() const { return total - good.size(); }
  std::string Reasons() const {
    std::vector<std::string> reasons;
    const auto add = [&](size_t count, const char* what) {
      if (count > 0) reasons.push_back(fmt::format("{} {}", count, what));
    };
    add(test, "at a test pose");
    add(known, "at a training pose or at one chosen already");
    add(inside, "inside geometry");
    add(nothing, "where next to nothing of the scene is seen");
    return fmt::format("{}", fmt::join(reasons, ", "));
  }
};

Sifted Sift(std::vector<Target> candidates, const TargetCheck& check) {
  std::vector<Verdict> verdicts(candidates.size());
  ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t i) {
    verdicts[static_cast<size_t>(i)] = check.Classify(candidates[static_cast<size_t>(i)].camera);
  });
  Sifted sifted;
  sifted.total = candidates.size();
  PoseSet chosen({}, check.same_place());
  for (size_t i = 0; i < candidates.size(); ++i) {
    Verdict verdict = verdicts[i];
    if (verdict == Verdict::kGood && chosen.Has(candidates[i].camera)) verdict = Verdict::kKnownPose;
    sifted.test += verdict == Verdict::kTestPose ? 1 : 0;
    sifted.known += verdict == Verdict::kKnownPose ? 1 : 0;
    sifted.inside += verdict == Verdict::kInsideGeometry ? 1 : 0;
    sifted.nothing += verdict == Verdict::kSeesNothing ? 1 : 0;
    if (verdict != Verdict::kGood) continue;
    chosen.Add(candidates[i].camera);
    sifted.good.push_back(std::move(candidates[i]));
  }
  return sifted;
}

std::vector<Target> Unnamed(const std::vector<Camera>& cameras) {
  std::vector<Target> targets;
  for (const Camera& camera : cameras) targets.push_back({{}, camera});
  return targets;
}

/// Targets at indices linspace(0, n - 1, count), truncated.
std::vector<Target> EvenlyPicked(const std::vector<Target>& targets, size_t count) {
  if (targets.size() <= count) return targets;
  std::vector<Target> picked;
  for (size_t i = 0; i < count; ++i) {
    picked.push_back(targets[count > 1 ? i * (targets.size() - 1) / (count - 1) : 0]);
  }
  return picked;
}

std::vector<Camera> CoverageCandidates(const TrajectoryRequest& request, int count) {
  const int total = std::clamp(kCandidatesPerTarget * count, kMinCandidates, kMaxCandidates);
  std::vector<Camera> candidates = InterpolatedCandidates(request.train, total / 3);
  for (const Camera& c : OrbitCandidates(request.train, total / 3)) candidates.push_back(c);
  const int rest = total - static_cast<int>(candidates.size());
  for (const Camera& c : JitteredCandidates(request.train, rest, request.seed)) candidates.push_back(c);
  return candidates;
}

std::vector<Target> CandidatesOf(Trajectory trajectory, const TrajectoryRequest& request, int count) {
  switch (trajectory) {
    case Trajectory::kDataset:
      return request.spare;
    case Trajectory::kOrbit:
      return Unnamed(OrbitCandidates(request.train, count));
    case Trajectory::kSpiral:
      return Unnamed(SpiralCandidates(request.train, count));
    case Trajectory::kInterpolate:
      return Unnamed(InterpolatedCandidates(request.train, count));
    case Trajectory::kCoverage:
      break;
  }
  return Unnamed(CoverageCandidates(request, count));
}

/// Random points in the volume that the cameras look at, used when no surface is known.
std::vector<DensePoint> StandInPoints(const TrajectoryRequest& request) {
  const Ball ball = LookedAt(request.train);
  Rng rng(request.seed, RandomStream::kTargets, uint64_t{1} << 32);  // beyond what the candidates draw
  std::vector<DensePoint> points;
  while (points.size() < kStandInPoints) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = rng.Uniform(-1, 1);
    if (p.norm() > 1) continue;
    points.push_back({(ball.center + kStandInReach * ball.radius * p).cast<float>(), Eigen::Vector3f::Zero(),
                      Eigen::Vector3f::Zero()});
  }
  return points;
}

std::vector<Target> ChosenByCoverage(const TrajectoryRequest& request, const TargetCheck& check,
                                     const std::vector<Target>& candidates, int count) {
  const size_t budget = std::max(kMinCoveragePoints, kPointsTimesCandidates / std::max<size_t>(candidates.size(), 1));
  const std::vector<DensePoint> points =
      check.points().empty() ? StandInPoints(request) : EvenSample(check.points(), budget);
  std::vector<Camera> cameras;
  for (const Target& target : candidates) cameras.push_back(target.camera);
  std::vector<Target> chosen;
  for (const size_t i : ChooseByCoverage(points, request.train, cameras, count)) chosen.push_back(candidates[i]);
  return chosen;
}

void Name(Trajectory trajectory, std::vector<Target>* targets) {
  if (trajectory == Trajectory::kDataset) {
    std::vector<std::string> views;
    for (const Target& target : *targets) views.push_back(target.name);
    const std::vector<std::string> names = FileNames(views);
    for (size_t i = 0; i < targets->size(); ++i) (*targets)[i].name = names[i];
  } else {
    for (size_t i = 0; i < targets->size(); ++i) (*targets)[i].name = fmt::format("{}_{:04}", Word(trajectory), i);
  }
}

void Report(Trajectory trajectory, const Sifted& sifted, size_t chosen, const Listener& listener) {
  const std::string word = Word(trajectory);
  const std::string reasons = sifted.rejected() > 0 ? fmt::format("of {} candidates {} rejected: {}", sifted.total,
                                                                  sifted.rejected(), sifted.Reasons())
                                                    : fmt::format("{} candidates", sifted.total);
  if (chosen == 0) {
    listener(
        Warning{fmt::format("no usable pose for proposals on trajectory '{}' ({}); try another --trajectory, or "
                            "--proposals 0 to train on the photos alone",
                            word, reasons)});
    return;
  }
  if (2 * sifted.rejected() > sifted.total) {
    listener(
        Warning{fmt::format("more than half of the poses of trajectory '{}' cannot be used ({}); try another "
                            "--trajectory when too few are left",
                            word, reasons)});
  }
  listener(
      Note{fmt::format("{} for proposals chosen by trajectory '{}' ({})", Counted(chosen, "pose"), word, reasons)});
}

}  // namespace

std::vector<Target> ChooseTargets(const TrajectoryRequest& request, const TargetPlan& plan, const Listener& listener) {
  if (request.train.empty()) throw std::invalid_argument("ChooseTargets: needs training cameras");
  const int count = plan.count;
  if (count == 0) return {};
  const TargetCheck check(request);
  Trajectory trajectory = plan.trajectory;
  Sifted sifted = Sift(CandidatesOf(trajectory, request, count), check);
  if (plan.or_coverage && sifted.good.size() < kMinSpareForDataset) {
    trajectory = Trajectory::kCoverage;
    sifted = Sift(CandidatesOf(trajectory, request, count), check);
  }
  std::vector<Target> targets = sifted.good;
  if (trajectory == Trajectory::kDataset) targets = EvenlyPicked(targets, static_cast<size_t>(count));
  if (trajectory == Trajectory::kCoverage) targets = ChosenByCoverage(request, check, targets, count);
  Name(trajectory, &targets);
  Report(trajectory, sifted, targets.size(), listener);
  return targets;
}

}  // namespace oraclegs

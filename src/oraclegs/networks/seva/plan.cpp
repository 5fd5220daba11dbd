#include "oraclegs/networks/seva/plan.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "oraclegs/camera/camera_path.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kMinInputsToAddRoom = 9;  // from here on the first pass has room for all of them

/// Plans the two passes.
class Planner {
 public:
  Planner(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options)
      : inputs_(inputs), targets_(targets), options_(options) {}

  Plan Make() {
    const PassSizes sizes = SizePasses(Count(inputs_), options_.frames);
    plan_.anchors = OrbitAnchors(inputs_, targets_, sizes.anchors);
    if (!plan_.anchors.empty()) {
      ChunkProblem first = OfInputs(sizes.first_frames);
      first.targets = plan_.anchors;
      AddJobs(1, first, FirstPassChunks(first));
    }
    ChunkProblem second = OfInputs(options_.frames);
    second.sources.insert(second.sources.end(), plan_.anchors.begin(), plan_.anchors.end());
    second.targets = targets_;
    AddJobs(2, second, SecondPassChunks(second));
    return std::move(plan_);
  }

 private:
  static int64_t Count(const std::vector<View>& views) { return static_cast<int64_t>(views.size()); }

  ChunkProblem OfInputs(int64_t frames) const {
    ChunkProblem problem;
    problem.sources = inputs_;
    problem.inputs.resize(inputs_.size());
    std::iota(problem.inputs.begin(), problem.inputs.end(), 0);
    problem.frames = frames;
    return problem;
  }

  /// Frame of the scene that a slot of a pass stands for.
  Frame FrameOf(int pass, const Slot& slot, int64_t sources) const {
    const FrameSource made = pass == 1 ? FrameSource::kAnchor : FrameSource::kTarget;
    if (slot.kind == SlotKind::kTarget) return {made, slot.index, false, false};
    if (slot.index >= sources) return {made, slot.index - sources, true, false};
    if (slot.index < Count(inputs_)) return {FrameSource::kInput, slot.index, true, false};
    return {FrameSource::kAnchor, slot.index - Count(inputs_), true, false};
  }

  void AddJobs(int pass, const ChunkProblem& problem, const std::vector<Chunk>& chunks) {
    for (const Chunk& chunk : chunks) {
      Job job;
      job.pass = pass;
      const Chunk padded = Padded(chunk);
      for (size_t i = 0; i < padded.size(); ++i) {
        job.frames.push_back(FrameOf(pass, padded[i], Count(problem.sources)));
        job.frames.back().copy = chunk[i].kind == SlotKind::kEmpty;
      }
      plan_.jobs.push_back(std::move(job));
    }
  }

  const std::vector<View>&inputs_, &targets_;
  const SevaOptions& options_;
  Plan plan_;
};

}  // namespace

PassSizes SizePasses(int64_t inputs, int64_t frames) {
  PassSizes sizes{std::max<int64_t>(frames - inputs, 0), frames};
  if (inputs >= kMinInputsToAddRoom) sizes.first_frames = sizes.anchors + inputs;
  return sizes;
}

int64_t Plan::largest() const {
  size_t largest = 0;
  for (const Job& job : jobs) largest = std::max(largest, job.frames.size());
  return static_cast<int64_t>(largest);
}

Plan MakePlan(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options) {
  if (inputs.empty()) throw ShapeError("MakePlan: there are no input views");
  CheckOptions(options);
  if (targets.empty()) return {};
  return Planner(inputs, targets, options).Make();
}

Eigen::Vector3d LookAtPoint(const std::vector<View>& views) {
  if (views.empty()) throw ShapeError("LookAtPoint: there are no cameras");
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const View& view : views) mean += view.center() / static_cast<double>(views.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    const Eigen::Vector3d axis = view.world_from_camera.linear().col(2).normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    sum += across;
    right += across * (view.center() - mean);
  }
  return mean + sum.completeOrthogonalDecomposition().solve(right);
}

Eigen::Vector3d UpOf(const std::vector<View>& views) {
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  for (const View& view : views) down += view.world_from_camera.linear().col(1);
  return -down.normalized();
}

std::vector<Eigen::Isometry3d> Orbit(const Eigen::Vector3d& start, const Eigen::Vector3d& center,
                                     const Eigen::Vector3d& up, int64_t count) {
  std::vector<Eigen::Isometry3d> poses;
  for (int64_t i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count);
    const Eigen::Vector3d position = center + Eigen::AngleAxisd(angle, up) * (start - center);
    poses.push_back(LookAt(position, center, up).inverse());
  }
  return poses;
}

std::vector<View> OrbitAnchors(const std::vector<View>& inputs, const std::vector<View>& targets, int64_t count) {
  if (inputs.empty()) throw ShapeError("OrbitAnchors: there are no input views");
  std::vector<View> all = inputs;
  all.insert(all.end(), targets.begin(), targets.end());
  const std::vector<Eigen::Isometry3d> poses =
      Orbit(inputs.front().center(), LookAtPoint(all), UpOf(inputs), count + 1);
  const View& like = targets.empty() ? inputs.front() : targets.front();
  std::vector<View> anchors;
  for (size_t i = 1; i < poses.size(); ++i) anchors.push_back({poses[i], like.intrinsics});
  return anchors;
}

}  // namespace oraclegs::seva

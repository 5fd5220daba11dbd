#include "oraclegs/networks/seva/plan.h"

#include <algorithm>
#include <numeric>

#include "oraclegs/networks/seva/orbit.h"

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

}  // namespace oraclegs::seva

#include "oraclegs/networks/seva/plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "oraclegs/networks/seva/orbit.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kMinInputsToAddRoom = 9;  // from here on the first pass has room for all of them

bool Interpolates(Chunking chunking) { return chunking == Chunking::kInterp || chunking == Chunking::kInterpGt; }

/// True when all input images are in every chunk.
bool LeadsWithInputs(Chunking chunking) { return chunking != Chunking::kNearest && chunking != Chunking::kInterp; }

/// Value i of `count` evenly spaced values from low to high.
double Spaced(double low, double high, int64_t i, int64_t count) {
  return count < 2 ? low : low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1);
}

/// Plans the two passes.
class Planner {
 public:
  Planner(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options)
      : inputs_(inputs), targets_(targets), options_(options), path_(Interpolates(options.chunking)) {}

  Plan Make() {
    PassSizes sizes{0, options_.frames, options_.frames};
    if (options_.passes == 2) {
      sizes = SizePasses({Count(inputs_), Count(targets_), options_.frames, options_.frames, options_.anchor_ratio},
                         options_.chunking);
    } else if (path_) {
      throw UsageError("--seva-chunking {} needs frames made in a first pass; set --seva-passes 2",
                       Word(options_.chunking));
    }
    PlaceAnchors(sizes.anchors);
    if (!plan_.anchors.empty()) {
      ChunkProblem first = OfInputs(sizes.first_frames);
      first.targets = plan_.anchors;
      AddJobs(1, first, ToChunking(options_.first_chunking));
    }
    ChunkProblem second = OfInputs(sizes.second_frames);
    second.sources.insert(second.sources.end(), plan_.anchors.begin(), plan_.anchors.end());
    second.targets = targets_;
    second.time_line = TimeLine::kWithoutInputs;
    for (int64_t i = 0; i < Count(inputs_); ++i) second.source_orders.push_back(static_cast<double>(i));
    second.source_orders.insert(second.source_orders.end(), anchor_orders_.begin(), anchor_orders_.end());
    for (int64_t i = 0; i < Count(targets_); ++i) {
      second.target_orders.push_back(static_cast<double>(Count(inputs_) + i));
    }
    AddJobs(2, second, options_.chunking);
    return std::move(plan_);
  }

 private:
  static int64_t Count(const std::vector<View>& views) { return static_cast<int64_t>(views.size()); }

  void PlaceAnchors(int64_t count) {
    if (!path_) {
      plan_.anchors = OrbitAnchors(inputs_, targets_, count);
      anchor_orders_.assign(static_cast<size_t>(count), 0);
      return;
    }
    const double last = static_cast<double>(Count(targets_) - 1), before = static_cast<double>(Count(inputs_));
    for (int64_t i = 0; i < count; ++i) {
      const auto place = static_cast<size_t>(std::nearbyint(Spaced(0, last, i, count)));
      plan_.anchors.push_back(targets_[place]);
      anchor_orders_.push_back(Spaced(before, before + last, i, count));
    }
  }

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

  void AddJobs(int pass, const ChunkProblem& problem, Chunking chunking) {
    for (const Chunk& chunk : PlanChunks(problem, chunking)) {
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
  const bool path_;
  Plan plan_;
  std::vector<double> anchor_orders_;
};

}  // namespace

PassSizes SizePasses(const PassRequest& request, Chunking chunking) {
  PassSizes sizes{0, request.first_frames, request.second_frames};
  const bool many = request.inputs >= kMinInputsToAddRoom, leading = LeadsWithInputs(chunking);
  const int64_t fill = std::max<int64_t>(request.first_frames - request.inputs, 0);
  if (Interpolates(chunking)) {
    const int64_t between = request.second_frames - 2 - (leading && !many ? request.inputs : 0);
    if (between < 1) {
      throw UsageError("{} photos leave --seva-chunking {} no room in chunks of {} frames; raise --seva-frames",
                       request.inputs, Word(chunking), request.second_frames);
    }
    const double share = static_cast<double>(request.targets) / static_cast<double>(between);
    sizes.anchors = static_cast<int64_t>(std::ceil(share * request.anchor_ratio)) + 1;
    if (sizes.anchors + request.inputs < request.first_frames) sizes.anchors = fill;
    if (many && leading) sizes.second_frames += request.inputs;
  } else {
    sizes.anchors = fill;
  }
  if (many) sizes.first_frames = sizes.anchors + request.inputs;
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

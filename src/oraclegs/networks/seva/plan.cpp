#include "oraclegs/networks/seva/plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "oraclegs/networks/seva/orbit.h"

namespace oraclegs {
namespace {

constexpr int64_t kManyPhotographs = 9;  // from here on the first pass makes room for all of them

bool Interpolates(const std::string& chunking) { return chunking.starts_with("interp"); }

/// i of `count` values from low to high.
double Spaced(double low, double high, int64_t i, int64_t count) {
  return count < 2 ? low : low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1);
}

/// What both passes are planned from.
class Planner {
 public:
  Planner(const std::vector<SevaView>& photographs, const std::vector<SevaView>& targets, const SevaOptions& options)
      : photographs_(photographs), targets_(targets), options_(options), path_(Interpolates(options.chunking)) {}

  SevaPlan Plan() {
    SevaPassSizes sizes{0, options_.frames, options_.frames};
    if (options_.passes == 2) {
      sizes =
          SizePasses({Count(photographs_), Count(targets_), options_.frames, options_.frames, options_.anchor_ratio},
                     options_.chunking);
    } else if (path_) {
      throw UsageError("--seva-chunking {} needs frames made in a first pass; set --seva-passes 2", options_.chunking);
    }
    PlaceAnchors(sizes.anchors);
    if (!plan_.anchors.empty()) {
      ChunkProblem first = OfPhotographs(sizes.first_frames);
      first.targets = plan_.anchors;
      AddJobs(1, first, options_.first_chunking);
    }
    ChunkProblem second = OfPhotographs(sizes.second_frames);
    second.sources.insert(second.sources.end(), plan_.anchors.begin(), plan_.anchors.end());
    second.targets = targets_;
    second.time_line = SevaTimeLine::kWithoutPhotographs;
    for (int64_t i = 0; i < Count(photographs_); ++i) second.source_orders.push_back(static_cast<double>(i));
    second.source_orders.insert(second.source_orders.end(), anchor_orders_.begin(), anchor_orders_.end());
    for (int64_t i = 0; i < Count(targets_); ++i) {
      second.target_orders.push_back(static_cast<double>(Count(photographs_) + i));
    }
    AddJobs(2, second, options_.chunking);
    return std::move(plan_);
  }

 private:
  static int64_t Count(const std::vector<SevaView>& views) { return static_cast<int64_t>(views.size()); }

  void PlaceAnchors(int64_t count) {
    if (!path_) {
      plan_.anchors = OrbitAnchors(photographs_, targets_, count);
      anchor_orders_.assign(static_cast<size_t>(count), 0);
      return;
    }
    const double last = static_cast<double>(Count(targets_) - 1), before = static_cast<double>(Count(photographs_));
    for (int64_t i = 0; i < count; ++i) {
      const auto place = static_cast<size_t>(std::nearbyint(Spaced(0, last, i, count)));
      plan_.anchors.push_back(targets_[place]);
      anchor_orders_.push_back(Spaced(before, before + last, i, count));
    }
  }

  ChunkProblem OfPhotographs(int64_t frames) const {
    ChunkProblem problem;
    problem.sources = photographs_;
    problem.photographs.resize(photographs_.size());
    std::iota(problem.photographs.begin(), problem.photographs.end(), 0);
    problem.frames = frames;
    return problem;
  }

  /// A slot of a pass as a frame of the scene.
  SevaFrame FrameOf(int pass, const SevaSlot& slot, int64_t sources) const {
    const SevaFrameSource made = pass == 1 ? SevaFrameSource::kAnchor : SevaFrameSource::kTarget;
    if (slot.kind == SevaSlotKind::kTarget) return {made, slot.index, false, false};
    if (slot.index >= sources) return {made, slot.index - sources, true, false};
    if (slot.index < Count(photographs_)) return {SevaFrameSource::kPhotograph, slot.index, true, false};
    return {SevaFrameSource::kAnchor, slot.index - Count(photographs_), true, false};
  }

  void AddJobs(int pass, const ChunkProblem& problem, const std::string& strategy) {
    for (const SevaChunk& chunk : PlanChunks(problem, strategy)) {
      SevaJob job;
      job.pass = pass;
      const SevaChunk padded = Padded(chunk);
      for (size_t i = 0; i < padded.size(); ++i) {
        job.frames.push_back(FrameOf(pass, padded[i], Count(problem.sources)));
        job.frames.back().copy = chunk[i].kind == SevaSlotKind::kEmpty;
      }
      plan_.jobs.push_back(std::move(job));
    }
  }

  const std::vector<SevaView>&photographs_, &targets_;
  const SevaOptions& options_;
  const bool path_;
  SevaPlan plan_;
  std::vector<double> anchor_orders_;
};

}  // namespace

SevaPassSizes SizePasses(const SevaPassRequest& request, const std::string& chunking) {
  SevaPassSizes sizes{0, request.first_frames, request.second_frames};
  const bool many = request.photographs >= kManyPhotographs, leading = chunking.find("gt") != std::string::npos;
  const int64_t fill = std::max<int64_t>(request.first_frames - request.photographs, 0);
  if (Interpolates(chunking)) {
    const int64_t between = request.second_frames - 2 - (leading && !many ? request.photographs : 0);
    if (between < 1) {
      throw UsageError("{} photographs leave --seva-chunking {} no room in chunks of {} frames; raise --seva-frames",
                       request.photographs, chunking, request.second_frames);
    }
    const double share = static_cast<double>(request.targets) / static_cast<double>(between);
    sizes.anchors = static_cast<int64_t>(std::ceil(share * request.anchor_ratio)) + 1;
    if (sizes.anchors + request.photographs < request.first_frames) sizes.anchors = fill;
    if (many && leading) sizes.second_frames += request.photographs;
  } else {
    sizes.anchors = fill;
  }
  if (many) sizes.first_frames = sizes.anchors + request.photographs;
  return sizes;
}

int64_t SevaPlan::largest() const {
  size_t largest = 0;
  for (const SevaJob& job : jobs) largest = std::max(largest, job.frames.size());
  return static_cast<int64_t>(largest);
}

SevaPlan PlanSeva(const std::vector<SevaView>& photographs, const std::vector<SevaView>& targets,
                  const SevaOptions& options) {
  if (photographs.empty()) throw ShapeError("PlanSeva: there are no photographs");
  CheckOptions(options);
  if (targets.empty()) return {};
  return Planner(photographs, targets, options).Plan();
}

}  // namespace oraclegs

#include "oraclegs/networks/seva/chunks.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace oraclegs::seva {
namespace {

constexpr double kPseudoShare = 0.33;

template <class Distance>
int64_t Nearest(const std::vector<View>& sources, Distance&& distance) {
  if (sources.empty()) throw ShapeError("PlanChunks: there are no conditioning views");
  int64_t nearest = 0;
  double least = distance(sources.front());
  for (size_t i = 1; i < sources.size(); ++i) {
    const double d = distance(sources[i]);
    if (d < least) nearest = static_cast<int64_t>(i), least = d;
  }
  return nearest;
}

Chunk OfInputs(const ChunkProblem& problem) {
  Chunk chunk;
  for (const int64_t p : problem.inputs) chunk.push_back({SlotKind::kGiven, p});
  return chunk;
}

int64_t FreeSlots(const ChunkProblem& problem) {
  const int64_t slots = problem.frames - static_cast<int64_t>(problem.inputs.size());
  if (slots < 1) {
    throw UsageError("{} photos leave no room in chunks of {} frames; --seva-frames must be at least {}",
                     problem.inputs.size(), problem.frames, problem.inputs.size() + 2);
  }
  return slots;
}

/// Frames that the nearest generated frames of the remaining targets suggest (docs/method.md#seva-chunks, gt-nearest).
std::vector<int64_t> SuggestedFrames(const ChunkProblem& problem, int64_t made, int64_t wanted) {
  const std::vector<View> earlier(problem.targets.begin(), problem.targets.begin() + made);
  const auto count = static_cast<int64_t>(problem.targets.size());
  const int64_t slots = FreeSlots(problem), last = made - 1;
  int64_t places = wanted;
  while (true) {
    std::vector<int64_t> suggested;
    for (int64_t t = made; t < std::min(made + slots - places, count); ++t) {
      const View& view = problem.targets[static_cast<size_t>(t)];
      for (const int64_t frame : {NearestByRotation(view, earlier), NearestByDistance(view, earlier)}) {
        if (frame != last) suggested.push_back(frame);
      }
    }
    std::vector<int64_t> chosen = MostFrequent(suggested, static_cast<size_t>(wanted - 1));
    chosen.push_back(last);
    const auto size = static_cast<int64_t>(chosen.size());
    if (size >= places) return chosen;
    places = size;
  }
}

}  // namespace

int64_t NearestByDistance(const View& view, const std::vector<View>& sources) {
  return Nearest(sources, [&](const View& source) { return (source.center() - view.center()).norm(); });
}

int64_t NearestByRotation(const View& view, const std::vector<View>& sources) {
  return Nearest(sources, [&](const View& source) {
    return RotationDegrees(view.world_from_camera.linear(), source.world_from_camera.linear());
  });
}

std::vector<int64_t> MostFrequent(const std::vector<int64_t>& values, size_t count) {
  std::vector<int64_t> distinct;
  std::map<int64_t, int64_t> counts;
  for (const int64_t value : values) {
    if (counts[value]++ == 0) distinct.push_back(value);
  }
  std::stable_sort(distinct.begin(), distinct.end(), [&](int64_t a, int64_t b) { return counts[a] > counts[b]; });
  if (distinct.size() > count) distinct.resize(count);
  std::sort(distinct.begin(), distinct.end());
  return distinct;
}

std::vector<Chunk> FirstPassChunks(const ChunkProblem& problem) {
  const int64_t slots = FreeSlots(problem), count = static_cast<int64_t>(problem.targets.size());
  const auto sources = static_cast<int64_t>(problem.sources.size());
  const double share = kPseudoShare * static_cast<double>(slots);
  std::vector<Chunk> chunks;
  for (int64_t made = 0; made < count;) {
    Chunk chunk = OfInputs(problem);
    if (made > 0) {
      const int64_t remaining = count - made;
      const bool many = remaining >= static_cast<int64_t>(std::floor(share));
      const int64_t wanted = std::min(many ? static_cast<int64_t>(std::ceil(share)) : slots - remaining, made);
      if (wanted >= slots) {
        throw UsageError(
            "chunks of {} frames have no room for photos, made frames and new ones; raise "
            "--seva-frames",
            problem.frames);
      }
      for (const int64_t frame : SuggestedFrames(problem, made, wanted)) {
        chunk.push_back({SlotKind::kGiven, sources + frame});
      }
    }
    while (made < count && static_cast<int64_t>(chunk.size()) < problem.frames) {
      chunk.push_back({SlotKind::kTarget, made++});
    }
    chunk.resize(static_cast<size_t>(problem.frames));
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

Chunk Padded(const Chunk& chunk) {
  Chunk padded = chunk;
  Slot last;
  for (Slot& slot : padded) {
    if (slot.kind == SlotKind::kEmpty) slot = last;
    last = slot;
  }
  return padded;
}

}  // namespace oraclegs::seva

#include "oraclegs/networks/seva/chunks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace oraclegs {
namespace {

constexpr double kPseudoShare = 0.33;

template <class Distance>
int64_t Nearest(const std::vector<SevaView>& sources, Distance&& distance) {
  if (sources.empty()) throw ShapeError("PlanChunks: there are no conditioning views");
  int64_t nearest = 0;
  double least = distance(sources.front());
  for (size_t i = 1; i < sources.size(); ++i) {
    const double d = distance(sources[i]);
    if (d < least) nearest = static_cast<int64_t>(i), least = d;
  }
  return nearest;
}

SevaChunk OfPhotographs(const ChunkProblem& problem) {
  SevaChunk chunk;
  for (const int64_t p : problem.photographs) chunk.push_back({SevaSlotKind::kGiven, p});
  return chunk;
}

int64_t FreeSlots(const ChunkProblem& problem) {
  const int64_t slots = problem.frames - static_cast<int64_t>(problem.photographs.size());
  if (slots < 1) {
    throw UsageError("{} photographs leave no room in chunks of {} frames; --seva-frames must be at least {}",
                     problem.photographs.size(), problem.frames, problem.photographs.size() + 2);
  }
  return slots;
}

/// What the remaining targets' nearest made frames suggest (docs/method.md#seva-chunks, gt-nearest).
std::vector<int64_t> SuggestedFrames(const ChunkProblem& problem, int64_t made, int64_t wanted) {
  const std::vector<SevaView> earlier(problem.targets.begin(), problem.targets.begin() + made);
  const auto count = static_cast<int64_t>(problem.targets.size());
  const int64_t slots = FreeSlots(problem), last = made - 1;
  int64_t places = wanted;
  while (true) {
    std::vector<int64_t> suggested;
    for (int64_t t = made; t < std::min(made + slots - places, count); ++t) {
      const SevaView& view = problem.targets[static_cast<size_t>(t)];
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

int64_t NearestByDistance(const SevaView& view, const std::vector<SevaView>& sources) {
  return Nearest(sources, [&](const SevaView& source) { return (source.center() - view.center()).norm(); });
}

int64_t NearestByRotation(const SevaView& view, const std::vector<SevaView>& sources) {
  return Nearest(sources, [&](const SevaView& source) {
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

std::vector<SevaChunk> PhotographChunks(const ChunkProblem& problem) {
  const int64_t slots = FreeSlots(problem), count = static_cast<int64_t>(problem.targets.size());
  std::vector<SevaChunk> chunks;
  for (int64_t begin = 0; begin < count; begin += slots) {
    SevaChunk chunk = OfPhotographs(problem);
    for (int64_t t = begin; t < std::min(begin + slots, count); ++t) chunk.push_back({SevaSlotKind::kTarget, t});
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

std::vector<SevaChunk> PseudoChunks(const ChunkProblem& problem, EarlierFrames earlier) {
  const int64_t slots = FreeSlots(problem), count = static_cast<int64_t>(problem.targets.size());
  const auto sources = static_cast<int64_t>(problem.sources.size());
  const double share = kPseudoShare * static_cast<double>(slots);
  std::vector<SevaChunk> chunks;
  for (int64_t made = 0; made < count;) {
    SevaChunk chunk = OfPhotographs(problem);
    if (made > 0) {
      const int64_t remaining = count - made;
      const bool many = remaining >= static_cast<int64_t>(std::floor(share));
      const int64_t wanted = std::min(many ? static_cast<int64_t>(std::ceil(share)) : slots - remaining, made);
      if (wanted >= slots) {
        throw UsageError(
            "chunks of {} frames have no room for photographs, made frames and new ones; raise "
            "--seva-frames",
            problem.frames);
      }
      std::vector<int64_t> frames;
      if (earlier == EarlierFrames::kNearest) {
        frames = SuggestedFrames(problem, made, wanted);
      } else {
        for (int64_t t = made - wanted; t < made; ++t) frames.push_back(t);
      }
      for (const int64_t frame : frames) chunk.push_back({SevaSlotKind::kGiven, sources + frame});
    }
    while (made < count && static_cast<int64_t>(chunk.size()) < problem.frames) {
      chunk.push_back({SevaSlotKind::kTarget, made++});
    }
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

std::vector<SevaChunk> PlanChunks(const ChunkProblem& problem, const std::string& strategy) {
  const auto plan = [&]() -> std::vector<SevaChunk> {
    if (strategy == "gt") return PhotographChunks(problem);
    if (strategy == "gt-nearest") return PseudoChunks(problem, EarlierFrames::kNearest);
    if (strategy == "gt-ltr") return PseudoChunks(problem, EarlierFrames::kLast);
    if (strategy == "nearest") return NearestChunks(problem, NearestBase::kNone);
    if (strategy == "nearest-gt") return NearestChunks(problem, NearestBase::kPhotographs);
    if (strategy == "interp") return IntervalChunks(problem, NearestBase::kNone);
    if (strategy == "interp-gt") return IntervalChunks(problem, NearestBase::kPhotographs);
    int64_t count = 0;
    const std::string number = strategy.starts_with("nearest-") ? strategy.substr(8) : "";
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), count);
    const bool whole = error == std::errc() && end == number.data() + number.size();
    if (!number.empty() && whole && count > 0) return NearestBlocks(problem, count);
    throw UsageError(
        "'{}' is no way to choose frames; gt, gt-nearest, gt-ltr, nearest, nearest-gt, nearest-K, interp "
        "or interp-gt",
        strategy);
  };
  std::vector<SevaChunk> chunks = plan();
  for (SevaChunk& chunk : chunks) chunk.resize(static_cast<size_t>(problem.frames));
  return chunks;
}

SevaChunk Padded(const SevaChunk& chunk) {
  SevaChunk padded = chunk;
  SevaSlot last;
  for (SevaSlot& slot : padded) {
    if (slot.kind == SevaSlotKind::kEmpty) slot = last;
    last = slot;
  }
  return padded;
}

}  // namespace oraclegs

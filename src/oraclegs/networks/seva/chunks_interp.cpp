// Strategies interp and interp-gt: targets with the sources that bound them on a time line.

#include <algorithm>
#include <limits>

#include "oraclegs/networks/seva/chunks.h"

namespace oraclegs::seva {
namespace {

constexpr double kBehindTheLast = 0.01;  // so that a target at the last source's place counts as before it

/// Sources that bound intervals, by place on the time line.
std::vector<int64_t> Bounds(const ChunkProblem& problem) {
  std::vector<int64_t> bounds;
  for (int64_t i = 0; i < static_cast<int64_t>(problem.sources.size()); ++i) {
    const auto& real = problem.inputs;
    const bool dropped =
        problem.time_line == TimeLine::kWithoutInputs && std::find(real.begin(), real.end(), i) != real.end();
    if (!dropped) bounds.push_back(i);
  }
  return bounds;
}

std::vector<Slot> TargetsBetween(const ChunkProblem& problem, double begin, double end) {
  std::vector<Slot> slots;
  for (size_t t = 0; t < problem.target_orders.size(); ++t) {
    const double order = problem.target_orders[t];
    if (order >= begin && order < end) slots.push_back({SlotKind::kTarget, static_cast<int64_t>(t)});
  }
  return slots;
}

bool HasTarget(const Chunk& chunk) {
  return std::any_of(chunk.begin(), chunk.end(), [](const Slot& slot) { return slot.kind == SlotKind::kTarget; });
}

}  // namespace

std::vector<Chunk> IntervalChunks(const ChunkProblem& problem, NearestBase base) {
  if (problem.source_orders.size() != problem.sources.size() ||
      problem.target_orders.size() != problem.targets.size()) {
    throw ShapeError("IntervalChunks: {} sources with {} orders, {} targets with {}", problem.sources.size(),
                     problem.source_orders.size(), problem.targets.size(), problem.target_orders.size());
  }
  const std::vector<int64_t> bounds = Bounds(problem);
  if (bounds.empty()) throw UsageError("interp needs frames made in a first pass; set --seva-passes 2");
  const auto frames = static_cast<size_t>(problem.frames);
  Chunk lead;
  if (base == NearestBase::kInputs) {
    for (const int64_t p : problem.inputs) lead.push_back({SlotKind::kGiven, p});
  }
  const auto add = [&](Chunk* chunk, const std::vector<Slot>& slots) {
    chunk->insert(chunk->end(), slots.begin(), slots.end());
    if (chunk->size() <= frames) return;
    throw UsageError(
        "{} targets between two frames do not fit into chunks of {} frames; raise --seva-frames or "
        "--seva-anchor-ratio",
        slots.size(), frames);
  };
  const auto order = [&](size_t i) { return problem.source_orders[static_cast<size_t>(bounds[i])]; };
  const double behind = order(bounds.size() - 1) + kBehindTheLast;
  std::vector<Chunk> chunks;
  Chunk chunk = lead;
  const double first_stop = bounds.size() == 1 ? behind : order(0);
  add(&chunk, TargetsBetween(problem, -std::numeric_limits<double>::infinity(), first_stop));
  add(&chunk, {{SlotKind::kGiven, bounds.front()}});
  for (size_t i = 0; i < bounds.size(); ++i) {
    const bool last = i + 1 == bounds.size();
    const double begin = last ? behind : order(i);
    const double end =
        last ? std::numeric_limits<double>::infinity() : (i + 2 == bounds.size() ? behind : order(i + 1));
    std::vector<Slot> slots = TargetsBetween(problem, begin, end);
    if (slots.empty()) continue;
    if (!last) slots.push_back({SlotKind::kGiven, bounds[i + 1]});
    if (chunk.size() + slots.size() > frames) {
      if (HasTarget(chunk)) chunks.push_back(chunk);
      chunk = lead;
      chunk.push_back({SlotKind::kGiven, bounds[i]});
    }
    add(&chunk, slots);
  }
  if (HasTarget(chunk)) chunks.push_back(chunk);
  return chunks;
}

}  // namespace oraclegs::seva

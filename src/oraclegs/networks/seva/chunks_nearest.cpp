// The second pass: targets with the sources nearest to them.

#include <algorithm>
#include <map>

#include "oraclegs/networks/seva/chunks.h"

namespace oraclegs::seva {
namespace {

/// Fills chunks that all begin with the same frames.
class Filler {
 public:
  Filler(const ChunkProblem& problem, Chunk base)
      : frames_(static_cast<size_t>(problem.frames)), base_(std::move(base)), chunk_(base_) {}

  bool InBase(int64_t source) const {
    return std::find(base_.begin(), base_.end(), Slot{SlotKind::kGiven, source}) != base_.end();
  }

  void Add(int64_t source, const std::vector<int64_t>& targets) {
    const size_t prefix = InBase(source) ? 0 : 1;
    for (size_t next = 0; next < targets.size();) {
      if (chunk_.size() + prefix == frames_) Close();
      if (prefix) chunk_.push_back({SlotKind::kGiven, source});
      while (next < targets.size() && chunk_.size() < frames_) {
        chunk_.push_back({SlotKind::kTarget, targets[next++]});
      }
      if (chunk_.size() == frames_) Close();
    }
  }

  std::vector<Chunk> Finish() {
    if (chunk_ != base_) Close();
    return std::move(chunks_);
  }

 private:
  void Close() {
    chunk_.resize(frames_);
    chunks_.push_back(chunk_);
    chunk_ = base_;
  }

  size_t frames_;
  Chunk base_, chunk_;
  std::vector<Chunk> chunks_;
};

}  // namespace

std::vector<Chunk> SecondPassChunks(const ChunkProblem& problem) {
  Chunk lead;
  for (const int64_t p : problem.inputs) lead.push_back({SlotKind::kGiven, p});
  const auto leading = static_cast<int64_t>(lead.size());
  if (leading + 1 >= problem.frames) {
    throw UsageError("{} photos leave no room in chunks of {} frames; --seva-frames must be at least {}", leading,
                     problem.frames, leading + 2);
  }
  std::map<int64_t, std::vector<int64_t>> of_source;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    of_source[NearestByDistance(problem.targets[t], problem.sources)].push_back(static_cast<int64_t>(t));
  }
  Filler filler(problem, std::move(lead));
  for (const auto& [source, targets] : of_source) filler.Add(source, targets);
  return filler.Finish();
}

}  // namespace oraclegs::seva

#pragma once
// Choice of the frames that are denoised together (docs/method.md#seva-chunks).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/cameras.h"

namespace oraclegs::seva {

enum class SlotKind { kEmpty, kGiven, kTarget };

/// A place in a chunk. kGiven: a conditioning view; index into the sources, or, from their number on, a target that an
/// earlier chunk has generated. kTarget: index into the targets.
struct Slot {
  SlotKind kind = SlotKind::kEmpty;
  int64_t index = -1;

  bool operator==(const Slot&) const = default;
};
/// Slots of the frames that go through the network together; empty ones are at the end.
using Chunk = std::vector<Slot>;

struct ChunkProblem {
  std::vector<View> sources, targets;
  std::vector<int64_t> inputs;  ///< the sources that are real, ascending
  int64_t frames = 21;          ///< frames of a chunk
};

/// Plans chunks of the first pass such that every target is in exactly one ("gt-nearest"): all input images, then
/// targets in order; from the second chunk on also earlier targets that are near. Throws UsageError that names
/// --seva-frames when a chunk has too few frames.
std::vector<Chunk> FirstPassChunks(const ChunkProblem& problem);

/// Plans chunks of the second pass such that every target is in exactly one ("nearest-gt"): all input images, then
/// targets with their nearest source. Throws UsageError that names --seva-frames when a chunk has too few frames.
std::vector<Chunk> SecondPassChunks(const ChunkProblem& problem);

/// Fills empty slots with copies of the last given view when the last filled slot holds one, else of the last target.
Chunk Padded(const Chunk& chunk);

/// Index of the nearest source, by distance of centers or by rotation; the first of equals.
int64_t NearestByDistance(const View& view, const std::vector<View>& sources);
int64_t NearestByRotation(const View& view, const std::vector<View>& sources);

/// The `count` most frequent values, ascending; among equally frequent ones those seen first.
std::vector<int64_t> MostFrequent(const std::vector<int64_t>& values, size_t count);

}  // namespace oraclegs::seva

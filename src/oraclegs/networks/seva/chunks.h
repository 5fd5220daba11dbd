#pragma once
// Choice of the frames that are denoised together (docs/method.md#seva-chunks).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/cameras.h"
#include "oraclegs/networks/seva_options.h"

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

/// Sources that bound intervals of interp. kWithoutInputs: input images do not, since their order on the time line is
/// arbitrary.
enum class TimeLine { kAllSources, kWithoutInputs };

struct ChunkProblem {
  std::vector<View> sources, targets;
  std::vector<int64_t> inputs;                                 ///< the sources that are real, ascending
  int64_t frames = 21;                                         ///< frames of a chunk
  std::vector<double> source_orders = {}, target_orders = {};  ///< places on the time line, ascending; for interp
  TimeLine time_line = TimeLine::kAllSources;
};

/// Plans chunks such that every target is in exactly one:
///   gt                   all input images, then targets in order
///   gt-nearest, gt-ltr   from the second chunk on also earlier targets: near ones, or the last ones
///   nearest, nearest-gt  targets with their nearest source; -gt: all input images lead every chunk
///   interp, interp-gt    targets between the sources that bound them on the time line
/// Throws UsageError that names --seva-frames when a chunk has too few frames for the strategy.
std::vector<Chunk> PlanChunks(const ChunkProblem& problem, Chunking chunking);
Chunking ToChunking(FirstChunking chunking);

/// Fills empty slots with copies of the last given view when the last filled slot holds one, else of the last target.
Chunk Padded(const Chunk& chunk);

/// Index of the nearest source, by distance of centers or by rotation; the first of equals.
int64_t NearestByDistance(const View& view, const std::vector<View>& sources);
int64_t NearestByRotation(const View& view, const std::vector<View>& sources);

/// The `count` most frequent values, ascending; among equally frequent ones those seen first.
std::vector<int64_t> MostFrequent(const std::vector<int64_t>& values, size_t count);

/// Families of strategies.
enum class NearestBase { kNone, kInputs };
std::vector<Chunk> InputChunks(const ChunkProblem& problem);
enum class EarlierFrames { kNearest, kLast };
std::vector<Chunk> PseudoChunks(const ChunkProblem& problem, EarlierFrames earlier);
std::vector<Chunk> NearestChunks(const ChunkProblem& problem, NearestBase base);
std::vector<Chunk> IntervalChunks(const ChunkProblem& problem, NearestBase base);

}  // namespace oraclegs::seva

#pragma once
// Which frames are denoised together (docs/method.md#seva-chunks).

#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/networks/seva/cameras.h"

namespace oraclegs {

enum class SevaSlotKind { kEmpty, kGiven, kTarget };

/// A place in a chunk. kGiven: a conditioning view; index into the sources, or, from their number on, a target that an
/// earlier chunk has made. kTarget: index into the targets.
struct SevaSlot {
  SevaSlotKind kind = SevaSlotKind::kEmpty;
  int64_t index = -1;

  bool operator==(const SevaSlot&) const = default;
};
/// As many slots as frames go through the network together; empty ones at the end.
using SevaChunk = std::vector<SevaSlot>;

/// Photographs whose order on the time line of interp means nothing bound no intervals there.
enum class SevaTimeLine { kAllSources, kWithoutPhotographs };

struct ChunkProblem {
  std::vector<SevaView> sources, targets;
  std::vector<int64_t> photographs;                            ///< the sources that are real, ascending
  int64_t frames = 21;                                         ///< of a chunk
  std::vector<double> source_orders = {}, target_orders = {};  ///< places on the time line, ascending; for interp
  SevaTimeLine time_line = SevaTimeLine::kAllSources;
};

/// Every target is in exactly one chunk. strategy:
///   gt                   all photographs, then targets in order
///   gt-nearest, gt-ltr   with earlier targets, near ones or the last ones, from the second chunk on
///   nearest, nearest-gt  targets beside their nearest source; -gt: all photographs lead every chunk
///   nearest-K            blocks of targets behind the K sources that are nearest most often
///   interp, interp-gt    targets between the sources that bound them on the time line
/// Throws UsageError for another word, and when the frames of a chunk are too few for it, naming --seva-frames.
std::vector<SevaChunk> PlanChunks(const ChunkProblem& problem, const std::string& strategy);

/// Empty slots become copies: of the last given view when the last filled slot holds one, else of the last target.
SevaChunk Padded(const SevaChunk& chunk);

/// Index of the nearest of `sources`, by distance of centres or by rotation; the first of equals.
int64_t NearestByDistance(const SevaView& view, const std::vector<SevaView>& sources);
int64_t NearestByRotation(const SevaView& view, const std::vector<SevaView>& sources);

/// The `count` most frequent values, the first seen first among equals; ascending.
std::vector<int64_t> MostFrequent(const std::vector<int64_t>& values, size_t count);

/// The families of strategies.
enum class NearestBase { kNone, kPhotographs };
std::vector<SevaChunk> PhotographChunks(const ChunkProblem& problem);
enum class EarlierFrames { kNearest, kLast };
std::vector<SevaChunk> PseudoChunks(const ChunkProblem& problem, EarlierFrames earlier);
std::vector<SevaChunk> NearestChunks(const ChunkProblem& problem, NearestBase base);
std::vector<SevaChunk> NearestBlocks(const ChunkProblem& problem, int64_t count);
std::vector<SevaChunk> IntervalChunks(const ChunkProblem& problem, NearestBase base);

}  // namespace oraclegs

#pragma once
// Joint problems of a generation: one pass or two, the frames of each, and which of them are given
// (docs/method.md#seva-plan).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/chunks.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Number of frames that the first pass generates, and frames of a chunk in each pass.
struct PassSizes {
  int64_t anchors = 0, first_frames = 21, second_frames = 21;
};
struct PassRequest {
  int64_t inputs = 0, targets = 0;
  int64_t first_frames = 21, second_frames = 21;  ///< as asked for
  double anchor_ratio = 1;
};
/// `chunking` is the strategy of the second pass. Throws UsageError when interp-gt has no room for targets.
PassSizes SizePasses(const PassRequest& request, Chunking chunking);

enum class FrameSource { kInput, kAnchor, kTarget };

struct Frame {
  FrameSource source = FrameSource::kInput;
  int64_t index = 0;
  bool given = false;  ///< its image conditions; false = it is generated
  bool copy = false;   ///< fills an empty slot; its result is discarded

  bool operator==(const Frame&) const = default;
};

struct Job {
  int pass = 1;  ///< 1 generates anchors, 2 targets
  std::vector<Frame> frames;
};

struct Plan {
  std::vector<View> anchors;
  std::vector<Job> jobs;    ///< in this order: a job may need results of an earlier one
  int64_t largest() const;  ///< frames of the largest job
};

/// Needs at least one input image (ShapeError). interp treats the targets as a path in their order and takes its
/// anchors from it; the other strategies have theirs on an orbit. Throws UsageError that names the options that do not
/// fit.
Plan MakePlan(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options);

}  // namespace oraclegs::seva

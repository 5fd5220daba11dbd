#pragma once
// Joint problems of a generation: the two passes, the frames of each, and which of them are given
// (docs/method.md#seva-plan).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/chunks.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Number of frames that the first pass generates, and frames of a chunk in it.
struct PassSizes {
  int64_t anchors = 0, first_frames = 21;
};
/// `frames`: those of a chunk, as asked for.
PassSizes SizePasses(int64_t inputs, int64_t frames);

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

/// Needs at least one input image (ShapeError). The anchors lie on an orbit. Throws UsageError that names the options
/// that do not fit.
Plan MakePlan(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options);

}  // namespace oraclegs::seva

#pragma once
// The joint problems that make up a generation: one pass or two, which frames together, which of them are given
// (docs/method.md#seva-plan).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/chunks.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// How many frames the first pass makes, and how many frames the chunks of each pass have.
struct PassSizes {
  int64_t anchors = 0, first_frames = 21, second_frames = 21;
};
struct PassRequest {
  int64_t inputs = 0, targets = 0;
  int64_t first_frames = 21, second_frames = 21;  ///< as asked for
  double anchor_ratio = 1;
};
/// `chunking` is the second pass's strategy. Throws UsageError when interp-gt has no room for targets.
PassSizes SizePasses(const PassRequest& request, Chunking chunking);

enum class FrameSource { kInput, kAnchor, kTarget };

struct Frame {
  FrameSource source = FrameSource::kInput;
  int64_t index = 0;
  bool given = false;  ///< its image conditions; false: it is made
  bool copy = false;   ///< fills a place; what is made of it is thrown away

  bool operator==(const Frame&) const = default;
};

struct Job {
  int pass = 1;  ///< 1 makes anchors, 2 targets
  std::vector<Frame> frames;
};

struct Plan {
  std::vector<View> anchors;
  std::vector<Job> jobs;    ///< in this order: a job may need what an earlier one made
  int64_t largest() const;  ///< frames of the largest job
};

/// At least one input image (ShapeError). interp takes the targets for a path in their order, and its anchors from it;
/// the other strategies have theirs on an orbit. Throws UsageError for options that do not fit, naming them.
Plan MakePlan(const std::vector<View>& inputs, const std::vector<View>& targets, const SevaOptions& options);

}  // namespace oraclegs::seva

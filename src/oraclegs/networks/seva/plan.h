#pragma once
// Joint problems of a generation: the two passes, the frames of each, and which of them are given
// (docs/method.md#seva-plan), cameras on an orbit among them (#seva-trajectories).

#include <cstdint>
#include <vector>

#include "oraclegs/networks/seva/cameras.h"
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

/// Point nearest to all optical axes (least squares); of the line of such points that parallel axes have, the one
/// nearest to the mean of the centers. Throws ShapeError without views.
Eigen::Vector3d LookAtPoint(const std::vector<View>& views);

/// Up direction: minus the mean of the cameras' y axes, of unit length.
Eigen::Vector3d UpOf(const std::vector<View>& views);

/// `count` poses evenly on the full circle around the axis `up` through `center`, from `start` on; each looks at
/// `center`, also the first.
std::vector<Eigen::Isometry3d> Orbit(const Eigen::Vector3d& start, const Eigen::Vector3d& center,
                                     const Eigen::Vector3d& up, int64_t count);

/// Frames of a first pass: `count` poses on an orbit around the point that input images and targets look at. The orbit
/// starts at the first input image, whose own place is left out. Intrinsics are the first target's, or without targets
/// the first input image's.
std::vector<View> OrbitAnchors(const std::vector<View>& inputs, const std::vector<View>& targets, int64_t count);

}  // namespace oraclegs::seva

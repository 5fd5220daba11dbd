#pragma once
// Poses that may be a target: no test pose, no training pose, not inside geometry, not into the void.

#include <cstdint>
#include <utility>
#include <vector>

#include "oraclegs/depth/fusion.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Scene and settings for the choice of targets.
struct TrajectoryRequest {
  std::vector<Camera> train;  ///< at least one; generated targets have the intrinsics of the first
  std::vector<Camera> test;   ///< never a target
  std::vector<Target> spare;  ///< posed views that are neither, named like their image ("left/0001.jpg")
  const std::vector<DepthMap>* maps = nullptr;      ///< depth maps of the training views
  const std::vector<DensePoint>* points = nullptr;  ///< points on surfaces
  uint64_t seed = 0;
  bool sees_anything = false;  ///< accepts poses that see next to nothing of the points: for generators
};

/// Distance below which two centers are the same place: a thousandth of the mean distance from a training camera to the
/// nearest other one. More than rounding, also for one camera.
double SamePlace(const std::vector<Camera>& train);

/// Set of poses. Two poses are equal when their centers are within `same_place` and their rotations within 0.1 degrees.
class PoseSet {
 public:
  PoseSet(std::vector<Camera> cameras, double same_place) : cameras_(std::move(cameras)), same_place_(same_place) {}
  bool Has(const Camera& camera) const;
  void Add(const Camera& camera) { cameras_.push_back(camera); }

 private:
  std::vector<Camera> cameras_;
  double same_place_;
};

/// At most `budget` of the points, evenly by index.
std::vector<DensePoint> EvenSample(const std::vector<DensePoint>& points, size_t budget);

/// Indices of the points that project into the image, face the camera (where the normal is known) and are not behind
/// others: more than a fifth farther than the nearest in the same cell of 48 x 48. Ascending.
std::vector<int> PointsSeen(const std::vector<DensePoint>& points, const Camera& camera);

enum class Verdict { kGood, kTestPose, kKnownPose, kInsideGeometry, kSeesNothing };

class TargetCheck {
 public:
  explicit TargetCheck(const TrajectoryRequest& request);

  /// Verdict on a pose, the first of these that applies:
  ///   kTestPose        a test pose (PoseSet)
  ///   kKnownPose       a training pose
  ///   kInsideGeometry  five points or more lie nearer than a quarter of the smallest median depth of a training
  ///                    camera, and nearer than to any training camera; never a spare pose where the request's
  ///                    sees_anything, for a real camera stood there
  ///   kSeesNothing     points fall on less than a tenth of a 16 x 16 grid over the image, and on less than half of
  ///                    the training cameras' median share; never where the request's sees_anything
  /// The last two need at least 100 points.
  Verdict Classify(const Camera& camera) const;

  /// At most 20000 of the request's points; none when it has fewer than 100.
  const std::vector<DensePoint>& points() const { return points_; }
  double same_place() const { return same_place_; }

 private:
  bool IsInsideGeometry(const Camera& camera) const;

  double same_place_;
  PoseSet test_, train_, real_;  ///< real_: poses of real cameras, exempt where sees_anything is set
  std::vector<DensePoint> points_;
  double nearest_ = 0;    ///< world units; nearer geometry means that the camera is inside it
  double min_share_ = 0;  ///< least fraction of the grid; 0 = any
};

}  // namespace oraclegs

#pragma once
// The frame of a scene: which way is up, where its center is, how long a unit is.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/core/options.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// The coordinates that a run with given poses computes in.
enum class FrameKind { kNormal, kScene };
template <>
struct EnumWords<FrameKind> {
  static constexpr EnumWord<FrameKind> kWords[] = {{FrameKind::kNormal, "normal"}, {FrameKind::kScene, "scene"}};
};

/// Where a run computes: x_run = scale * (rotation * x_scene - center). Results of poses that were found are written in
/// the run's coordinates; results of poses that came with the scene in the scene's own, less an offset.
struct SceneFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< after the rotation, in the scene's units
  double scale = 1;
  bool is_level = false;                             ///< up is -y and the center is at the origin
  bool is_given = false;                             ///< the poses came with the scene; then nothing is rotated
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< scene's units; what 32-bit floats could not carry (is_given)
  std::optional<double> unit_meters = {};            ///< length of a unit of what is written; nothing = nobody knows
};

/// The frame of a scene that brought its poses: `views` (indices, with poses) look at its origin, from a median
/// distance of 4 units. Rotations stay. Positions times a power of two give the same run, bit by bit. The offset is 0
/// unless the scene lies more than 1000 times that distance from its origin, where floats would be coarser than a
/// pixel.
SceneFrame NormalFrame(const Scene& scene, const std::vector<int>& views);

/// Explains why a run in the scene's own units cannot be right; "" where `frame`, its NormalFrame, is near enough to
/// them for the near plane (0.2 units) and for 32-bit floats.
std::string WhyUnitsDoNotFit(const SceneFrame& frame);

/// The run's coordinates from the scene's own where poses came with it; the identity where they were found.
Similarity RunFromScene(const SceneFrame& frame);

/// The coordinates that models, meshes and depth are written in, from those of the run.
Similarity WrittenFromRun(const SceneFrame& frame);

/// The level frame of a scene with poses: up becomes -y (down is y, as in a camera that is held level; splat viewers
/// expect it), and the point that the cameras look at becomes the origin. Up is upright to the images' horizontal
/// sides, however far the cameras look down; where they all look the same way, so that this is open, GPS says it
/// (UpByGps), or else their mean up. The normal of the plane that most points lie near replaces it where the two are
/// within 15 degrees. Nothing is turned about the vertical. A unit becomes a quarter of the cameras' median distance
/// from the center, the size of scene that the constants of 3DGS were chosen for. Equal scenes give equal bits.
SceneFrame LevelFrame(const Scene& scene);

/// Throws UsageError unless --scale is "", a number above 0, or names two photos and a length above 0 (UnitMeters).
void CheckScale(const std::string& text);
/// Checks --scale before poses are known; also throws InputError for a photo that does not exist.
void CheckScale(const Scene& scene, const std::string& text);

/// How many meters a unit of the scene has, by --scale: a number says it; "A,B=0.35" says that the cameras of the views
/// A and B are 0.35 m apart; "" says nothing. Throws UsageError for any other text, and for a number when units are
/// `arbitrary`, as registration leaves them; InputError for a view that does not exist or two that stand at one place.
std::optional<double> UnitMeters(const Scene& scene, const std::string& text, bool arbitrary);

/// Moves cameras and points; the bits of a scene stay as they are where nothing is to be moved.
void ApplyFrame(const SceneFrame& frame, Scene* scene);

/// A scene with poses, in its frame, and which of its views train and test.
struct PosedScene {
  Scene scene;
  Split split;
  SceneFrame frame = {};
};

}  // namespace oraclegs

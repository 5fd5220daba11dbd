#pragma once
// The frame of a scene: which way is up, where its center is, how long a unit is.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// x_new = scale * (rotation * x - center).
struct SceneFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< after the rotation, in old units
  double scale = 1;
  bool is_level = false;                   ///< up is -y and the center is at the origin
  std::optional<double> unit_meters = {};  ///< length of a new unit; nothing = nobody knows
};

/// Of a scene with poses: up becomes -y (down is y, as in a camera that is held level; splat viewers expect it), and
/// the point that the cameras look at becomes the origin. Up is upright to the images' horizontal sides, however far
/// the cameras look down; where they all look the same way, so that this is open, GPS says it (UpByGps), or else their
/// mean up. The normal of
/// the plane that most points lie near replaces it where the two are within 15 degrees. Nothing is turned about the
/// vertical. A unit becomes a quarter of the cameras' median distance from the center, the size of scene that the
/// constants of 3DGS were chosen for. The same scene gives the same bits.
SceneFrame LevelFrame(const Scene& scene);

/// Throws UsageError unless --scale is "", a number above 0, or names two photos and a length above 0 (UnitMeters).
void CheckScale(const std::string& text);
/// The same before poses are known; also throws InputError for a photo that does not exist.
void CheckScale(const Scene& scene, const std::string& text);

/// How many meters a unit of the scene has, by --scale: a number says it; "A,B=0.35" says that the cameras of the views
/// A and B are 0.35 m apart; "" says nothing. Throws UsageError for any other text, and for a number when units are
/// `arbitrary`, as registration leaves them; InputError for a view that does not exist or two that stand at one place.
std::optional<double> UnitMeters(const Scene& scene, const std::string& text, bool arbitrary);

/// Moves cameras and points; the bits of a scene stay as they are where nothing is to be moved.
void ApplyFrame(const SceneFrame& frame, Scene* scene);

/// Lines for the header of a splat.
std::vector<std::string> FrameComments(const SceneFrame& frame);

/// The length of a unit, as FrameComments wrote it among others.
std::optional<double> UnitMetersOf(const std::vector<std::string>& comments);

/// The comments with another length of a unit, or none.
std::vector<std::string> WithUnit(const std::vector<std::string>& comments, std::optional<double> unit_meters);

/// The comments of a model that was turned: it is level no more.
std::vector<std::string> WithoutLevel(std::vector<std::string> comments);

}  // namespace oraclegs

#pragma once
// The frame of a scene: which way is up, where its center is, how long a unit is.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// x_new = scale * (rotation * x - center).
struct SceneFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< after the rotation, in old units
  double scale = 1;
  bool is_level = false;   ///< up is -y and the center is at the origin
  bool is_metric = false;  ///< a unit is a meter
};

/// Of a scene with poses: up becomes -y (down is y, as in a camera that is held level; splat viewers expect it), and
/// the point that the cameras look at becomes the origin. Up is upright to the images' horizontal sides, however far
/// the cameras look down; where they all look the same way, so that this is open, it is their mean up. The normal of
/// the plane that most points lie near replaces it where the two are within 15 degrees. Nothing is turned about the
/// vertical. The same scene gives the same bits.
SceneFrame LevelFrame(const Scene& scene);

/// Reads what --scale asks for: "" = 1; a number above 0 = that factor; "A,B=0.35" = the cameras of the views A and B
/// are 0.35 m apart, which makes units meters. Throws InputError for a view that does not exist or two that stand at
/// one place, UsageError for any other text.
struct SceneScale {
  double factor = 1;
  bool is_metric = false;
};
SceneScale ReadScale(const Scene& scene, const std::string& text);

/// Moves cameras and points; the bits of a scene stay as they are where nothing is to be moved.
void ApplyFrame(const SceneFrame& frame, Scene* scene);

/// Lines for the header of a splat.
std::vector<std::string> FrameComments(const SceneFrame& frame);

}  // namespace oraclegs

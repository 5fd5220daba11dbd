#pragma once
// The usual mistakes in poses that do not fit the photos, each tried by one score.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/sfm/match_fit.h"

namespace oraclegs {

/// One way to read the given cameras otherwise.
struct CameraChange {
  /// Turns a ray as the poses have it into that of the photo; a signed permutation.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  bool inverse = false;              ///< the matrices map the other way
  double focal_factor = 1;           ///< on the focal lengths
  bool is_other_resolution = false;  ///< the factor is on the principal point, too
  bool is_of_pixels = false;         ///< the photos were turned or mirrored: their principal points with them
  /// Where the inverted matrices have their origin, in the coordinates of the poses: a frame may have moved these
  /// since.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// How well the matches fit after such a change.
struct ChangeFit {
  CameraChange change;
  double share = 0;  ///< fraction of the matches that fit
};

/// Cameras and the matches between their photos.
struct GivenCameras {
  std::vector<Intrinsics> intrinsics;
  std::vector<Eigen::Isometry3d> cams_from_world;
  std::vector<ViewPair> pairs;
  double limit = 0;                                  ///< pixels (of kReferenceSide) within which a match fits
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< that of the given matrices, in the coordinates of the poses
};

/// The given poses as they are after a change of axes or direction.
std::vector<Eigen::Isometry3d> Changed(const std::vector<Eigen::Isometry3d>& cams_from_world,
                                       const CameraChange& change);
Intrinsics Changed(const Intrinsics& intrinsics, const CameraChange& change);

/// The share of the matches that fit the cameras.
double FittingShare(const std::vector<RayPair>& pairs, const std::vector<Eigen::Isometry3d>& cams_from_world,
                    double limit);

/// The best of all changes of axes and direction: turned, mirrored or renamed axes (48), as they are or inverted. The
/// most usual one wins among those that fit alike.
ChangeFit BestAxes(const GivenCameras& given);

/// The best factor of the focal length (1/4 to 4), alone or together with the principal point.
ChangeFit BestFocal(const GivenCameras& given);

/// Views whose photos stand upside down, though the others do not.
struct TurnedViews {
  std::vector<int> views;  ///< positions in `given`, ascending
  double share = 0;        ///< fraction of all matches that fit once these are turned
};

/// The views of which hardly a match fits, and most do once the photo is turned by 180 degrees.
TurnedViews FindTurnedViews(const GivenCameras& given);

}  // namespace oraclegs

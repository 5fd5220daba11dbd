#pragma once
// The CSV of RealityScan (RealityCapture) that is exported as "Internal/External camera parameters":
//   #name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2
// Angles are degrees, with z up: heading clockwise about z, then pitch about x, then roll about y, of a camera that
// looks straight down with its right side to x. f is millimeters for a photo that is 36 mm long, px and py are the
// principal point's distance from the middle as a share of the longer side.

#include <Eigen/Core>
#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with such a file.
bool IsRealityScanScene(const std::filesystem::path& root);

/// Reads the first such file with the photos that it names. Throws InputError naming the file and the line.
Scene ReadRealityScanScene(const std::filesystem::path& root, const SceneReadOptions& options,
                           const Listener& listener);

/// Rotation from the world to a camera (x right, y down, z forward) by its angles in degrees.
Eigen::Matrix3d RotationOfAngles(double heading, double pitch, double roll);

}  // namespace oraclegs

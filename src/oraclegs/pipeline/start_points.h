#pragma once

#include <string>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/pipeline/run.h"

namespace oraclegs {

/// Fewer points than this are no start for training.
inline constexpr size_t kEnoughPoints = 100;

/// Fewer than this are joined by random points: growth of 5 % at a time would not reach a useful number of Gaussians
/// (lego, 8 views: 170 points alone end at 2 000 Gaussians and 20.2 dB, a random start at 22.5 dB).
inline constexpr size_t kPlentyOfPoints = 1000;

struct StartPoints {
  PointCloud cloud;
  std::string source;  ///< "sfm" (points of the training views), "random", or "sfm+random"
};

/// Stage "sfm": where the Gaussians start. A COLMAP model's points count when the training views saw them; otherwise,
/// or when they are too few, points are triangulated from the training views (cached in sfm/). With --init auto fewer
/// than 100 points, or no colmap program, end in a warning and random points inside the volume that the training
/// cameras look at (the Blender cube for Blender scenes); fewer than kPlentyOfPoints are joined by such points. At most
/// --max-gaussians points, picked evenly. Throws InputError when --init sfm finds none to start from.
StartPoints RunSfm(Run* run);

}  // namespace oraclegs

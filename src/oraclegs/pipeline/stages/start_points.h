#pragma once

#include <string>
#include <vector>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/pipeline/run.h"

namespace oraclegs {

/// Fewer points than this are no start for training.
inline constexpr size_t kEnoughPoints = 100;

/// Fewer than this are joined by random points: growth of 5 % at a time would not reach a useful number of Gaussians
/// (lego, 8 views: 170 points alone end at 2 000 Gaussians and 20.2 dB, a random start at 22.5 dB).
inline constexpr size_t kPlentyOfPoints = 1000;

/// Stage "sfm": sparse points of the training views, with indices of run->scene. A COLMAP model's points count when the
/// training views saw them; otherwise, or when they are too few, points are triangulated from the training views
/// (cached in sfm/). None when no other stage would use them.
std::vector<ScenePoint> RunSfm(Run* run);

/// True when a stage after "sfm" needs depth: a dense start, depth in the loss, or proposals; false for --depth-prior
/// none.
bool NeedsDepth(const RunOptions& options);

/// Start scale of dense points and of others, as a factor of the distance to the neighbours ([3DGS]'s and [MCMC]'s).
inline constexpr double kDenseScale = 1, kSparseScale = 0.1;

/// With normals.
PointCloud ToPointCloud(const std::vector<DensePoint>& points);

/// A dense start of at most `budget` points: those of the geometry; unless --init-planes says no, what continues them
/// where stereo found nothing (depth/plane_fill.h); and what a network guesses in the rest (prior_points.h). `photos`
/// belong to `geometry.maps`. Nothing when stereo found nothing.
PointCloud DenseStart(const StartOptions& options, const std::vector<LoadedView>& photos, const Geometry& geometry,
                      size_t budget);

struct StartPoints {
  PointCloud cloud;
  std::string source;  ///< of "dense", "sfm" and "random" those that took part, joined by "+"
};

/// Where the Gaussians start, remembered as stage "start". --init says from what; auto takes the dense points where
/// stereo found plenty, else the sparse points, joined by random ones where they are few, or with a warning random ones
/// alone. Random points fill the volume that the training cameras look at (the Blender cube for Blender scenes). At
/// most
/// --max-gaussians points. Throws InputError when --init names points of which there are none.
StartPoints ChooseStart(Run* run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& sfm,
                        const Geometry& geometry);

}  // namespace oraclegs

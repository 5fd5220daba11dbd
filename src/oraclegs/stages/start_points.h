#pragma once

#include <string>
#include <vector>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Fewer than this are joined by random points: growth of 5 % at a time would not reach a useful number of Gaussians
/// (lego, 8 views: 170 points alone end at 2 000 Gaussians and 20.2 dB, a random start at 22.5 dB).
inline constexpr size_t kMinPointsForStart = 1000;

/// Start scale of dense points and of others, as a factor of the distance to the neighbors (those of [Kerbl 2023] and
/// [Kheradmand 2024]).
inline constexpr double kDenseScale = 1, kSparseScale = 0.1;

PointCloud ToPointCloud(const std::vector<DensePoint>& points);

/// A dense start of at most `budget` points: those of the geometry; unless --set init-planes=false, what extrapolates
/// their planes where stereo found nothing (depth/plane_fill.h); and what a network predicts in the rest
/// (prior_points.h). `views` belong to `geometry.maps`. Nothing when stereo found nothing.
PointCloud DenseStart(const StartOptions& options, const std::vector<LoadedView>& views, const Geometry& geometry,
                      size_t budget);

struct StartPoints {
  PointCloud cloud;
  std::string source;  ///< those of "dense", "sfm" and "random" that took part, joined by "+"
};

/// Points and views that a start is chosen from.
struct StartEvidence {
  const std::vector<LoadedView>& views;  ///< training views
  const std::vector<ScenePoint>& sfm;
  const Geometry& geometry;
};

/// Where the Gaussians start, recorded as "start". --init says from what; auto takes the dense points where stereo
/// found plenty, else the sparse points, joined by random ones where they are few, or with a warning random ones alone.
/// Random points fill the volume that the training cameras look at (the Blender cube for Blender scenes). At most
/// --max-gaussians points. Throws InputError when --init names points of which there are none.
StartPoints ChooseStart(Run* run, const StartEvidence& known);

/// --set init-scale=auto becomes `usual_scale`.
InitializeOptions InitializeOptionsOf(const StartOptions& options, double usual_scale);

}  // namespace oraclegs

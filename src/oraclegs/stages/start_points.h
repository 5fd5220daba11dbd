#pragma once

#include <string>
#include <vector>

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

PointCloud ToPointCloud(const std::vector<DensePoint>& points);

/// A dense start of at most `budget` points: those of the geometry; unless --set init-planes=false, what extrapolates
/// their planes where stereo found nothing (depth/fusion.h); and what a network predicts in the rest
/// (there, too). `views` belong to `geometry.maps`. Nothing when stereo found nothing.
PointCloud DenseStart(const StartOptions& options, const std::vector<LoadedView>& views, const Geometry& geometry,
                      size_t budget);

struct StartPoints {
  PointCloud cloud;
  std::string source;  ///< those of "dense", "sfm" and "random" that took part, joined by "+"; or "file"
};

/// Points and views that a start is chosen from.
struct StartEvidence {
  const std::vector<LoadedView>& views;  ///< training views
  const std::vector<ScenePoint>& sfm;
  const Geometry& geometry;
};

/// Where the Gaussians start, recorded as "start": from what SettleStart says for --init, or the points of --set
/// init-points. Random points fill the volume that the training cameras look at (the Blender cube for Blender scenes).
/// At most --max-gaussians points. Throws InputError when --init names points of which there are none.
StartPoints ChooseStart(Run* run, const StartEvidence& known);

}  // namespace oraclegs

#pragma once
// Multi-view stereo of a run's training views.

#include <vector>

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// The sparse points; their views are indices of the training views.
std::vector<ScenePoint> SeenByTrainingViews(const Run& run);

/// Depth maps of the training views, from stereo alone. `stage` is the one whose progress is reported.
std::vector<DepthMap> StereoOf(const Run& run, const std::vector<LoadedView>& views, const char* stage);

/// The share of confident pixels in the depth map of each view, from small copies of the images. Takes about a second
/// an image on two cores. Throws Interrupted, InputError for an image that cannot be read, and the errors of
/// MakePlaneSearch.
std::vector<double> ConfirmedDepth(Scene model, Device device);

}  // namespace oraclegs

#pragma once
// Size of a run where the user leaves it open: pixels, Gaussians, iterations, and the proposers. It follows from
// --quality, the photos and the device and is settled once, before registration; a run that is continued keeps it.

#include <nlohmann/json_fwd.hpp>

#include "oraclegs/scene/scene.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Facts about a scene that are known before registration.
struct SceneSize {
  int views = 0;           ///< number of training views when all photos find their poses
  PixelSize largest = {};  ///< largest image, before any resizing
};

/// training_views: their number, where the split is known or will not reject any.
SceneSize SizeOf(const Scene& scene, int training_views);

/// The machine that trains.
struct TrainingMachine {
  bool is_gpu = false;
  int64_t free_bytes = 0;  ///< free memory of the GPU; 0 = unknown
};

/// Options with a size for everything automatic. Where a GPU has less memory than the training takes (GpuBytes), there
/// are fewer Gaussians, down to 100 000, and then smaller images.
RunOptions WithSize(RunOptions options, const SceneSize& scene, const TrainingMachine& machine);

/// Bytes of a GPU that the run takes at most, about: Gaussians, images, and the work on one view.
int64_t GpuBytes(const RunOptions& settled, const SceneSize& scene);

/// Sizes for experiments, whose runs compare with published ones and with each other. Where nothing else is asked for:
/// full size, 7000 iterations, 100 000 Gaussians, proxy models, and every 8th view for testing.
RunOptions WithUsualSizes(RunOptions options);

/// {"max-size": 1000, ...}: the sizes that WithSize settled, for options.json.
nlohmann::json SizeToJson(const RunOptions& settled);

/// Replaces automatic options with the values of SizeToJson's object; options that it lacks stay automatic.
RunOptions WithSavedSize(RunOptions options, const nlohmann::json& size);

/// Options with the background that the photos ask for, where nothing chose one: white where they show something before
/// plain white (AreOnWhite), else black, as where masks hide what is around it.
RunOptions WithBackground(RunOptions options, const Scene& scene);

/// --frames of a run that is continued with this size, or starts where it is null.
int SettleFrames(const RunOptions& options, const nlohmann::json& saved_size);

/// One line for the user: "4000x3000 photos are used at 1000x750; 7000 iterations, at most 100000 Gaussians (--quality
/// normal)". "" where the user has set everything.
std::string DescribeSize(const RunOptions& asked, const RunOptions& settled, const SceneSize& scene);

}  // namespace oraclegs

#pragma once
// How large a run is where the user leaves that open: pixels, Gaussians, iterations, and what proposes. From --quality,
// the photos and the device, settled once, before registration; a run that is continued keeps it.

#include <nlohmann/json_fwd.hpp>

#include "oraclegs/scene/scene.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// What is known before registration.
struct SceneSize {
  int views = 0;           ///< that will train, when all photos find their poses
  PixelSize largest = {};  ///< the largest image, as it came
};

/// training_views: their number, where the split is known or will not reject any.
SceneSize SizeOf(const Scene& scene, int training_views);

/// The options with nothing of it left automatic. on_gpu: the device that trains.
RunOptions WithSize(RunOptions options, const SceneSize& scene, bool on_gpu);

/// The same for experiments, whose runs compare with published ones and with each other: full size, 7000 iterations,
/// 100 000 Gaussians, proxy models, and every 8th view for testing, where nothing else is asked for.
RunOptions WithUsualSizes(RunOptions options);

/// {"max-size": 1000, ...}: what WithSize settled, for options.json.
nlohmann::json SizeToJson(const RunOptions& settled);

/// The options with what is automatic taken from SizeToJson's object; what that lacks stays automatic.
RunOptions WithSavedSize(RunOptions options, const nlohmann::json& size);

/// One line for the user: "4000x3000 photos are used at 1000x750; 7000 iterations, at most 100000 Gaussians
/// (--quality normal)". "" where the user has set all of it.
std::string DescribeSize(const RunOptions& asked, const RunOptions& settled, const SceneSize& scene);

}  // namespace oraclegs

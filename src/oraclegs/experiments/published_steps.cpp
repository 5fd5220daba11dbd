#include "oraclegs/experiments/published_steps.h"

#include <algorithm>
#include <iterator>

namespace oraclegs {
namespace {

const char* const kScenes[] = {"bicycle", "bonsai", "counter", "garden", "kitchen", "room", "stump"};

}  // namespace

std::vector<PublishedStep> PublishedSteps(int views) {
  if (views == 12) {
    return {{"mcmc", "14.10", 0.285, 0.560},      {"union", "16.72", 0.382, 0.596}, {"schedule", "17.32", 0.433, 0.515},
            {"lpips", "17.60", 0.446, 0.459},     {"sfm", "19.96", 0.583, 0.362},   {"depth", "20.28", 0.592, 0.354},
            {"confidence", "20.32", 0.596, 0.350}};
  }
  if (views == 24) {
    return {{"mcmc", "17.95", 0.479, 0.409},      {"union", "16.88", 0.428, 0.565},
            {"schedule", "29.85*", 0.585, 0.362}, {"lpips", "21.34", 0.598, 0.328},
            {"sfm", "22.88", 0.691, 0.284},       {"depth", "23.64", 0.717, 0.258},
            {"confidence", "23.72", 0.723, 0.244}};
  }
  return {};
}

int ViewsOfPublishedSteps(const std::string& scene, const RunOptions& options) {
  if (std::find(std::begin(kScenes), std::end(kScenes), scene) == std::end(kScenes)) return 0;
  const bool is_split_alike = options.split.test_every == 8 && options.split.train_views.empty() &&
                              options.split.test_views.empty() && options.split.view_steps == ViewSteps::kTruncate;
  const bool is_sized_alike = options.image.downscale == 4 && options.image.smaller_copies == SmallerCopies::kRequired;
  const int views = options.split.views;
  return is_split_alike && is_sized_alike && !PublishedSteps(views).empty() ? views : 0;
}

bool AreScenesOfPublishedSteps(std::vector<std::string> scenes) {
  std::sort(scenes.begin(), scenes.end());
  return std::equal(scenes.begin(), scenes.end(), std::begin(kScenes), std::end(kScenes));
}

}  // namespace oraclegs

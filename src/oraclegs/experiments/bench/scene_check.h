#pragma once
// Checks that a scene on disk fits a suite's protocol, before anything is run.

#include <string>
#include <vector>

#include "oraclegs/experiments/bench/suites.h"

namespace oraclegs {

/// Result for a scene with a number of training views.
struct SceneCheck {
  SuiteScene scene;
  int views = 0;
  std::string problem = {};                        ///< one line that names the folder and the fault; "" = it fits
  std::vector<std::string> train = {}, test = {};  ///< names of the images that the protocol uses
  int width = 0, height = 0;                       ///< size of an image as scored, pixels; 0 = known after registration
};

/// One check for each of `views`. `asked` are the user's options, which win over the protocol's; where they change it
/// (KeepsProtocol), the size is not checked.
std::vector<SceneCheck> CheckScene(const Suite& suite, const SuiteScene& scene, const std::vector<int>& views,
                                   const RunArguments& asked);

/// A line or two for each check: images and resolution, or the problem.
std::string CheckText(const std::vector<SceneCheck>& checks);

/// "LPIPS by VGG16 of images in [0, 1], with vgg.safetensors"; without weights it says how to get them.
std::string LpipsText(const RunArguments& asked);

}  // namespace oraclegs

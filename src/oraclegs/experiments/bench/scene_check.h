#pragma once
// Whether a scene on disk is what a suite's protocol is about, before anything is run.

#include <string>
#include <vector>

#include "oraclegs/experiments/bench/suites.h"

namespace oraclegs {

/// A scene with a number of training views.
struct SceneCheck {
  SuiteScene scene;
  int views = 0;
  std::string problem = {};                        ///< one line that names the folder and what is wrong; "" = it fits
  std::vector<std::string> train = {}, test = {};  ///< names of the images that the protocol takes
  int width = 0, height = 0;  ///< of an image as it is scored, pixels; 0 = known after registration
};

/// One for each of `views`. `asked` are the options of the user, over the protocol's; where these change it
/// (KeepsProtocol), the size is not checked.
std::vector<SceneCheck> CheckScene(const Suite& suite, const SuiteScene& scene, const std::vector<int>& views,
                                   const RunArguments& asked);

/// A line or two for each: images and resolution, or the problem.
std::string CheckText(const std::vector<SceneCheck>& checks);

/// "LPIPS by VGG16 of images in [0, 1], with vgg.safetensors", or that and how it becomes measured.
std::string LpipsText(const RunArguments& asked);

}  // namespace oraclegs

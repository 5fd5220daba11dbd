#pragma once
// The rasteriser's fixture as inputs of the program. Sizes come from the file.

#include <algorithm>

#include "oraclegs/render/render.h"
#include "support/tensors.h"

namespace oraclegs {

struct GoldenScene {
  SafetensorsFile file = OpenGolden("rasterize");
  Gaussians gaussians;
  Camera camera;
  RenderOptions options;
  RenderGrads upstream;
  Buffer<float> visible;  ///< bool [N]: contributes to some pixel

  GoldenScene() {
    gaussians = {GoldenFloat(file, "means"), GoldenFloat(file, "log_scales"), GoldenFloat(file, "quats"),
                 GoldenFloat(file, "opacity_logits"), GoldenFloat(file, "sh")};
    camera.width = std::stoi(file.metadata().at("width"));
    camera.height = std::stoi(file.metadata().at("height"));
    const auto k = file.Values<double>("K");
    camera.fx = k[0], camera.cx = k[2], camera.fy = k[4], camera.cy = k[5];
    const auto view = file.Values<double>("viewmat");
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) camera.cam_from_world.linear()(i, j) = view[4 * i + j];
      camera.cam_from_world.translation()[i] = view[4 * i + 3];
    }
    const auto background = file.Values<float>("background");
    std::copy_n(background.begin(), 3, options.background.begin());
    upstream = {GoldenFloat(file, "upstream_image"), GoldenFloat(file, "upstream_alpha"),
                GoldenFloat(file, "upstream_inv_depth")};
    visible = GoldenTensor(file, "visible").to(torch::kBool);
  }

  /// "sh3", "sh0" or "aa".
  void Select(const std::string& variant) {
    options.sh_degree = variant == "sh0" ? 0 : std::stoi(file.metadata().at("sh_degree_stored"));
    options.antialiased = variant == "aa";
  }
};

}  // namespace oraclegs

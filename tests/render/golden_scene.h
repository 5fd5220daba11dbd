#pragma once
// The rasterizer's reference numbers (docs/method.md#tolerances) as inputs of the program. Sizes come from the file.

#include <gtest/gtest.h>

#include <algorithm>

#include "oraclegs/render/render.h"
#include "support/buffers.h"

namespace oraclegs {

struct GoldenScene {
  SafetensorsFile file = OpenGolden("rasterize");
  Gaussians gaussians;
  Camera camera;
  RenderOptions options;
  RenderGrads upstream;
  std::vector<uint8_t> visible;  ///< [N]: contributes to some pixel

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
    visible = file.Values<uint8_t>("visible");
  }

  /// Name of the case: "sh3", "sh0" or "aa".
  void Select(const std::string& variant) {
    options.sh_degree = variant == "sh0" ? 0 : std::stoi(file.metadata().at("sh_degree_stored"));
    options.antialiased = variant == "aa";
  }

  /// Expects for each row: |error| <= 0.02 (|reference| + 0.01 median |reference| over the visible Gaussians).
  void ExpectRowsAgree(const Buffer<float>& x, const Buffer<double>& reference, const std::string& what) const {
    const Eigen::ArrayXd norm = Table(reference).rowwise().norm();
    const Eigen::ArrayXd error = (Table(x).cast<double>() - Table(reference)).rowwise().norm();
    std::vector<double> seen;
    for (int64_t i = 0; i < norm.size(); ++i) {
      if (visible[static_cast<size_t>(i)]) seen.push_back(norm[i]);
    }
    std::nth_element(seen.begin(), seen.begin() + (seen.size() - 1) / 2, seen.end());
    const double median = seen[(seen.size() - 1) / 2];
    Eigen::Index worst = 0;
    EXPECT_LE((error / (0.02 * (norm + 0.01 * median))).maxCoeff(&worst), 1.0) << what << ", Gaussian " << worst;
  }
};

}  // namespace oraclegs

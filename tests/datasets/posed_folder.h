#pragma once
// A folder with images whose true cameras are known, for the readers of datasets.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/dataset_files.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/demo/demo_scene.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// Three images of the demo scene in images/, and their cameras.
class PosedFolder : public ::testing::Test {
 protected:
  PosedFolder() {
    DemoSceneOptions options;
    options.views = 3;
    options.width = 24;
    options.height = 16;
    options.samples = 1;
    WriteDemoScene(dir_ / "demo", options, Silent());
    truth_ = ReadScene(dir_ / "demo", {}, Silent()).views;
    std::filesystem::rename(dir_ / "demo/images", root() / "images");
    for (SceneView& view : truth_) view.name = std::filesystem::path(view.name).filename().string();
  }

  /// The folder that is read; it has images/.
  std::filesystem::path root() {
    std::filesystem::create_directories(dir_ / "scene");
    return dir_ / "scene";
  }
  Scene Read(const SceneReadOptions& options = {}) { return ReadScene(root(), options, events_.AsListener()); }
  std::string ReadError() {
    return MessageOf<InputError>([&] { Read(); });
  }

  /// The scene has the true views, each with its true camera; `factor` times as large images.
  void ExpectTruth(const Scene& scene, double factor = 1) const {
    ASSERT_EQ(scene.views.size(), truth_.size());
    for (size_t i = 0; i < truth_.size(); ++i) {
      const SceneView &view = scene.views[i], &truth = truth_[i];
      EXPECT_EQ(view.name, truth.name);
      EXPECT_LT((view.cam_from_world->matrix() - truth.cam_from_world->matrix()).cwiseAbs().maxCoeff(), 1e-6);
      EXPECT_EQ(view.intrinsics.width, factor * truth.intrinsics.width);
      EXPECT_EQ(view.intrinsics.height, factor * truth.intrinsics.height);
      EXPECT_NEAR(view.intrinsics.fx(), factor * truth.intrinsics.fx(), 1e-6);
      EXPECT_NEAR(view.intrinsics.fy(), factor * truth.intrinsics.fy(), 1e-6);
      EXPECT_NEAR(view.intrinsics.cx(), factor * truth.intrinsics.cx(), 1e-6);
      EXPECT_NEAR(view.intrinsics.cy(), factor * truth.intrinsics.cy(), 1e-6);
    }
  }

  TempDir dir_;
  EventRecorder events_;
  std::vector<SceneView> truth_;
};

}  // namespace oraclegs

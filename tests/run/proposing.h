#pragma once

#include <algorithm>

#include "oraclegs/stages/stage_works.h"
#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// The tests of a suite share one small scene, from whose spare poses views are proposed: temp/scene, temp/out.
class ProposingTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    temp = new TempDir;
    DemoSceneOptions demo;
    demo.views = 24, demo.width = 80, demo.height = 60, demo.samples = 1;
    WriteDemoScene(*temp / "scene", demo, Silent());
  }
  static void TearDownTestSuite() { delete temp; }

  static RunRequest Request(const std::string& out = "out") {
    RunRequest request = TinyRequest(temp->path() / "scene", temp->path() / out);
    request.options.start.init = {};
    request.options.split.test_every = 6;
    request.options.split.views = 12;
    request.options.stereo.iterations = 3;
    request.options.stereo.geometric_passes = 1;
    request.options.train.max_gaussians = 1500;
    request.options.trajectory.trajectory = Trajectory::kDataset;
    request.options.propose.proposers = std::string("proxies,warp");
    request.options.propose.proxy_models = 3;
    return request;
  }

  static inline TempDir* temp = nullptr;
  EventRecorder recorder;
};

}  // namespace oraclegs

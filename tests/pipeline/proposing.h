#pragma once

#include <algorithm>

#include "oraclegs/pipeline/stages/prepare.h"
#include "oraclegs/pipeline/stages/propose_stage.h"
#include "pipeline/fixtures.h"

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
    request.options.start.init = "auto";
    request.options.split.test_every = 6;
    request.options.split.views = 12;
    request.options.stereo.iterations = 3;
    request.options.stereo.geometric_passes = 1;
    request.options.train.max_gaussians = 1500;
    request.options.trajectory.trajectory = "dataset";
    request.options.propose.proposers = "both";
    request.options.propose.opinions = 3;
    return request;
  }

  static ProposalPlan Propose(oraclegs::Run* run, const Preparation& prepared) {
    return RunPropose(run, prepared.photos, prepared.geometry, prepared.decided);
  }

  static inline TempDir* temp = nullptr;
  Recorder recorder;
};

}  // namespace oraclegs

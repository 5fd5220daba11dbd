#pragma once
// Small scenes on disk for the tests of the pipeline.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "oraclegs/core/files.h"
#include "oraclegs/demo/demo_scene.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/run/start.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// Hides weights that this machine has fetched: tests see only those they name themselves.
inline const int kNoModels = setenv("ORACLEGS_MODELS", "/nonexistent", 1);

/// A demo scene of a few tiny photographs.
inline std::filesystem::path MakeTinyScene(const std::filesystem::path& dir, int views = 6) {
  DemoSceneOptions options;
  options.views = views;
  options.width = 48;
  options.height = 36;
  options.samples = 1;
  WriteDemoScene(dir, options, Silent());
  return dir;
}

/// A request that trains within a second.
inline RunRequest TinyRequest(const std::filesystem::path& scene, const std::filesystem::path& out) {
  RunRequest request;
  request.scene = scene;
  request.out = out;
  request.version = "test";
  request.options.depth.refine_poses = PoseRefining::kOff;
  request.options.start.init = StartKind::kRandom;
  request.options.split.test_every = 3;
  request.options.train.iterations = 30;
  request.options.train.max_gaussians = 500;
  request.options.train.random_points = 400;
  request.options.propose.proposers = std::string("none");
  request.options.validate.oracle = OracleKind::kConsistency;  // whatever weights lie on the machine
  return request;
}

/// Brings a stage up to date and returns the results of the stages.
inline const StageResults& Bring(oraclegs::Run* run, const std::string& stage) {
  RunStage(run, stage);
  return *run->results;
}

/// Points in place of those of stage "sfm".
inline void GivePoints(oraclegs::Run* run, std::vector<ScenePoint> points) {
  run->results->points = std::move(points);
  run->results->keys["sfm"] = StageKey(run, Stages(), "sfm");
}

}  // namespace oraclegs

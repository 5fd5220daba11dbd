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
#include "oraclegs/pipeline/run.h"
#include "support/golden.h"

namespace oraclegs {

/// Tests see no weights but those they name themselves, whatever this machine has fetched.
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
  request.options.start.init = "random";
  request.options.split.test_every = 3;
  request.options.train.iterations = 30;
  request.options.train.max_gaussians = 500;
  request.options.train.random_points = 400;
  request.options.propose.proposers = "none";
  request.options.validate.oracle = "consistency";  // whatever weights lie on the machine
  return request;
}

/// Remembers what a stage said.
struct Recorder {
  std::vector<std::string> warnings, notes;
  std::vector<std::string> started;

  Listener AsListener() {
    return [this](const Event& event) {
      if (const auto* w = std::get_if<Warning>(&event)) warnings.push_back(w->text);
      if (const auto* n = std::get_if<Note>(&event)) notes.push_back(n->text);
      if (const auto* s = std::get_if<StageStarted>(&event)) started.push_back(s->stage);
    };
  }
};

/// The message of the error that `body` throws, "" when it throws none.
template <class Error, class Body>
std::string MessageOf(Body&& body) {
  try {
    body();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

inline void WriteText(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

}  // namespace oraclegs

#pragma once

#include "oraclegs/run/reconstruct.h"
#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// The tests of a suite share one small finished run: temp/scene and temp/out.
class TrainedTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    temp = new TempDir;
    request = new RunRequest(TinyRequest(MakeTinyScene(*temp / "scene"), *temp / "out"));
    metrics = new nlohmann::json(Reconstruct(*request, Silent()));
  }
  static void TearDownTestSuite() {
    delete metrics;
    delete request;
    delete temp;
  }

  static inline TempDir* temp = nullptr;
  static inline RunRequest* request = nullptr;
  static inline nlohmann::json* metrics = nullptr;
  EventRecorder recorder;
};

}  // namespace oraclegs

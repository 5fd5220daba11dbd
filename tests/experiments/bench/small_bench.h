#pragma once
// A benchmark of two tiny scenes whose runs a test makes up.

#include <string>

#include "oraclegs/experiments/bench/bench_plan.h"
#include "run/fixtures.h"

namespace oraclegs {

class SmallBenchTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scenes = new TempDir;
    MakeTinyScene(*scenes / "one", 9);
    MakeTinyScene(*scenes / "two", 9);
  }
  static void TearDownTestSuite() { delete scenes; }

  /// Two scenes, two numbers of views, two methods, two seeds.
  BenchRequest Request() const {
    BenchRequest request;
    request.options.suite = scenes->path().string(), request.options.views = "3,5", request.options.seeds = 2;
    request.options.methods = "ours,3dgs-mcmc";
    request.asked = {{"iterations", "50"}};
    request.out = dir / "out", request.command = "oraclegs bench", request.version = "test";
    request.program = "/bin/oraclegs";
    return request;
  }

  static inline TempDir* scenes = nullptr;
  TempDir dir;
};

}  // namespace oraclegs

#pragma once
// Runs a kernel's tests once for each instruction set that this machine supports.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <string>

namespace oraclegs {

class EveryTarget : public testing::TestWithParam<int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

inline std::string TargetName(const testing::TestParamInfo<int64_t>& info) { return hwy::TargetName(info.param); }

#define INSTANTIATE_FOR_EVERY_TARGET(suite) \
  INSTANTIATE_TEST_SUITE_P(Simd, suite, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()), TargetName)

}  // namespace oraclegs

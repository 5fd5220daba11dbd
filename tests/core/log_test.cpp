#include "oraclegs/core/log.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

class LogTest : public testing::Test {
 protected:
  ~LogTest() override { SetVerbosity(Verbosity::kNormal); }

  static std::string WhatIsLogged() {
    testing::internal::CaptureStderr();
    Log().debug("fine");
    Log().info("said {}", 1);
    Log().warn("mind");
    return testing::internal::GetCapturedStderr();
  }
};

TEST_F(LogTest, VerbosityDecides) {
  EXPECT_EQ(WhatIsLogged(), "info: said 1\nwarning: mind\n");
  SetVerbosity(Verbosity::kQuiet);
  EXPECT_EQ(WhatIsLogged(), "warning: mind\n");
  SetVerbosity(Verbosity::kVerbose);
  EXPECT_EQ(WhatIsLogged(), "debug: fine\ninfo: said 1\nwarning: mind\n");
}

TEST_F(LogTest, ATextIsOneLineAndSteersNoTerminal) {
  testing::internal::CaptureStderr();
  Log().warn("{}",
             "a\nb\x1B[31m\xC2\x9B"
             "c");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: a?b?[31m?c\n");
}

}  // namespace
}  // namespace oraclegs

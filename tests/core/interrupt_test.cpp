#include "oraclegs/core/interrupt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

class Interrupt : public testing::TestWithParam<int> {
 protected:
  ~Interrupt() override {
    RequestInterrupt(false);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  }
};

TEST_P(Interrupt, ASignalAsksForAStop) {
  InstallInterruptHandlers();
  EXPECT_FALSE(InterruptRequested());
  EXPECT_NO_THROW(ThrowIfInterrupted());
  std::raise(GetParam());
  EXPECT_TRUE(InterruptRequested());
  EXPECT_THROW(ThrowIfInterrupted(), Interrupted);
}

TEST_P(Interrupt, TheSecondSignalEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // the thread sanitizer holds back signals of a forked child
  const auto twice = [] {
    InstallInterruptHandlers();
    std::raise(GetParam());
    std::raise(GetParam());
  };
  EXPECT_EXIT(twice(), testing::KilledBySignal(GetParam()), "");
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, testing::Values(SIGINT, SIGTERM));

TEST(InterruptRequest, CanBeSetAndTakenBack) {
  RequestInterrupt(true);
  EXPECT_TRUE(InterruptRequested());
  RequestInterrupt(false);
  EXPECT_FALSE(InterruptRequested());
}

}  // namespace
}  // namespace oraclegs

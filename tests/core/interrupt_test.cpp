#include "oraclegs/core/interrupt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

class Signaled : public testing::Test {
 protected:
  ~Signaled() override {
    RequestInterrupt(false);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    std::signal(SIGHUP, SIG_DFL);
  }
};

class Interrupt : public Signaled, public testing::WithParamInterface<int> {};
class DeadlyInterrupt : public Interrupt {};

TEST_P(Interrupt, ASignalAsksForAStop) {
  InstallInterruptHandlers();
  EXPECT_FALSE(InterruptRequested());
  EXPECT_NO_THROW(ThrowIfInterrupted());
  std::raise(GetParam());
  EXPECT_TRUE(InterruptRequested());
  EXPECT_THROW(ThrowIfInterrupted(), Interrupted);
}

TEST_P(DeadlyInterrupt, TheSecondSignalEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // the thread sanitizer holds back signals of a forked child
  const auto twice = [] {
    InstallInterruptHandlers();
    std::raise(GetParam());
    std::raise(GetParam());
  };
  EXPECT_EXIT(twice(), testing::KilledBySignal(GetParam()), "");
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, testing::Values(SIGINT, SIGTERM, SIGHUP));
INSTANTIATE_TEST_SUITE_P(Signals, DeadlyInterrupt, testing::Values(SIGINT, SIGTERM));

TEST_F(Signaled, AClosedTerminalMaySayItTwice) {
  InstallInterruptHandlers();
  std::raise(SIGHUP);
  std::raise(SIGHUP);
  EXPECT_TRUE(InterruptRequested());
}

TEST_F(Signaled, AnIgnoredHangupStaysIgnored) {
  std::signal(SIGHUP, SIG_IGN);
  InstallInterruptHandlers();
  std::raise(SIGHUP);
  EXPECT_FALSE(InterruptRequested());
}

/// Fails under the thread sanitizer if the flag is not safe between threads.
TEST_F(Signaled, AnotherThreadMayAsk) {
  std::thread other([] { RequestInterrupt(true); });
  while (!InterruptRequested()) std::this_thread::yield();
  other.join();
}

TEST(InterruptRequest, CanBeSetAndTakenBack) {
  RequestInterrupt(true);
  EXPECT_TRUE(InterruptRequested());
  RequestInterrupt(false);
  EXPECT_FALSE(InterruptRequested());
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/core/parallel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace oraclegs {
namespace {

class Parallel : public testing::TestWithParam<int> {
 protected:
  Parallel() : before_(NumThreads()) { SetNumThreads(GetParam()); }
  ~Parallel() override { SetNumThreads(before_); }

 private:
  int before_;
};

/// A sum whose value depends on the order of the additions.
float BlockedSum() {
  constexpr int64_t kItems = 100'003, kGrain = 1000;
  std::vector<float> partial((kItems + kGrain - 1) / kGrain);
  ParallelBlocks(kItems, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) partial[begin / kGrain] += std::sin(static_cast<float>(i)) * 1e3f;
  });
  return std::accumulate(partial.begin(), partial.end(), 0.f);
}

/// Ends the process: with 0 when all tasks ran although only a few threads' stacks fit into memory.
[[noreturn]] void RunWithLittleRoom() {
  SetNumThreads(500);
  std::ifstream status("/proc/self/statm");
  rlim_t pages = 0;
  status >> pages;
  const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{100} << 20);
  const rlimit limit = {bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
  std::atomic<int> runs{0};
  ParallelFor(1000, [&](int64_t) { ++runs; });
  _exit(runs == 1000 ? 0 : 1);
}

TEST(ParallelFor, GoesOnWithFewerThreadsThanAreAskedFor) {
  EXPECT_EXIT(RunWithLittleRoom(), testing::ExitedWithCode(0), "");
}

/// Runs tasks in a forked child that ends by exit, like a program that knows nothing of threads.
[[noreturn]] void RunInAForkedChild() {
  SetNumThreads(3);
  std::atomic<int> runs{0};
  ParallelFor(100, [&](int64_t) { ++runs; });
  const pid_t child = fork();
  if (child == 0) {
    ParallelFor(100, [&](int64_t) { ++runs; });
    std::exit(runs == 200 ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

TEST(ParallelFor, WorksInAForkedChildAndEndsWithIt) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer ends a forked child that starts threads";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(RunInAForkedChild(), testing::ExitedWithCode(0), "");
}

TEST_P(Parallel, EveryTaskRunsOnce) {
  std::vector<std::atomic<int>> runs(1000);
  ParallelFor(1000, [&](int64_t i) { ++runs[i]; });
  for (const auto& n : runs) EXPECT_EQ(n, 1);
}

TEST_P(Parallel, BlocksDependOnSizeAndGrainOnly) {
  std::vector<std::pair<int64_t, int64_t>> blocks(4);
  ParallelBlocks(10, 3, [&](int64_t begin, int64_t end) { blocks[begin / 3] = {begin, end}; });
  using Block = std::pair<int64_t, int64_t>;
  EXPECT_THAT(blocks, testing::ElementsAre(Block{0, 3}, Block{3, 6}, Block{6, 9}, Block{9, 10}));
}

TEST_P(Parallel, TheSameBitsAsOneThread) {
  const float sum = BlockedSum();
  SetNumThreads(1);
  EXPECT_EQ(sum, BlockedSum());
}

TEST_P(Parallel, NothingToDo) {
  ParallelFor(0, [](int64_t) { FAIL(); });
  ParallelBlocks(0, 8, [](int64_t, int64_t) { FAIL(); });
}

TEST_P(Parallel, AnExceptionReachesTheCaller) {
  EXPECT_THROW(ParallelFor(100,
                           [](int64_t i) {
                             if (i % 10 == 3) throw std::runtime_error("task");
                           }),
               std::runtime_error);
  std::atomic<int> runs{0};
  ParallelFor(100, [&](int64_t) { ++runs; });
  EXPECT_EQ(runs, 100) << "the next loop is unharmed";
}

TEST_P(Parallel, LoopsInLoopsRunInTheirTask) {
  std::vector<int> cells(100);
  ParallelFor(10, [&](int64_t row) { ParallelFor(10, [&](int64_t column) { cells[row * 10 + column] += 1; }); });
  EXPECT_THAT(cells, testing::Each(1));
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, testing::Values(1, 2, 3));

TEST(NumThreads, MayChangeBetweenLoops) {
  const int before = NumThreads();
  for (int round = 0; round < 300; ++round) {
    SetNumThreads(std::array{1, 5, 2, 7, 3}[round % 5]);
    const int64_t tasks = round % 11;  // also fewer than threads
    std::vector<std::atomic<int>> runs(tasks);
    ParallelFor(tasks, [&](int64_t i) { ++runs[i]; });
    for (const auto& n : runs) ASSERT_EQ(n, 1) << round;
  }
  SetNumThreads(before);
}

TEST(NumThreads, ZeroMeansAllOfThem) {
  const int before = NumThreads();
  SetNumThreads(5);
  EXPECT_EQ(NumThreads(), 5);
  SetNumThreads(0);
  EXPECT_GE(NumThreads(), 1);
  SetNumThreads(before);
}

}  // namespace
}  // namespace oraclegs

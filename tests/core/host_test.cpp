#include "oraclegs/core/host.h"
#include "support/temp_dir.h"

#include <gtest/gtest.h>
#include <sys/sysinfo.h>
#include <sys/utsname.h>

#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {
namespace {

TEST(HostName, CanStandInTheNameOfAFile) {
  const std::string host = HostName();
  EXPECT_FALSE(host.empty());
  EXPECT_EQ(host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-"),
            std::string::npos);
  utsname machine{};
  ASSERT_EQ(uname(&machine), 0);
  EXPECT_EQ(host.size(), std::string(machine.nodename).size());
}

TEST(AvailableMemory, IsAPartOfThisMachines) {
  struct sysinfo machine {};
  ASSERT_EQ(sysinfo(&machine), 0);
  const uint64_t all = uint64_t{machine.totalram} * machine.mem_unit;
  EXPECT_LE(AvailableMemory(), all);
  EXPECT_GT(AvailableMemory(), uint64_t{16} << 20);
}

/// A made-up machine with 18 GB.
class MemoryTree : public testing::Test {
 protected:
  MemoryTree() { Write("proc/meminfo", "MemTotal: 32000000 kB\nMemFree: 1 kB\nMemAvailable:   18000000 kB\n"); }

  void Write(const std::string& file, const std::string& text) { WriteText(dir_ / file, text + "\n"); }
  void Group2(const std::string& path, const std::string& limit, int64_t used, int64_t inactive = 0) {
    const std::string group = "sys/fs/cgroup/" + path + "/";
    Write(group + "memory.max", limit);
    Write(group + "memory.current", std::to_string(used));
    Write(group + "memory.stat", "anon 5\ninactive_file " + std::to_string(inactive) + "\nfile 7");
  }
  void Group1(const std::string& path, int64_t limit, int64_t used, int64_t inactive = 0) {
    const std::string group = "sys/fs/cgroup/memory/" + path + "/";
    Write(group + "memory.limit_in_bytes", std::to_string(limit));
    Write(group + "memory.usage_in_bytes", std::to_string(used));
    Write(group + "memory.stat", "inactive_file 3\ntotal_inactive_file " + std::to_string(inactive));
  }
  uint64_t Available() const { return AvailableMemory(dir_.path()); }

  static constexpr uint64_t kMachine = 18'000'000ULL * 1024;
  TempDir dir_;
};

TEST_F(MemoryTree, IsTheMachinesWithoutGroups) {
  EXPECT_EQ(Available(), kMachine);
  Write("proc/self/cgroup", "0::/user.slice\nnonsense\n");
  EXPECT_EQ(Available(), kMachine) << "nothing is limited there";
  std::filesystem::remove(dir_ / "proc/meminfo");
  EXPECT_EQ(Available(), 0u);
}

TEST_F(MemoryTree, TakesTheLeastOfAGroupAndThoseAboveIt) {
  Write("proc/self/cgroup", "0::/system.slice/slurm/job_7/step_0");
  Group2("system.slice/slurm/job_7/step_0", "max", 1'000'000'000);
  Group2("system.slice/slurm/job_7", "4000000000", 1'500'000'000, 500'000'000);
  Group2("system.slice", "90000000000", 2'000'000'000);
  EXPECT_EQ(Available(), 3'000'000'000u);
  Group2("system.slice", "2500000000", 2'000'000'000);
  EXPECT_EQ(Available(), 500'000'000u);
  Write("sys/fs/cgroup/system.slice/slurm/memory.high", "100");
  Write("sys/fs/cgroup/system.slice/slurm/memory.current", "40");
  EXPECT_EQ(Available(), 60u) << "above it all comes to a halt";
}

TEST_F(MemoryTree, KnowsVersion1) {
  Write("proc/self/cgroup", "9:cpu,cpuacct:/a\n4:hugetlb,memory:/slurm/uid_0/job_7\n1:name=systemd:/b\n0::/");
  Group1("", INT64_C(9223372036854771712), 5'000'000'000);
  EXPECT_EQ(Available(), kMachine);
  Group1("slurm/uid_0/job_7", 3'000'000'000, 2'500'000'000, 1'000'000'000);
  EXPECT_EQ(Available(), 1'500'000'000u);
  Group1("a", 10, 5);
  EXPECT_EQ(Available(), 1'500'000'000u) << "another group's";
}

TEST_F(MemoryTree, FindsTheGroupOfAContainer) {
  // It is shown the machine's path, and its own group as the top.
  Write("proc/self/cgroup", "4:memory:/docker/0123abcd");
  Group1("", 2'000'000'000, 500'000'000);
  EXPECT_EQ(Available(), 1'500'000'000u);
  Write("proc/self/cgroup", "0::/../../elsewhere");
  Group2("", "1000000000", 900'000'000);
  EXPECT_EQ(Available(), 100'000'000u);
  Group2("", "1000000000", 2'000'000'000);
  EXPECT_EQ(Available(), 0u) << "more than it may have";
}

TEST(PeakMemoryBytes, IsWhatWasTouchedAtLeast) {
  constexpr int64_t kBytes = int64_t{64} << 20;
  const std::vector<char> touched(kBytes, 1);
  EXPECT_GT(PeakMemoryBytes(), kBytes);
  EXPECT_EQ(touched.back(), 1);
}

}  // namespace

}  // namespace oraclegs

#include "oraclegs/core/machine.h"
#include "support/temp_dir.h"

#include <gtest/gtest.h>
#include <sys/sysinfo.h>

namespace oraclegs {
namespace {

TEST(Machine, IsAsTheKernelTells) {
  const TempDir dir;
  WriteText(dir / "proc/cpuinfo", "processor\t: 0\nmodel name\t: AMD EPYC 9R14\nprocessor\t: 1\nmodel name\t: other\n");
  WriteText(dir / "proc/meminfo", "MemTotal:       32000000 kB\nMemFree: 1 kB\n");
  WriteText(dir / "proc/driver/nvidia/version",
            "NVRM version: NVIDIA UNIX x86_64 Kernel Module  550.54.14  Thu Feb 22 01:44:30 UTC 2024\n"
            "GCC version:  gcc version 12.2.0 (Debian 12.2.0-14)\n");
  WriteText(dir / "proc/driver/nvidia/gpus/0000:41:00.0/information", "Model: \t\t NVIDIA H200\nIRQ:   \t\t 100\n");
  WriteText(dir / "proc/driver/nvidia/gpus/0000:07:00.0/information", "IRQ:   \t\t 99\n");
  EXPECT_EQ(ProcessorName(dir.path()), "AMD EPYC 9R14");
  EXPECT_EQ(TotalMemory(dir.path()), uint64_t{32000000} * 1024);
  const NvidiaGpus gpus = FindNvidiaGpus(dir.path());
  EXPECT_EQ(gpus.driver, "550.54.14");
  EXPECT_EQ(gpus.models, (std::vector<std::string>{"NVIDIA GPU", "NVIDIA H200"}));
}

TEST(Machine, OfWhichNothingIsKnown) {
  const TempDir dir;
  EXPECT_EQ(ProcessorName(dir.path()), "");
  EXPECT_EQ(TotalMemory(dir.path()), 0);
  EXPECT_EQ(FindNvidiaGpus(dir.path()).driver, "");
  EXPECT_TRUE(FindNvidiaGpus(dir.path()).models.empty());
  WriteText(dir / "proc/meminfo", "MemTotal: much\n");
  EXPECT_EQ(TotalMemory(dir.path()), 0);
}

TEST(Machine, ThisOneHasMemory) {
  struct sysinfo machine {};
  ASSERT_EQ(sysinfo(&machine), 0);
  EXPECT_EQ(TotalMemory() / 1024, uint64_t{machine.totalram} * machine.mem_unit / 1024);
}

}  // namespace
}  // namespace oraclegs

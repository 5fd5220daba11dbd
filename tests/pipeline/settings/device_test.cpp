#include "oraclegs/pipeline/settings/device.h"

#include <gmock/gmock.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr DeviceSupport kNone, kTwoGpus{true, true, 2};

std::string Refusal(const std::string& text, const DeviceSupport& support) {
  try {
    ChooseDevice(text, support);
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(DeviceTest, AutoTakesAGpuWhereThereIsOne) {
  EXPECT_EQ(ChooseDevice("auto", kTwoGpus), Device(torch::kCUDA, 0));
  EXPECT_EQ(ChooseDevice("auto", kNone), Device(kCpu));
  EXPECT_EQ(ChooseDevice("cpu", kTwoGpus), Device(kCpu));
  EXPECT_EQ(ChooseDevice("cuda", kTwoGpus), Device(torch::kCUDA, 0));
  EXPECT_EQ(ChooseDevice("cuda:1", kTwoGpus), Device(torch::kCUDA, 1));
}

TEST(DeviceTest, NeverFallsBackToTheCpuSilently) {
  EXPECT_THAT(Refusal("cuda", kNone), AllOf(HasSubstr("built without CUDA"), HasSubstr("--device cpu")));
  EXPECT_THAT(Refusal("cuda", {true, false, 1}), HasSubstr("libtorch"));
  EXPECT_THAT(Refusal("cuda:0", {true, true, 0}), HasSubstr("no NVIDIA GPU"));
  EXPECT_THAT(Refusal("cuda:2", kTwoGpus), HasSubstr("has 2 NVIDIA GPUs, numbered from 0"));
  EXPECT_THAT(Refusal("cuda:1", {true, true, 1}), HasSubstr("has 1 NVIDIA GPU, numbered from 0"));
}

TEST(DeviceTest, KnowsWhatIsFree) { EXPECT_GT(FreeBytes(kCpu), 0); }

TEST(DeviceTest, RefusesOtherWords) {
  for (const char* text : {"", "gpu", "cuda:", "cuda:-1", "cuda:1x", "cuda:999999999999", "cuda1"}) {
    EXPECT_THAT(Refusal(text, kTwoGpus), HasSubstr("must be auto, cpu, cuda or cuda:N")) << text;
  }
}

std::vector<std::string> Told(Device device, const DeviceSupport& support) {
  std::vector<std::string> notes;
  TellDevice(device, support, [&](const Event& event) { notes.push_back(std::get<Note>(event).text); });
  return notes;
}

TEST(DeviceTest, TellsWhichGpu) {
  EXPECT_THAT(Told(Device(torch::kCUDA, 1), kTwoGpus), testing::ElementsAre("computing on the GPU cuda:1"));
}

TEST(DeviceTest, TellsWhyAProgramForGpusTakesTheCpu) {
  EXPECT_THAT(Told(kCpu, {true, false, 0}),
              testing::ElementsAre("computing on the CPU: this machine has no NVIDIA GPU with a working driver"));
  EXPECT_THAT(Told(kCpu, {true, false, 1}), testing::ElementsAre(HasSubstr("the libtorch")));
  EXPECT_THAT(Told(kCpu, kNone), testing::IsEmpty());     // nothing else was to be expected
  EXPECT_THAT(Told(kCpu, kTwoGpus), testing::IsEmpty());  // it was chosen
}

TEST(DeviceTest, ThisMachineHasSomeDevice) { EXPECT_NO_THROW(ChooseDevice("auto", ProbeDevices())); }

}  // namespace
}  // namespace oraclegs

#include "oraclegs/settings/device.h"

#include <gmock/gmock.h>

#include "oraclegs/core/error.h"
#include "oraclegs/networks/loader.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const DeviceSupport kNone{0, false, "a GPU needs liboraclegs_cuda.so, which is not here", false}, kTwoGpus{2, true},
    kOnlyLibrary{0, false}, kOnlyDriver{0, true, "a GPU needs liboraclegs_cuda.so, which is not here", false},
    kBoth{0, true};

std::string Refusal(const std::string& text, const DeviceSupport& support) {
  try {
    ChooseDevice(text, support);
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(DeviceTest, AutoTakesAGpuWhereThereIsOne) {
  EXPECT_EQ(ChooseDevice("auto", kTwoGpus), (Device{DeviceKind::kCuda, 0}));
  EXPECT_EQ(ChooseDevice("auto", kNone), kCpu);
  EXPECT_EQ(ChooseDevice("cpu", kTwoGpus), kCpu);
  EXPECT_EQ(ChooseDevice("cuda", kTwoGpus), (Device{DeviceKind::kCuda, 0}));
  EXPECT_EQ(ChooseDevice("cuda:1", kTwoGpus), (Device{DeviceKind::kCuda, 1}));
}

TEST(DeviceTest, NeverFallsBackToTheCpuSilently) {
  EXPECT_THAT(Refusal("cuda", kNone),
              AllOf(HasSubstr("no NVIDIA GPU with a driver"), HasSubstr("no library"), HasSubstr("--device cpu")));
  EXPECT_THAT(Refusal("cuda:0", kOnlyLibrary), HasSubstr("no NVIDIA GPU with a working driver"));
  EXPECT_THAT(Refusal("cuda:0", kOnlyDriver), HasSubstr("liboraclegs_cuda.so, which is not here"));
  EXPECT_THAT(Refusal("cuda:0", kBoth), HasSubstr("does not answer, or is too old"));
  EXPECT_THAT(Refusal("cuda:0", {0, true, "x.so: is of another build"}), HasSubstr("x.so: is of another build"));
  EXPECT_THAT(Refusal("cuda:2", kTwoGpus), HasSubstr("has 2 NVIDIA GPUs, numbered from 0"));
  EXPECT_THAT(Refusal("cuda:1", {1, true}), HasSubstr("has 1 NVIDIA GPU, numbered from 0"));
}

TEST(DeviceTest, KnowsWhatIsFree) { EXPECT_GT(FreeBytes(kCpu), 0); }

TEST(DeviceTest, RefusesOtherWords) {
  for (const char* text : {"", "gpu", "cuda:", "cuda:-1", "cuda:1x", "cuda:999999999999", "cuda1"}) {
    EXPECT_THAT(Refusal(text, kTwoGpus), HasSubstr("must be auto, cpu, cuda or cuda:N")) << text;
  }
}

std::vector<std::string> Reported(Device device, const DeviceSupport& support) {
  std::vector<std::string> notes;
  ReportDevice(device, support, [&](const Event& event) { notes.push_back(std::get<Note>(event).text); });
  return notes;
}

TEST(DeviceTest, ReportsWhichGpu) {
  EXPECT_THAT(Reported((Device{DeviceKind::kCuda, 1}), kTwoGpus), testing::ElementsAre("computing on the GPU cuda:1"));
}

TEST(DeviceTest, ReportsWhatIsMissingWhereSomethingIsThere) {
  EXPECT_THAT(Reported(kCpu, kOnlyLibrary),
              testing::ElementsAre("computing on the CPU: this machine has no NVIDIA GPU with a working driver"));
  EXPECT_THAT(Reported(kCpu, kOnlyDriver), testing::ElementsAre(HasSubstr("liboraclegs_cuda.so, which is not here")));
  EXPECT_THAT(Reported(kCpu, kNone), testing::IsEmpty());     // nothing else was to be expected
  EXPECT_THAT(Reported(kCpu, kTwoGpus), testing::IsEmpty());  // it was chosen
}

/// Networks whose libtorch has CUDA or not.
class FakeNetworks : public Networks {
 public:
  explicit FakeNetworks(bool cuda) : cuda_(cuda) {}
  bool has_cuda() const override { return cuda_; }
  std::unique_ptr<DepthNetwork> LoadDepth(const std::filesystem::path&, Device) const override { return nullptr; }
  std::unique_ptr<KeypointNetwork> LoadKeypoints(const std::filesystem::path&, Device) const override {
    return nullptr;
  }
  std::unique_ptr<PerceptualNetwork> LoadPerceptual(const std::vector<std::filesystem::path>&, Device,
                                                    int64_t) const override {
    return nullptr;
  }
  std::unique_ptr<AttentionNetwork> OpenAttention(const std::filesystem::path&, const AttentionOptions&,
                                                  Device) const override {
    return nullptr;
  }
  PoseEstimate EstimatePoses(const PoseRequest&, const Listener&) const override { return {}; }
  std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest&) const override { return nullptr; }
  void RequireMemoryToGenerate(const ViewGeneratorRequest&, seva::Size) const override {}

 private:
  bool cuda_;
};

TEST(DeviceTest, NetworksFallBackToTheCpuWithAWarning) {
  const Device gpu{DeviceKind::kCuda, 1};
  std::vector<std::string> warnings;
  const Listener listener = [&](const Event& event) { warnings.push_back(std::get<Warning>(event).text); };
  EXPECT_EQ(DeviceOfNetworks(FakeNetworks(true), gpu, listener), gpu);
  EXPECT_EQ(DeviceOfNetworks(FakeNetworks(false), kCpu, listener), kCpu);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(DeviceOfNetworks(FakeNetworks(false), gpu, listener), kCpu);
  EXPECT_THAT(warnings, testing::ElementsAre(AllOf(HasSubstr("networks compute on the CPU"), HasSubstr("libtorch"))));
}

TEST(DeviceTest, SaysWhyNetworksComputeOnACpuThatNobodyAskedFor) {
  EXPECT_EQ(WhyNetworksOnCpu("cpu", kCpu, kNone), "");
  EXPECT_THAT(WhyNetworksOnCpu("auto", kCpu, kNone), HasSubstr("no NVIDIA GPU with a driver"));
  EXPECT_EQ(WhyNetworksOnCpu("auto", kCpu, kOnlyLibrary), "this machine has no NVIDIA GPU with a working driver");
  if (!HasNetworksLibrary()) return;
  const std::string beside_gpu = WhyNetworksOnCpu("auto", {DeviceKind::kCuda, 0}, kTwoGpus);
  if (GetNetworks().has_cuda()) {
    EXPECT_EQ(beside_gpu, "");
  } else {
    EXPECT_THAT(beside_gpu, AllOf(HasSubstr("libtorch"), HasSubstr("CMAKE_PREFIX_PATH")));
  }
}

TEST(DeviceTest, ThisMachineHasSomeDevice) { EXPECT_NO_THROW(ChooseDevice("auto", ProbeDevices())); }

}  // namespace
}  // namespace oraclegs

// Exports that the program looks up in this library (networks/loader.h): the identity of this build, and the factory.

#include <ATen/Parallel.h>
#include <torch/cuda.h>

#include "oraclegs/core/parallel.h"
#include "oraclegs/networks/aliked/aliked.h"
#include "oraclegs/networks/build_id.h"
#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/depth_anything/depth_anything.h"
#include "oraclegs/networks/lpips/lpips.h"
#include "oraclegs/networks/seva/model.h"
#include "oraclegs/networks/vggt/attention_network.h"
#include "oraclegs/networks/vggt/poses.h"
#if defined(ORACLEGS_CUDA)
#include <c10/cuda/CUDACachingAllocator.h>

#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#endif

namespace oraclegs {
namespace {

class TorchNetworks : public Networks {
 public:
  TorchNetworks() {
#if defined(ORACLEGS_CUDA)
    // libtorch keeps device memory that it does not use; the engine frees it through this before its own allocations
    // fail.
    if (!has_cuda() || !HasCudaLibrary()) return;
    CudaFunction<decltype(cuda::SetOutOfMemoryCallback)>("SetOutOfMemoryCallback")(
        [] { c10::cuda::CUDACachingAllocator::emptyCache(); });
#endif
  }

  bool has_cuda() const override { return torch::cuda::is_available(); }

  std::unique_ptr<DepthNetwork> LoadDepth(const std::filesystem::path& weights, Device device) const override {
    UseOurThreads();
    return LoadDepthNetwork(weights, ToTorch(device));
  }

  std::unique_ptr<KeypointNetwork> LoadKeypoints(const std::filesystem::path& weights, Device device) const override {
    UseOurThreads();
    return aliked::LoadKeypointNetwork(weights, ToTorch(device));
  }

  std::unique_ptr<PerceptualNetwork> LoadPerceptual(const std::vector<std::filesystem::path>& weights, Device device,
                                                    int64_t cache_bytes) const override {
    UseOurThreads();
    return MakePerceptualNetwork(LoadRecognizedLpips(weights, ToTorch(device)), cache_bytes);
  }

  std::unique_ptr<AttentionNetwork> OpenAttention(const std::filesystem::path& weights, const AttentionOptions& options,
                                                  Device device) const override {
    UseOurThreads();
    return vggt::OpenAttention(weights, options, ToTorch(device));
  }

  PoseEstimate EstimatePoses(const PoseRequest& request, const Listener& listener) const override {
    UseOurThreads();
    return vggt::EstimatePoses(request, listener);
  }

  std::unique_ptr<ViewGenerator> LoadViewGenerator(const ViewGeneratorRequest& request) const override {
    UseOurThreads();
    return seva::LoadViewGenerator(request);
  }

  void RequireMemoryToGenerate(const ViewGeneratorRequest& request, seva::Size photo) const override {
    seva::RequireMemory(request, photo);
  }

 private:
  static void UseOurThreads() { at::set_num_threads(NumThreads()); }
};

}  // namespace
}  // namespace oraclegs

extern "C" const char* oraclegs_networks_build();
extern "C" const oraclegs::Networks* oraclegs_networks_create();

const char* oraclegs_networks_build() {
  static const std::string build = oraclegs::NetworksBuildId();
  return build.c_str();
}

const oraclegs::Networks* oraclegs_networks_create() {
  static const oraclegs::TorchNetworks networks;
  return &networks;
}

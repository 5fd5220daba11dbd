#include "oraclegs/networks/lpips/lpips.h"

#include <map>
#include <mutex>
#include <utility>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {
namespace {

int64_t BytesOf(const LpipsTarget& target) {
  int64_t bytes = 0;
  for (const Tensor& t : target.features) bytes += t.numel() * static_cast<int64_t>(t.element_size());
  return bytes;
}

/// Targets and their features. None is evicted for another, since all are asked for equally often.
class Targets {
 public:
  explicit Targets(int64_t bytes) : left_(bytes) {}

  LpipsTarget Get(const Lpips& lpips, const Buffer<float>& image, Device device) {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(image.data());
    if (found != known_.end() && found->second.image.shape() == image.shape()) return found->second.target;
    LpipsTarget target = PrepareTarget(lpips, TensorOf(image.To(device)), LpipsRange::kZeroOne);
    const int64_t bytes = BytesOf(target);
    if (found == known_.end() && bytes <= left_) {
      left_ -= bytes;
      known_.emplace(image.data(), Known{image, target});
    }
    return target;
  }

 private:
  struct Known {
    Buffer<float> image;  // held, so that no other image can take its address
    LpipsTarget target;
  };

  std::mutex mutex_;
  int64_t left_;
  std::map<const void*, Known> known_;
};

class LpipsWithTargets : public PerceptualNetwork {
 public:
  LpipsWithTargets(Lpips lpips, int64_t cache_bytes)
      : lpips_(std::move(lpips)), device_(FromTorch(lpips_.weights[0].device())), targets_(cache_bytes) {}

  std::string name() const override {
    return lpips_.features.config.network == FeatureNetwork::kVgg16 ? "VGG16" : "AlexNet";
  }

  int64_t smallest_side() const override { return lpips_.features.smallest_side; }

  double Score(const Buffer<float>& image, const Buffer<float>& target, LpipsRange range) const override {
    const LpipsTarget prepared = PrepareTarget(lpips_, TensorOf(target.To(device_)), range);
    return Distance(lpips_, TensorOf(image.To(device_)), prepared).value;
  }

  double Loss(const Buffer<float>& image, const Buffer<float>& target, double weight,
              Buffer<float>* grad) const override {
    const LpipsTarget prepared = targets_.Get(lpips_, target, device_);
    const Tensor here = TensorOf(image.To(device_));
    if (grad == nullptr || !grad->defined()) return Distance(lpips_, here, prepared).value;
    const Buffer<float> sum = grad->To(device_);
    Tensor own = torch::empty_like(here);
    const double value = Distance(lpips_, here, prepared, &own).value;
    TensorOf(sum).add_(own, weight);
    if (sum.data() != grad->data()) grad->CopyFrom(sum);
    return value;
  }

 private:
  Lpips lpips_;
  Device device_;
  mutable Targets targets_;
};

}  // namespace

std::unique_ptr<PerceptualNetwork> MakePerceptualNetwork(Lpips lpips, int64_t cache_bytes) {
  return std::make_unique<LpipsWithTargets>(std::move(lpips), cache_bytes);
}

}  // namespace oraclegs

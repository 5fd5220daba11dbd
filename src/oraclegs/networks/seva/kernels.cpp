#include "oraclegs/networks/seva/kernels.h"

#if defined(ORACLEGS_CUDA) || defined(ORACLEGS_EMULATED_CUDA)
#include <c10/core/DeviceGuard.h>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/networks/cuda/kernels.h"

namespace oraclegs::seva::kernels {
namespace {

const uint16_t* Bits(const Tensor& t) { return t.defined() ? static_cast<const uint16_t*>(t.data_ptr()) : nullptr; }
uint16_t* BitsOf(Tensor* t) { return static_cast<uint16_t*>(t->data_ptr()); }

/// True when each tensor is undefined, or contiguous and fit for the kernels.
template <class... T>
bool CanTakeAll(const T&... tensors) {
  return ((!tensors.defined() || (CanTake(tensors) && tensors.is_contiguous())) && ...);
}

/// Sum and, where `norm` is given, its layer norm.
Tensor AddRows(const Tensor& x, const Addend& addend, const LayerNorm* norm, Tensor* sum) {
  const int64_t width = x.size(-1), rows = x.numel() / width;
  const bool fits = x.is_contiguous() && CanTake(x) && CanTakeAll(addend.rows, addend.vectors) && width % 2 == 0 &&
                    width <= cuda::kAddNormWidth && rows <= INT32_MAX &&
                    (norm == nullptr || CanTakeAll(norm->weight, norm->bias));
  if (!fits) return {};
  const c10::DeviceGuard guard(x.device());
  if (!sum->defined()) *sum = at::empty_like(x);
  cuda::AddNorm in;
  in.rows = rows;
  in.width = static_cast<int>(width);
  in.x = Bits(x), in.added = Bits(addend.rows), in.vectors = Bits(addend.vectors);
  if (addend.vectors.defined()) in.rows_a_vector = rows / (addend.vectors.numel() / width);
  in.sum = BitsOf(sum);
  Tensor normed = *sum;
  if (norm != nullptr) {
    normed = at::empty_like(x);
    in.weight = Bits(norm->weight), in.bias = Bits(norm->bias), in.eps = static_cast<float>(norm->eps);
    in.normed = BitsOf(&normed);
  }
  cuda::RunAddNorm(in, cuda::kStream);
  return normed;
}

}  // namespace

bool CanTake(const Tensor& x) {
#if defined(ORACLEGS_EMULATED_CUDA)
  return x.is_cpu() && x.scalar_type() == torch::kBFloat16;
#else
  return x.is_cuda() && x.scalar_type() == torch::kBFloat16;
#endif
}

Tensor GatedGelu(const Tensor& both) {
  const int64_t width = both.size(-1) / 2;
  if (!CanTakeAll(both) || width % 8 != 0) return {};
  const c10::DeviceGuard guard(both.device());
  std::vector<int64_t> shape = both.sizes().vec();
  shape.back() = width;
  Tensor out = at::empty(shape, both.options());
  cuda::RunGatedGelu({out.numel() / width, static_cast<int>(width), Bits(both), BitsOf(&out)}, cuda::kStream);
  return out;
}

Tensor Sum(const Tensor& x, const Addend& addend, Tensor* sum) { return AddRows(x, addend, nullptr, sum); }

Tensor NormOfSum(const Tensor& x, const Addend& addend, const LayerNorm& norm, Tensor* sum) {
  return AddRows(x, addend, &norm, sum);
}

Tensor NormMap(const GroupNorm& layer, const Tensor& x, bool silu, const AroundNorm& around) {
  const int64_t channels = x.size(1);
  const Conv* modulation = around.modulation;
  const bool fits = layer.channels_last && CanTake(x) && x.is_contiguous(at::MemoryFormat::ChannelsLast) &&
                    CanTakeAll(layer.weight, layer.bias, around.offsets) && channels % (2 * layer.groups) == 0 &&
                    channels <= cuda::kGroupNormChannels && layer.groups <= cuda::kGroupNormGroups &&
                    (modulation == nullptr || (around.rays.size(1) <= cuda::kGroupNormRays && CanTake(around.rays)));
  if (!fits) return {};
  const c10::DeviceGuard guard(x.device());
  cuda::GroupNorm in;
  in.images = x.size(0);
  in.pixels = static_cast<int>(x.size(2) * x.size(3)), in.channels = static_cast<int>(channels);
  in.groups = static_cast<int>(layer.groups);
  in.x = Bits(x), in.offsets = Bits(around.offsets);
  in.weight = Bits(layer.weight), in.bias = Bits(layer.bias), in.eps = static_cast<float>(layer.eps);
  in.silu = silu;
  Tensor rays, ray_weight;  // live until the kernels are queued; the memory is not reused before they have run
  if (modulation != nullptr) {
    rays = around.rays.contiguous(at::MemoryFormat::ChannelsLast);
    ray_weight = modulation->weight.flatten(1).contiguous();
    in.rays = static_cast<int>(rays.size(1)), in.ray_maps = Bits(rays);
    in.ray_weight = Bits(ray_weight), in.ray_bias = Bits(modulation->bias);
  }
  const at::TensorOptions floats = x.options().dtype(torch::kFloat).memory_format(at::MemoryFormat::Contiguous);
  Tensor sums = at::empty({cuda::GroupNormSums(in), 2}, floats), factors = at::empty({in.images, channels, 2}, floats);
  Tensor out = at::empty_like(x);
  in.out = BitsOf(&out);
  cuda::RunGroupNorm(
      in, {static_cast<cuda::GroupNormPair*>(sums.data_ptr()), static_cast<cuda::GroupNormPair*>(factors.data_ptr())},
      cuda::kStream);
  return out;
}

Tensor AttendAcrossFrames(const Tensor& qkv, int64_t heads) {
  const int64_t batch = qkv.size(0), frames = qkv.size(1), pixels = qkv.size(2), channels = qkv.size(3) / 3;
  const bool fits =
      CanTakeAll(qkv) && channels == heads * cuda::kFrameAttentionWidth && frames <= cuda::kFrameAttentionFrames;
  if (!fits) return {};
  const c10::DeviceGuard guard(qkv.device());
  Tensor out = at::empty({batch, frames, pixels, channels}, qkv.options());
  cuda::RunFrameAttention({batch, pixels, static_cast<int>(frames), static_cast<int>(heads), Bits(qkv), BitsOf(&out)},
                          cuda::kStream);
  return out;
}

}  // namespace oraclegs::seva::kernels

#else

namespace oraclegs::seva::kernels {

bool CanTake(const Tensor&) { return false; }
Tensor GatedGelu(const Tensor&) { return {}; }
Tensor Sum(const Tensor&, const Addend&, Tensor*) { return {}; }
Tensor NormOfSum(const Tensor&, const Addend&, const LayerNorm&, Tensor*) { return {}; }
Tensor NormMap(const GroupNorm&, const Tensor&, bool, const AroundNorm&) { return {}; }
Tensor AttendAcrossFrames(const Tensor&, int64_t) { return {}; }

}  // namespace oraclegs::seva::kernels

#endif

#include "oraclegs/networks/common/autocast.h"

#include <ATen/autocast_mode.h>
#include <torch/version.h>

namespace oraclegs {
namespace {

#if TORCH_VERSION_MAJOR > 2 || (TORCH_VERSION_MAJOR == 2 && TORCH_VERSION_MINOR >= 4)
bool IsEnabled(torch::Device device) { return at::autocast::is_autocast_enabled(device.type()); }
torch::ScalarType TypeOn(torch::Device device) { return at::autocast::get_autocast_dtype(device.type()); }
void Set(torch::Device device, bool enabled, torch::ScalarType type) {
  at::autocast::set_autocast_enabled(device.type(), enabled);
  at::autocast::set_autocast_dtype(device.type(), type);
}
#else
bool IsEnabled(torch::Device device) {
  return device.is_cuda() ? at::autocast::is_enabled() : at::autocast::is_cpu_enabled();
}
torch::ScalarType TypeOn(torch::Device device) {
  return device.is_cuda() ? at::autocast::get_autocast_gpu_dtype() : at::autocast::get_autocast_cpu_dtype();
}
void Set(torch::Device device, bool enabled, torch::ScalarType type) {
  if (device.is_cuda()) {
    at::autocast::set_enabled(enabled);
    at::autocast::set_autocast_gpu_dtype(type);
  } else {
    at::autocast::set_cpu_enabled(enabled);
    at::autocast::set_autocast_cpu_dtype(type);
  }
}
#endif

}  // namespace

torch::ScalarType HalfTypeOf(torch::Device device) { return device.is_cuda() ? torch::kHalf : torch::kBFloat16; }

Autocast::Autocast(torch::Device device, std::optional<torch::ScalarType> products)
    : device_(device), enabled_before_(IsEnabled(device)), type_before_(TypeOn(device)) {
  Set(device_, products.has_value(), products.value_or(type_before_));
}

Autocast::~Autocast() { Set(device_, enabled_before_, type_before_); }

}  // namespace oraclegs

// The kernels' gradients against differences of the kernels' own images. (cuda_rasterizer_test.cpp compares them with
// differences of the reference in double precision.)

#include <cmath>
#include <memory>

#include "render/cuda/device_scenes.h"

namespace oraclegs {
namespace {

class FiniteDifferencesTest : public CudaTest {
 protected:
  FiniteDifferencesTest() : task{RandomGaussians(5, 0.3, 31), FrontCamera(16, 14), {{0.2f, 0.6f, 0.4f}, 3, false}} {
    task.upstream = RandomUpstream(task.camera, 7);
  }

  /// <upstream, render> of the task.
  double Loss() {
    Gaussians g = OnTestDevice(task.gaussians);
    const RenderOutput out = rasterizer->Forward(g, task.camera, task.options, RenderPass::kInference);
    const auto dot = [](const Buffer<float>& a, const Buffer<float>& b) { return (Wide(a) * Wide(OnHost(b))).sum(); };
    return dot(task.upstream.image, out.image) + dot(task.upstream.alpha, out.alpha) +
           dot(task.upstream.inv_depth, out.inv_depth);
  }

  /// |difference quotient - gradient| of one number, the least of two steps: a pixel that crosses a threshold on the
  /// way is a jump, not a derivative.
  double Error(float* value, double gradient) {
    const float keep = *value;
    double best = 1e30;
    for (const float step : {4e-3f, 1e-3f}) {
      *value = keep + step;
      const double above = Loss(), moved_up = *value;
      *value = keep - step;
      const double derivative = (above - Loss()) / (moved_up - *value);
      best = std::min(best, std::abs(derivative - gradient));
      *value = keep;
    }
    return best;
  }

  RenderTask task;
  std::unique_ptr<Rasterizer> rasterizer;  // made by a test, which a machine without a device skips
};

TEST_F(FiniteDifferencesTest, MatchTheGradients) {
  rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask out = RunTask(rasterizer.get(), task, TestDevice());
  const auto check = [&](const char* name, Buffer<float>* values, const Buffer<float>& grad, int64_t stride) {
    const double largest = MaxAbs(grad);
    ASSERT_GT(largest, 0.01) << name;
    for (int64_t k = 0; k < grad.count(); k += stride) {
      EXPECT_LE(Error(values->data() + k, grad.data()[k]), 1e-2 * largest) << name << " " << k;
    }
  };
  check("means", &task.gaussians.means, out.grads.means, 1);
  check("log_scales", &task.gaussians.log_scales, out.grads.log_scales, 1);
  check("quats", &task.gaussians.quats, out.grads.quats, 1);
  check("opacity_logits", &task.gaussians.opacity_logits, out.grads.opacity_logits, 1);
  check("sh", &task.gaussians.sh, out.grads.sh, 11);
}

}  // namespace
}  // namespace oraclegs

// The shared per-Gaussian mathematics, compiled by nvcc, against the same source run in double on the host.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/render/splat_math-inl.h"
#include "support/cuda_device.h"

namespace oraclegs {
namespace {

constexpr int kSplats = 4096;
constexpr int kValues = 9 + 11 + 16 + 3 + kCameraSums;  // projection, gradient, SH basis, SH gradient, camera

/// Everything the header computes for one Gaussian, as one row.
template <class F>
ORACLEGS_HD void Evaluate(const float* in, bool antialiased, F* out) {
  SplatCamera<F> camera{};
  camera.antialiased = antialiased;
  camera.r[0] = camera.r[4] = camera.r[8] = F(1);
  camera.t[2] = F(0.5);
  camera.eye[2] = F(-0.5);
  camera.fx = F(200), camera.fy = F(210), camera.cx = F(64), camera.cy = F(60);
  camera.min_u = F(-0.45), camera.max_u = F(0.45), camera.min_v = F(-0.4), camera.max_v = F(0.4);
  const cuda::RawSplat<F> raw{{F(in[0]), F(in[1]), F(in[2])},
                              {F(in[3]), F(in[4]), F(in[5])},
                              F(in[6]),
                              F(in[7]),
                              F(in[8]),
                              F(in[9]),
                              F(in[10])};
  const auto chain = cuda::EvaluateChain(raw, camera);
  const auto p = cuda::Project(chain, camera);
  const cuda::ProjectedGrad<F> up{F(0.3), F(-0.2), F(0.7), F(0.1), F(-0.4), F(0.9), F(0.5)};
  const auto space = cuda::ProjectBackward(chain, camera, up);
  const auto g = cuda::RawBackward(chain, camera, space);
  const F projected[9] = {p.mx, p.my, p.z, p.conic_a, p.conic_b, p.conic_c, p.cov_a, p.cov_c, p.opacity};
  const F grad[11] = {g.mean.x, g.mean.y, g.mean.z, g.log_scale.x, g.log_scale.y, g.log_scale.z,
                      g.qw,     g.qx,     g.qy,     g.qz,          g.logit};
  const F norm = cuda::Sqrt(cuda::Dot(raw.mean, raw.mean));
  const cuda::Vec3<F> d{raw.mean.x / norm, raw.mean.y / norm, raw.mean.z / norm};
  F basis[16];
  cuda::ShBasis(3, d, basis);
  const cuda::Vec3<F> sh = cuda::ShGradient(3, d, basis);
  for (int k = 0; k < 9; ++k) out[k] = projected[k];
  for (int k = 0; k < 11; ++k) out[9 + k] = grad[k];
  for (int k = 0; k < 16; ++k) out[20 + k] = basis[k];
  out[36] = sh.x, out[37] = sh.y, out[38] = sh.z;
  const auto camera_terms = cuda::CameraBackward(chain, camera, up, space, g.mean);
  for (int k = 0; k < kCameraSums; ++k) out[39 + k] = camera_terms.of[k];
}

__global__ void EvaluateAll(const float* in, bool antialiased, float* out) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < kSplats) Evaluate<float>(in + 11 * i, antialiased, out + kValues * i);
}

std::vector<float> RandomInputs() {
  Rng rng(7, RandomStream::kInitialPoints);
  std::vector<float> in(11 * kSplats);
  for (int i = 0; i < kSplats; ++i) {
    const double z = rng.Uniform(1, 6);
    const double row[11] = {rng.Uniform(-0.5, 0.5) * z, rng.Uniform(-0.5, 0.5) * z, z,
                            rng.Uniform(-4, -1),        rng.Uniform(-4, -1),        rng.Uniform(-4, -1),
                            rng.Uniform(0.2, 1),        rng.Uniform(-1, 1),         rng.Uniform(-1, 1),
                            rng.Uniform(-1, 1),         rng.Uniform(-4, 4)};
    for (int k = 0; k < 11; ++k) in[11 * i + k] = static_cast<float>(row[k]);
  }
  return in;
}

/// Largest error relative to each column's size, since single gradients cancel.
void ExpectAgreesWithDouble(const std::vector<float>& in, bool antialiased, const std::vector<float>& out) {
  std::vector<double> error(kValues), size(kValues);
  for (int i = 0; i < kSplats; ++i) {
    double expected[kValues];
    Evaluate<double>(&in[11 * i], antialiased, expected);
    for (int k = 0; k < kValues; ++k) {
      error[k] = std::max(error[k], std::abs(out[kValues * i + k] - expected[k]));
      size[k] = std::max(size[k], std::abs(expected[k]));
    }
  }
  for (int k = 0; k < kValues; ++k) EXPECT_LE(error[k], 1e-4 * (size[k] + 1e-3)) << "value " << k;
}

class SplatMathHost : public testing::TestWithParam<bool> {};
class SplatMath : public OnDevice<testing::TestWithParam<bool>> {};

TEST_P(SplatMathHost, InFloat) {
  const std::vector<float> in = RandomInputs();
  std::vector<float> out(kValues * kSplats);
  for (int i = 0; i < kSplats; ++i) Evaluate<float>(&in[11 * i], GetParam(), &out[kValues * i]);
  ExpectAgreesWithDouble(in, GetParam(), out);
}

TEST_P(SplatMath, OnTheDevice) {
  const std::vector<float> in = RandomInputs();
  cuda::DeviceArray<float> device_in("in"), device_out("out");
  device_in.Upload(in.data(), static_cast<int64_t>(in.size()));
  device_out.Reserve(kValues * kSplats);
  cuda::Launch("EvaluateAll", EvaluateAll, cuda::LaunchShape::For(kSplats, 128), nullptr, device_in.data(), GetParam(),
               device_out.data());
  ExpectAgreesWithDouble(in, GetParam(), ToHost(device_out, kValues * kSplats));
}

const auto kModeName = [](const auto& info) { return std::string(info.param ? "antialiased" : "plain"); };
INSTANTIATE_TEST_SUITE_P(Modes, SplatMathHost, testing::Bool(), kModeName);
INSTANTIATE_TEST_SUITE_P(Modes, SplatMath, testing::Bool(), kModeName);

}  // namespace
}  // namespace oraclegs

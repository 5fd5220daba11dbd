#include "oraclegs/networks/cuda/kernels.h"

#include "networks/cuda/bfloat16.h"

namespace oraclegs::cuda {
namespace {

struct Maps {
  int images, pixels, channels, groups;
};

class GroupNormKernels : public OnDevice<testing::TestWithParam<Maps>> {
 protected:
  static constexpr int kRays = 6;

  void SetUp() override {
    OnDevice::SetUp();
    if (IsSkipped()) return;
    const auto [images, pixels, channels, groups] = GetParam();
    const Shape shape{images, pixels, channels};
    x = ToHalves(ToBuffer(shape, 3 + 2 * Flat(RandomNormal(shape, 1))));
    offsets = RandomHalves({images, channels}, 2);
    weight = RandomHalves({channels}, 3);
    bias = RandomHalves({channels}, 4);
    rays = RandomHalves({images, pixels, kRays}, 5);
    ray_weight = RandomHalves({2 * channels, kRays}, 6);
    ray_bias = RandomHalves({2 * channels}, 7);
    out = HalvesToFill(shape);
    in.images = images, in.pixels = pixels, in.channels = channels, in.groups = groups;
    in.x = x.bits();
    in.weight = weight.bits(), in.bias = bias.bits(), in.eps = 1e-5f;
    in.out = out.data();
  }
  void Run() {
    DeviceArray<GroupNormPair> sums("a test"), factors("a test");
    sums.ReserveExactly(GroupNormSums(in));
    factors.ReserveExactly(in.images * in.channels);
    RunGroupNorm(in, {sums.data(), factors.data()}, kStream);
    Check(cudaDeviceSynchronize(), "a test");
  }
  double Modulated(double y, int64_t pixel, int64_t c) const {
    const auto product = [&](int64_t row) {
      return (ray_weight.values.segment(row * kRays, kRays) * rays.values.segment(pixel * kRays, kRays)).sum() +
             ray_bias.values[row];
    };
    return y * (1 + product(c)) + product(in.channels + c);
  }
  Eigen::ArrayXd Expected() const {
    Eigen::ArrayXd result(x.values.size());
    const int64_t width = in.channels / in.groups;
    for (int64_t image = 0; image < in.images; ++image) {
      const auto at = [&](int64_t pixel, int64_t c) { return (image * in.pixels + pixel) * in.channels + c; };
      const auto value = [&](int64_t pixel, int64_t c) {
        return x.values[at(pixel, c)] + (in.offsets != nullptr ? offsets.values[image * in.channels + c] : 0.0);
      };
      for (int64_t group = 0; group < in.groups; ++group) {
        Eigen::ArrayXd all(in.pixels * width);
        for (int64_t i = 0; i < all.size(); ++i) all[i] = value(i / width, group * width + i % width);
        const double mean = all.mean(), deviation = std::sqrt((all - mean).square().mean() + 1e-5);
        for (int64_t i = 0; i < all.size(); ++i) {
          const int64_t pixel = i / width, c = group * width + i % width;
          double y = (all[i] - mean) / deviation * weight.values[c] + bias.values[c];
          if (in.silu) y /= 1 + std::exp(-y);
          if (in.rays > 0) y = Modulated(y, image * in.pixels + pixel, c);
          result[at(pixel, c)] = y;
        }
      }
    }
    return result;
  }
  void ExpectRight() {
    Run();
    EXPECT_LE(ErrorBeyondRounding(ValuesOf(out), Expected(), 1e-4), 0);
  }

  Halves x, offsets, weight, bias, rays, ray_weight, ray_bias;
  Buffer<uint16_t> out;
  GroupNorm in;
};

TEST_P(GroupNormKernels, NormalizeEachGroup) { ExpectRight(); }

TEST_P(GroupNormKernels, AddOffsetsBeforeAndSiluAfter) {
  in.offsets = offsets.bits();
  in.silu = true;
  ExpectRight();
}

TEST_P(GroupNormKernels, ModulateByRays) {
  in.offsets = offsets.bits();
  in.silu = true;
  in.rays = kRays, in.ray_maps = rays.bits(), in.ray_weight = ray_weight.bits(), in.ray_bias = ray_bias.bits();
  ExpectRight();
}

TEST_P(GroupNormKernels, TheResultMayReplaceX) {
  in.silu = true;
  in.out = x.device.data();
  Run();
  EXPECT_LE(ErrorBeyondRounding(ValuesOf(x.device), Expected(), 1e-4), 0);
}

// One group of two channels; blocks of pixels that end early; more pairs of channels than a block has threads.
INSTANTIATE_TEST_SUITE_P(Shapes, GroupNormKernels,
                         testing::Values(Maps{1, 1, 2, 1}, Maps{2, 70, 64, 32}, Maps{1, 9, 320, 32},
                                         Maps{2, 5, 960, 32}, Maps{1, 3, 2560, 32}, Maps{1, 130, 12, 3}));

}  // namespace
}  // namespace oraclegs::cuda

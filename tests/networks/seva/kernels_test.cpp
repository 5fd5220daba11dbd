// On a GPU, in a build with CUDA; in all others on the emulated device, for which kernels.cpp is compiled once more,
// and to which every bfloat16 tensor of the CPU goes.

#include "oraclegs/networks/seva/kernels.h"

#include "networks/fixtures.h"
#include "oraclegs/networks/seva/unet.h"
#include "support/cuda_device.h"

namespace oraclegs::seva {
namespace {

const torch::Device kDevice = kEmulatedCuda ? torch::kCPU : torch::kCUDA;

Tensor Noise(at::IntArrayRef shape, double seed) {
  const Tensor x = at::arange(c10::multiply_integers(shape), torch::kDouble);
  return at::sin(x * 12.9898 + seed).mul(43758.5453).frac().mul(2).view(shape).to(torch::kFloat);
}
/// Noise that bfloat16 holds exactly.
Tensor HalfNoise(at::IntArrayRef shape, double seed) { return Noise(shape, seed).to(kDevice, torch::kBFloat16); }
Tensor Wide(const Tensor& x) { return x.to(torch::kCPU, torch::kFloat); }

/// Relative error of rounding once, where a composition of libtorch's operations rounds after each.
constexpr double kRounding = 0.003;

class SevaKernels : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (!kEmulatedCuda && !torch::cuda::is_available()) GTEST_SKIP() << "libtorch finds no GPU";
  }
};

TEST_F(SevaKernels, TakeHalvesOnTheirDeviceOnly) {
  EXPECT_TRUE(kernels::CanTake(HalfNoise({2}, 1)));
  EXPECT_FALSE(kernels::CanTake(Noise({2}, 1)));
  EXPECT_FALSE(kernels::GatedGelu(HalfNoise({2, 12}, 1)).defined());                     // halves of 6
  EXPECT_FALSE(kernels::AttendAcrossFrames(HalfNoise({1, 2, 3, 192}, 1), 2).defined());  // heads of 32
  EXPECT_FALSE(kernels::AttendAcrossFrames(HalfNoise({1, 25, 1, 192}, 1), 1).defined());
  Tensor sum;
  EXPECT_FALSE(kernels::Sum(HalfNoise({1, 2000}, 1), {}, &sum).defined());
  EXPECT_FALSE(kernels::Sum(HalfNoise({4, 64}, 1).t(), {}, &sum).defined());
  EXPECT_FALSE(sum.defined());
}

TEST_F(SevaKernels, GateAsLibtorch) {
  const Tensor both = HalfNoise({3, 5, 48}, 1), wide = Wide(both);
  const Tensor y = kernels::GatedGelu(both);
  EXPECT_LT(RelativeL2(y, wide.slice(2, 0, 24) * at::gelu(wide.slice(2, 24, 48))), kRounding);
}

TEST_F(SevaKernels, SumAndNormalizeAsLibtorch) {
  const Tensor x = HalfNoise({2, 6, 64}, 1), rows = HalfNoise({2, 6, 64}, 2), vectors = HalfNoise({2, 1, 64}, 3);
  const LayerNorm norm{HalfNoise({64}, 4), HalfNoise({64}, 5), 1e-5};
  const Tensor expected = Wide(x) + Wide(rows) + Wide(vectors);
  const Tensor normed = at::layer_norm(expected, {64}, Wide(norm.weight), Wide(norm.bias), norm.eps);
  Tensor sum;
  EXPECT_LT(RelativeL2(kernels::NormOfSum(x, {rows, vectors}, norm, &sum), normed), kRounding);
  EXPECT_LT(RelativeL2(sum, expected), kRounding);
  EXPECT_LT(RelativeL2(Sum(x, {rows, vectors}), expected), kRounding);
  Tensor changed = x.clone();
  EXPECT_LT(RelativeL2(NormAfterAdding({rows, vectors}, norm, &changed), normed), kRounding);
  EXPECT_LT(RelativeL2(changed, expected), kRounding);
  EXPECT_LT(RelativeL2(NormOfSum(x, {rows, {}}, norm, &changed),
                       at::layer_norm(Wide(x) + Wide(rows), {64}, Wide(norm.weight), Wide(norm.bias), norm.eps)),
            kRounding);
  EXPECT_LT(RelativeL2(changed, Wide(x) + Wide(rows)), kRounding);
}

TEST_F(SevaKernels, NormalizeMapsAsLibtorch) {
  GroupNorm layer{HalfNoise({64}, 1), HalfNoise({64}, 2), 32, 1e-5, true};
  Conv modulation{HalfNoise({128, 6, 1, 1}, 3), HalfNoise({128}, 4), 1, 0, true};
  const Tensor x = HalfNoise({2, 64, 5, 7}, 5).contiguous(at::MemoryFormat::ChannelsLast);
  const Tensor rays = HalfNoise({2, 6, 5, 7}, 6).contiguous(at::MemoryFormat::ChannelsLast),
               offsets = HalfNoise({2, 64}, 7);
  const auto normed = [&](const Tensor& wide) {
    return at::group_norm(wide, 32, Wide(layer.weight), Wide(layer.bias), layer.eps);
  };
  EXPECT_LT(RelativeL2(Forward(layer, x), normed(Wide(x))), kRounding);
  EXPECT_TRUE(HasChannelsLast(Forward(layer, x)));
  EXPECT_LT(RelativeL2(NormThenSilu(layer, x), at::silu(normed(Wide(x)))), kRounding);
  const Tensor scale_shift = at::conv2d(Wide(rays), Wide(modulation.weight), Wide(modulation.bias));
  const Tensor y = at::silu(normed(Wide(x) + Wide(offsets).unsqueeze(-1).unsqueeze(-1)));
  EXPECT_LT(RelativeL2(NormThenSilu(layer, x, {offsets, &modulation, rays}),
                       y * (1 + scale_shift.slice(1, 0, 64)) + scale_shift.slice(1, 64, 128)),
            kRounding);
}

TEST_F(SevaKernels, AttendAcrossFramesAsLibtorch) {
  const Tensor qkv = HalfNoise({2, 7, 3, 3 * 128}, 1);
  const Tensor parts = Wide(qkv).view({2, 7, 3, 3, 2, 64}).permute({3, 0, 2, 4, 1, 5});
  const Tensor weights = at::softmax(at::matmul(parts[0], parts[1].transpose(-1, -2)) / 8, -1);
  const Tensor expected = at::matmul(weights, parts[2]).permute({0, 3, 1, 2, 4}).reshape({2, 7, 3, 128});
  EXPECT_LT(RelativeL2(kernels::AttendAcrossFrames(qkv, 2), expected), kRounding);
}

/// Made-up weights, of the sizes that the kernels take.
UnetConfig Config() {
  UnetConfig config;
  config.channels = 64;
  config.channel_mult = {1, 2};
  config.res_blocks = 1;
  config.attention_downscales = {1, 2};
  config.transformer_depth = {1, 2};
  config.context_width = 24;
  config.joint = {"middle_ds2"};
  return config;
}

/// Made-up weights rounded to bfloat16, returned in either type.
class Rounded : public ParameterSource {
 public:
  explicit Rounded(const at::TensorOptions& options) : options_(options) {}
  Tensor Get(const std::string& name, at::IntArrayRef shape) override {
    const Tensor made = random_.Get(name, shape);
    // Biases that a test would miss if one were left out.
    return (name.ends_with("bias") ? made * 10 : made).to(torch::kBFloat16).to(options_);
  }
  void Unused(const std::string&, at::IntArrayRef) override {}

 private:
  RandomParameters random_{3};
  at::TensorOptions options_;
};

/// The network in float, and in bfloat16 for the kernels.
struct Networks {
  Rounded wide_source{at::TensorOptions().dtype(torch::kFloat)};
  Rounded half_source{at::TensorOptions().dtype(torch::kBFloat16).device(kDevice)};
  Unet wide = LoadUnet(wide_source, Config()), halves = LoadUnet(half_source, Config());
};

/// Two sequences of that many frames, with their conditioning.
struct Inputs {
  Tensor x, steps;
  Conditions conditions;

  Inputs(int64_t frames, int64_t context_tokens)
      : x(Noise({2 * frames, 11, 8, 8}, 1)), steps(at::full({2 * frames}, 500, torch::kLong)) {
    conditions = {Noise({2 * frames, context_tokens, 24}, 2), Noise({2 * frames, 6, 8, 8}, 3), frames, 8, 8};
  }
};

TEST_F(SevaKernels, AResidualBlockStaysCloseToFloat) {
  const Networks networks;
  const Inputs in(3, 1);
  const auto& wide = std::get<ResBlock>(networks.wide.output_blocks.at(1).at(0));  // with a skip convolution
  const auto& halves = std::get<ResBlock>(networks.halves.output_blocks.at(1).at(0));
  ASSERT_TRUE(wide.skip && halves.norm_in.channels_last);
  const int64_t channels = wide.conv_in.weight.size(1);
  const auto half = [](const Tensor& map) {
    return map.to(kDevice, torch::kBFloat16).contiguous(at::MemoryFormat::ChannelsLast);
  };
  const Tensor x = Wide(half(Noise({6, channels, 8, 8}, 4))), rays = Wide(half(in.conditions.dense));
  const Tensor embedding = Wide(HalfNoise({6, Config().embedding_width()}, 5));
  EXPECT_LT(RelativeL2(Forward(halves, half(x), embedding.to(kDevice, torch::kBFloat16), half(rays)),
                       Forward(wide, x, embedding, rays)),
            0.01);
}

TEST_F(SevaKernels, ATransformerStaysCloseToFloat) {
  const Networks networks;
  for (const auto& [frames, context_tokens] : std::vector<std::pair<int64_t, int64_t>>{{3, 1}, {3, 3}, {25, 1}}) {
    const Inputs in(frames, context_tokens);
    const auto& wide = std::get<MultiView>(networks.wide.middle.at(1));
    const auto& halves = std::get<MultiView>(networks.halves.middle.at(1));
    const Tensor x = HalfNoise({2 * frames, 128, 4, 4}, 4).contiguous(at::MemoryFormat::ChannelsLast);
    const Tensor context = HalfNoise({2 * frames, context_tokens, 24}, 5);
    EXPECT_LT(RelativeL2(Forward(halves, x, PrepareContext(halves, context, frames), frames),
                         Forward(wide, Wide(x).contiguous(), PrepareContext(wide, Wide(context), frames), frames)),
              0.01)
        << frames << " frames, " << context_tokens << " context tokens";
  }
}

TEST_F(SevaKernels, AWholeNetworkStaysCloseToFloat) {
  const Networks networks;
  for (const int64_t context_tokens : {1, 3}) {
    const Inputs in(3, context_tokens);
    const auto run = [&](const Unet& unet) { return Forward(unet, in.x, in.steps, Prepare(unet, in.conditions)); };
    EXPECT_LT(RelativeL2(run(networks.halves), run(networks.wide)), 0.03);
  }
}

}  // namespace
}  // namespace oraclegs::seva

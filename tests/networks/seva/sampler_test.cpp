#include "oraclegs/networks/seva/sampler.h"

#include "networks/seva/sampling_fixture.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs::seva {
namespace {

TEST(SevaSampler, EveryEulerStateMatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const Tensor eps = GoldenFloat(file, "euler.eps"), states = GoldenTensor(file, "euler.x_after_step");
  const float a = file.Values<float>("euler.a").at(0);
  const auto steps = static_cast<int>(eps.size(0));
  EulerProblem problem;
  problem.sigmas = Sigmas(MakeSchedule(), steps);
  problem.denoise = [a](const Tensor& x, float sigma) { return x * a / (1 + sigma); };
  problem.noise = [&](int64_t step) { return eps[step]; };
  int told = 0;
  problem.after_step = [&](int64_t step, const Tensor& x) {
    EXPECT_EQ(step, told++);
    ExpectRatio(x, states[step], 1e-5, "step " + std::to_string(step));
  };
  ExpectRatio(SampleEuler(GoldenFloat(file, "euler.x_init_unit"), problem), GoldenTensor(file, "euler.x_final"), 1e-5,
              "result");
  EXPECT_EQ(told, steps);
  const std::vector<float> factors = file.Values<float>("euler.noise_scale");
  for (size_t i = 0; i < factors.size(); ++i) EXPECT_NEAR(EulerNoiseFactor(problem.sigmas[i]), factors[i], 1e-6) << i;
}

/// The network that the fixture's metadata describes.
Tensor AnalyticNetwork(const Tensor& x, int64_t index, const Tensor& concat, const Tensor& context) {
  return 0.6 * x + 0.25 * std::sin(0.01 * static_cast<double>(index)) * concat.slice(1, 1, 5) +
         0.3 * at::tanh(at::roll(x, 1, 1)) * (0.5 + concat.slice(1, 0, 1)) +
         0.1 * context.mean({1, 2}).view({-1, 1, 1, 1});
}

TEST(SevaFullSampling, MatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const std::string name = "full.multiview";
  const std::vector<bool> given = GoldenMask(file, "full.input_frame_mask");
  const Tensor rays = GoldenFloat(file, "full.plucker"), context = GoldenFloat(file, "full.crossattn");
  const Tensor mask = AsTensor(given).to(torch::kFloat).view({-1, 1, 1, 1}).expand_as(rays.slice(1, 0, 1));
  const Tensor concat = at::cat({at::cat({at::zeros_like(mask), rays}, 1), at::cat({mask, rays}, 1)}, 0);
  const Tensor contexts = at::cat({at::zeros_like(context), context}, 0);
  const Schedule schedule = MakeSchedule();
  const int64_t probe = file.Values<int64_t>("full.probe_call").at(0);
  int64_t calls = 0;
  std::vector<int64_t> indices;
  Denoiser denoiser;
  denoiser.schedule = &schedule;
  denoiser.given = GoldenFloat(file, "full.replace");
  denoiser.weights =
      GuidanceWeights(GoldenViews(file, "full.c2w", "full.K"), given, file.Values<double>("full.cfg").at(0));
  denoiser.network = [&](const Tensor& scaled, int64_t index) {
    indices.push_back(index);
    const Tensor out = AnalyticNetwork(scaled, index, concat, contexts);
    if (++calls == probe) {
      EXPECT_EQ(index, file.Values<int64_t>("full.probe_idx").at(0));
      ExpectRatio(scaled, GoldenTensor(file, "full.probe_net_in"), 1e-4, "what the network is given");
      ExpectRatio(out, GoldenTensor(file, "full.probe_net_out"), 1e-4, "what it answers");
    }
    return out;
  };
  const Tensor eps = GoldenFloat(file, name + ".eps"), states = GoldenTensor(file, name + ".x_after_step");
  const std::vector<int64_t> stored = file.Values<int64_t>(name + ".step_index");
  EulerProblem problem;
  problem.sigmas = Sigmas(schedule, static_cast<int>(eps.size(0)));
  problem.denoise = [&](const Tensor& x, float sigma) { return Denoise(denoiser, x, sigma); };
  problem.noise = [&](int64_t step) { return eps[step]; };
  problem.after_step = [&](int64_t step, const Tensor& x) {
    for (size_t i = 0; i < stored.size(); ++i) {
      if (stored[i] == step) ExpectRatio(x, states[static_cast<int64_t>(i)], 1e-4, "step " + std::to_string(step));
    }
  };
  ExpectRatio(SampleEuler(GoldenFloat(file, "full.x_init_unit"), problem), GoldenTensor(file, name + ".x_final"), 1e-4,
              "result");
  EXPECT_EQ(indices, file.Values<int64_t>("full.c_noise_per_step"));
}

TEST(SevaSampler, NeedsTwoSigmas) { EXPECT_THROW(SampleEuler(torch::zeros({1, 4, 2, 2}), {{1.f}}), ShapeError); }

TEST(SevaNoise, IsStandardNormalAndDependsOnEveryPartOfItsKey) {
  const Tensor noise = Noise({7, 2, 3}, {40, 4, 31, 33});
  EXPECT_NEAR(noise.mean().item<double>(), 0, 0.01);
  EXPECT_NEAR(noise.std().item<double>(), 1, 0.01);
  EXPECT_NEAR(noise.pow(4).mean().item<double>(), 3, 0.1);
  for (const NoiseKey& other : {NoiseKey{8, 2, 3}, NoiseKey{7, 3, 3}, NoiseKey{7, 2, 4}}) {
    EXPECT_LE(std::abs((noise * Noise(other, noise.sizes())).mean().item<double>()), 0.01);
  }
}

TEST(SevaNoise, SameBitsForAnyNumberOfThreads) {
  const int before = NumThreads();
  SetNumThreads(1);
  const Tensor one = Noise({1, 1, 1}, {3, 4, 61, 67});
  SetNumThreads(3);
  const Tensor three = Noise({1, 1, 1}, {3, 4, 61, 67});
  SetNumThreads(before);
  EXPECT_TRUE(torch::equal(one, three));
}

TEST(SevaGuidance, WeightsAndResultsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> views = GoldenViews(file, "cfg.c2w", "cfg.K");
  const std::vector<bool> given = GoldenMask(file, "cfg.input_frame_mask");
  ASSERT_EQ(static_cast<float>(file.Values<double>("cfg.min").at(0)), static_cast<float>(kGuidanceBesideAnImage));
  const Tensor both = GoldenFloat(file, "cfg.x_uncond_cond");
  const auto frames = static_cast<int64_t>(views.size());
  const Tensor plain = both.slice(0, 0, frames), conditional = both.slice(0, frames);
  const Tensor weights = GuidanceWeights(views, given, file.Values<double>("cfg.scale").at(0));
  ExpectRatio(weights, GoldenTensor(file, "cfg.multiview_scale"), 1e-5, "weights");
  ExpectRatio(plain + weights.view({-1, 1, 1, 1}) * (conditional - plain), GoldenTensor(file, "cfg.multiview_out"),
              1e-5, "result");
}

TEST(SevaGuidance, RotationsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> views = GoldenViews(file, "cfg.c2w");
  const std::vector<bool> given = GoldenMask(file, "cfg.input_frame_mask");
  const std::vector<double> expected = file.Values<double>("cfg.rotation_dist_deg");
  size_t place = 0;
  for (const View& view : views) {
    for (size_t j = 0; j < views.size(); ++j) {
      if (!given[j]) continue;
      const double degrees = RotationDegrees(view.world_from_camera.linear(), views[j].world_from_camera.linear());
      EXPECT_NEAR(degrees, expected.at(place++), 0.05);
    }
  }
}

TEST(SevaGuidance, RefusesFramesOfWhichNoneIsGiven) {
  EXPECT_THROW(GuidanceWeights({View{}}, {false}, 3), ShapeError);
  EXPECT_THROW(GuidanceWeights({View{}}, {true, true}, 3), ShapeError);
}

}  // namespace

}  // namespace oraclegs::seva

#include "oraclegs/networks/seva/schedule.h"

#include "networks/seva/sampling_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaSchedule, LevelsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const Schedule shifted = MakeSchedule(), plain = MakeSchedule(0);
  ExpectRatio(AsTensor(shifted.alphas_cumprod), GoldenTensor(file, "sched.alphas_cumprod"), 1e-5, "alphas");
  ExpectRatio(AsTensor(shifted.sigmas), GoldenTensor(file, "sched.sigmas_1000_ascending"), 1e-5, "sigmas");
  ExpectRatio(AsTensor(plain.sigmas), GoldenTensor(file, "sched.sigmas_1000_ascending_noshift"), 1e-5, "no shift");
}

TEST(SevaSchedule, StepsVisitTheOfficialLevels) {
  const SafetensorsFile file = SamplingFixture();
  for (const std::string name : {"sched.a.", "sched.b."}) {
    const auto steps = static_cast<int>(file.Values<int64_t>(name + "num_steps").at(0));
    std::vector<int64_t> ascending = StepIndices(steps);
    std::reverse(ascending.begin(), ascending.end());
    EXPECT_EQ(ascending, file.Values<int64_t>(name + "timesteps_ascending"));
    ExpectRatio(AsTensor(Sigmas(MakeSchedule(), steps)), GoldenTensor(file, name + "sigmas"), 1e-5, name);
    ExpectRatio(AsTensor(Sigmas(MakeSchedule(0), steps)), GoldenTensor(file, name + "sigmas_noshift"), 1e-5, name);
  }
}

TEST(SevaSchedule, AnyNumberOfStepsFallsThroughTheLevels) {
  for (const int steps : {1, 2, 37, 999, 1000}) {
    const std::vector<int64_t> indices = StepIndices(steps);
    ASSERT_EQ(indices.size(), static_cast<size_t>(steps));
    EXPECT_EQ(indices.front(), 999);
    EXPECT_GE(indices.back(), 0);
    for (size_t i = 1; i < indices.size(); ++i) EXPECT_LT(indices[i], indices[i - 1]);
  }
  EXPECT_THROW(StepIndices(0), ShapeError);
  EXPECT_THROW(StepIndices(1001), ShapeError);
}

TEST(SevaSchedule, ScalingMatchesTheOfficialDenoiser) {
  const SafetensorsFile file = SamplingFixture();
  const Schedule schedule = MakeSchedule();
  std::vector<int64_t> indices;
  std::vector<float> sigmas, skips, outs, ins;
  for (const float sigma : file.Values<float>("denoiser.sigma_in")) {
    const Scaling scaling = ScalingAt(schedule, sigma);
    indices.push_back(scaling.index);
    sigmas.push_back(scaling.sigma);
    skips.push_back(scaling.c_skip);
    outs.push_back(scaling.c_out);
    ins.push_back(scaling.c_in);
  }
  EXPECT_EQ(indices, file.Values<int64_t>("denoiser.idx"));
  EXPECT_EQ(indices, file.Values<int64_t>("denoiser.c_noise"));
  ExpectRatio(AsTensor(sigmas), GoldenTensor(file, "denoiser.sigma_quantized"), 1e-6, "sigma");
  ExpectRatio(AsTensor(skips), GoldenTensor(file, "denoiser.c_skip"), 1e-6, "skip");
  ExpectRatio(AsTensor(outs), GoldenTensor(file, "denoiser.c_out"), 1e-6, "out");
  ExpectRatio(AsTensor(ins), GoldenTensor(file, "denoiser.c_in"), 1e-6, "in");
}

}  // namespace
}  // namespace oraclegs::seva

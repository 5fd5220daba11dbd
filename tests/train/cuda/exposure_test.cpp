#include "oraclegs/train/cuda/exposure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/train/exposure.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

namespace oraclegs::cuda {
namespace {

constexpr int kViews = 300, kView = 2;  // more views than threads

class CudaExposure : public CudaTest {
 protected:
  std::vector<ExposureMap> start;
  Buffer<float> image, upstream;
  DeviceArray<float> maps{"a test"}, m{"a test"}, v{"a test"};
  DeviceArray<int64_t> steps{"a test"};
  DeviceArray<double> sums{"a test"}, regularizer{"a test"};

  void SetUp() override {
    CudaTest::SetUp();
    const Buffer<float> offsets = RandomNormal({kViews, 12}, 4);
    for (int i = 0; i < kViews; ++i) {
      ExposureMap map = kIdentityExposure;
      for (int k = 0; k < 12; ++k) map[k] += 0.2f * offsets[12 * i + k];
      start.push_back(map);
    }
    image = RandomUniform({61, 43, 3}, 5);
    upstream = RandomNormal({61, 43, 3}, 6);
    Flat(upstream) /= 1000;
  }

  ExposureRows Upload(const ExposureState& state) {
    const auto views = static_cast<int64_t>(state.maps.size());
    maps.Upload(state.maps[0].data(), 12 * views);
    m.Upload(state.m[0].data(), 12 * views);
    v.Upload(state.v[0].data(), 12 * views);
    steps.Upload(state.steps.data(), views);
    sums.Reserve(12 * ExposureBlocks(image.count() / 3));
    regularizer.Reserve(1);
    return {static_cast<int>(views), maps.data(), m.data(), v.data(), steps.data()};
  }

  ExposureStepInput Step(const ExposureRows& rows) {
    ExposureStepInput in;
    in.rows = rows;
    in.view = kView;
    in.sums = sums.data();
    in.blocks = ExposureBlocks(image.count() / 3);
    in.learning_rate = 0.01;
    in.weight = kExposureRegularizer;
    in.regularizer = regularizer.data();
    return in;
  }

  void ExpectMaps(const DeviceArray<float>& device, const std::vector<ExposureMap>& expected) {
    const std::vector<float> values = ToHost(device, 12 * static_cast<int64_t>(expected.size()));
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], expected[i / 12][i % 12], 1e-6) << i;
  }
};

TEST_F(CudaExposure, AppliesAndLearnsAsTheCpuDoes) {
  Exposures expected(start);
  const ExposureRows rows = Upload(expected.state());
  const Buffer<float> x = OnTestDevice(image), shown = Buffer<float>::Empty(x.shape(), TestDevice());
  for (int i = 0; i < 3; ++i) {
    Buffer<float> expected_shown = Buffer<float>::Empty(image.shape()), expected_grad = upstream.Clone();
    expected.Apply(kView, image, expected_shown);
    ExposureGradient gradient = expected.Backward(kView, image, expected_grad);
    const double expected_regularizer = expected.AddRegularizer(kView, kExposureRegularizer, &gradient);

    const Buffer<float> grad = OnTestDevice(upstream);
    ExposurePixels pixels;
    pixels.pixels = image.count() / 3;
    pixels.map = rows.maps + 12 * kView;
    pixels.image = x.data();
    pixels.shown = shown.data();
    pixels.grad = grad.data();
    pixels.sums = sums.data();
    RunExposureApply(pixels, nullptr);
    RunExposureBackward(pixels, nullptr);
    EXPECT_LE(MaxAbsError(OnHost(shown), expected_shown), 1e-6);
    EXPECT_LE(MaxAbsError(OnHost(grad), expected_grad), 1e-8);

    RunExposureStep(Step(rows), nullptr);
    expected.Step(kView, gradient, 0.01);
    EXPECT_NEAR(ToHost(regularizer, 1)[0], expected_regularizer, 1e-9);
    ExpectMaps(maps, expected.maps());
    ExpectMaps(m, expected.state().m);
    ExpectMaps(v, expected.state().v);
    EXPECT_EQ(ToHost(steps, kViews), expected.state().steps);
  }
}

TEST_F(CudaExposure, TheLastIterationOnlyTellsTheRegularizer) {
  const Exposures expected(start);
  const ExposureRows rows = Upload(expected.state());
  sums.FillBytes(0, sums.capacity(), nullptr);
  ExposureStepInput in = Step(rows);
  in.moves = false;
  RunExposureStep(in, nullptr);
  ExpectMaps(maps, expected.maps());
  EXPECT_EQ(ToHost(steps, kViews)[kView], 0);
  EXPECT_GT(ToHost(regularizer, 1)[0], 0);
}

TEST_F(CudaExposure, AMeanWithoutAnInverseBreaksTheLoss) {
  ExposureState state{{ExposureMap{}, ExposureMap{}, ExposureMap{}}, {}, {}, {0, 0, 0}};
  state.m = state.v = state.maps;
  const ExposureRows rows = Upload(state);
  sums.FillBytes(0, sums.capacity(), nullptr);
  RunExposureStep(Step(rows), nullptr);
  EXPECT_TRUE(std::isnan(ToHost(regularizer, 1)[0]));
}

}  // namespace
}  // namespace oraclegs::cuda

#include "oraclegs/validate/logistic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

struct Data {
  Eigen::MatrixXf features;
  Eigen::VectorXf labels;
};

/// Labels that a known logistic function of two of three features gives; the third never changes.
Data Known(int samples) {
  Rng rng(5, RandomStream::kDemoScene);
  Data data{Eigen::MatrixXf(samples, 3), Eigen::VectorXf(samples)};
  for (int s = 0; s < samples; ++s) {
    const double a = rng.Uniform(-1, 1), b = rng.Uniform(10, 30);
    data.features.row(s) = Eigen::RowVector3f(static_cast<float>(a), static_cast<float>(b), 7.f);
    data.labels[s] = static_cast<float>(1 / (1 + std::exp(-(2 * a - 0.1 * (b - 20) + 0.5 * a * a))));
  }
  return data;
}

TEST(Logistic, FindsTheProbabilityBehindSoftLabels) {
  const Data data = Known(20000);
  const Logistic model = Logistic::Fit(data.features, data.labels);
  for (const int s : {0, 1, 17, 4000, 19999}) {
    const Eigen::VectorXf row = data.features.row(s);
    EXPECT_NEAR(model(row.data()), data.labels[s], 0.02f) << s;
  }
}

TEST(Logistic, MeanOfItsAnswersIsTheMeanOfTheLabels) {
  Data data = Known(5000);
  for (int s = 0; s < 5000; ++s) data.labels[s] = s % 3 == 0 ? 1.f : 0.f;  // nothing the features know of
  const Logistic model = Logistic::Fit(data.features, data.labels);
  double mean = 0;
  for (int s = 0; s < 5000; ++s) {
    const Eigen::VectorXf row = data.features.row(s);
    mean += model(row.data()) / 5000.0;
  }
  EXPECT_NEAR(mean, 1 / 3.0, 1e-3);
}

TEST(Logistic, HasTheSameBitsForAnyNumberOfThreads) {
  const Data data = Known(9000);
  const Eigen::VectorXf row = data.features.row(3);
  SetNumThreads(1);
  const float one = Logistic::Fit(data.features, data.labels)(row.data());
  SetNumThreads(5);
  const float five = Logistic::Fit(data.features, data.labels)(row.data());
  SetNumThreads(0);
  EXPECT_EQ(one, five);
}

TEST(Logistic, ClampsFeaturesToTheTaughtRange) {
  Data data = Known(4000);
  data.features(7, 0) = 50;  // one sample is no range
  const Logistic model = Logistic::Fit(data.features, data.labels);
  const float at_the_end[3] = {0.995f, 20, 7}, beyond[3] = {4, 20, 7}, far_beyond[3] = {1e6f, 20, 1e6f};
  EXPECT_NEAR(model(beyond), model(at_the_end), 0.01f);
  EXPECT_EQ(model(far_beyond), model(beyond));
}

TEST(Logistic, AnswersOneHalfBeforeItHasLearned) {
  const float x[3] = {1, 2, 3};
  EXPECT_EQ(Logistic()(x), 0.5f);
}

TEST(Logistic, RefusesSamplesWithoutLabels) {
  EXPECT_THROW(Logistic::Fit(Eigen::MatrixXf(3, 2), Eigen::VectorXf(2)), ShapeError);
  EXPECT_THROW(Logistic::Fit(Eigen::MatrixXf(0, 2), Eigen::VectorXf(0)), ShapeError);
}

}  // namespace
}  // namespace oraclegs

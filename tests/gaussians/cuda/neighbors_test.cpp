#include "oraclegs/gaussians/cuda/neighbors.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/gaussians/cuda/neighbor_tree.h"
#include "oraclegs/gaussians/neighbors.h"
#include "support/cuda_device.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

using Points = std::vector<Eigen::Vector3f>;

class CudaNeighbors : public CudaTest {
 protected:
  Eigen::Vector3f InCube() {
    return {static_cast<float>(rng.Uniform(-1, 1)), static_cast<float>(rng.Uniform(-1, 1)),
            static_cast<float>(rng.Uniform(-1, 1))};
  }
  Points Cube(int n) {
    Points points;
    for (int i = 0; i < n; ++i) points.push_back(InCube());
    return points;
  }

  static void ExpectAgreement(const Points& points) {
    const std::vector<double> expected = KdTree(points).MeanSquaredDistanceToThree();
    const std::vector<double> actual = MeanSquaredDistanceToThree(points);
    ASSERT_EQ(actual.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(actual[i], expected[i], 1e-14 * expected[i]) << i;
  }

  Rng rng{5, RandomStream::kInitialPoints};
};

TEST_F(CudaNeighbors, AgreeWithTheCpu) {
  for (const int n : {0, 1, 2, 3, 4, 5, 12, 13, 24, 25, 26, 100, 257, 1500}) ExpectAgreement(Cube(n));
}

TEST_F(CudaNeighbors, AgreeWhereDensityVaries) {
  Points points = Cube(100);
  for (int i = 0; i < 400; ++i) points.push_back(Eigen::Vector3f(0.3f, 0.2f, -5) + 1e-4f * InCube());
  for (int i = 0; i < 400; ++i) points.push_back(Eigen::Vector3f(-40, 3, 7) + 1e-2f * InCube());
  for (const float far : {1e6f, -1e12f, 3e38f}) points.emplace_back(far, 0, -far);
  ExpectAgreement(points);
}

TEST_F(CudaNeighbors, AgreeOnALineAndInAPlane) {
  Points line, plane;
  for (int i = 0; i < 300; ++i) line.push_back(static_cast<float>(rng.Uniform()) * Eigen::Vector3f(1, -2, 3));
  for (int i = 0; i < 300; ++i) plane.push_back(InCube().cwiseProduct(Eigen::Vector3f(1, 0, 1)));
  ExpectAgreement(line);
  ExpectAgreement(plane);
  Points grid;  // every distance is tied
  for (int i = 0; i < 1000; ++i) grid.emplace_back(i % 10, i / 10 % 10, i / 100);
  for (const double d : MeanSquaredDistanceToThree(grid)) EXPECT_EQ(d, 1);
}

TEST_F(CudaNeighbors, DuplicatesAreAtDistanceZero) {
  for (const double d : MeanSquaredDistanceToThree(Points(500, Eigen::Vector3f(1, 2, 3)))) EXPECT_EQ(d, 0);
  Points pairs = Cube(300);
  pairs.insert(pairs.end(), pairs.begin(), pairs.begin() + 150);
  pairs.emplace_back(0.f, -0.f, 0.f);
  pairs.emplace_back(-0.f, 0.f, 0.f);
  ExpectAgreement(pairs);
}

TEST_F(CudaNeighbors, LeavesHaveAtMostTwelvePoints) {
  EXPECT_EQ(TreeLevels(12), 0);
  EXPECT_EQ(TreeLevels(13), 1);
  EXPECT_EQ(TreeNodes(13), 3);
  EXPECT_EQ(TreeLevels((int64_t{1} << 31) - 1), 28);
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST_F(CudaNeighbors, NameTheMemoryThatIsMissing) {
  emulated_cuda::SetMemory(20000);
  EXPECT_THAT([&] { MeanSquaredDistanceToThree(Cube(1000)); },
              testing::ThrowsMessage<OutOfMemory>(testing::HasSubstr("for the neighbors of the points to start from")));
  emulated_cuda::SetMemory(size_t{1} << 40);
}
#endif

}  // namespace
}  // namespace oraclegs::cuda

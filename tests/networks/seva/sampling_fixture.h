#pragma once
// tests/golden/seva_sampling: cameras and lists out of its tensors.

#include "networks/fixtures.h"
#include "oraclegs/networks/seva/cameras.h"

namespace oraclegs::seva {

inline constexpr const char* kSamplingFixture = "seva_sampling";

inline SafetensorsFile SamplingFixture() { return OpenGolden(kSamplingFixture); }

/// Poses [N, 3 or 4, 4] from camera to world, and intrinsics [N, 3, 3] where they are given.
inline std::vector<View> GoldenViews(const SafetensorsFile& file, const std::string& poses,
                                     const std::string& intrinsics = "") {
  const std::vector<double> pose = file.Values<double>(poses);
  const auto& shape = file.Get(poses).shape;
  std::vector<double> lens;
  if (!intrinsics.empty()) lens = file.Values<double>(intrinsics);
  std::vector<View> views(static_cast<size_t>(shape.at(0)));
  const auto stride = static_cast<size_t>(shape.at(1) * shape.at(2));
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (size_t i = 0; i < views.size(); ++i) {
    views[i].world_from_camera.matrix().topRows<3>() = Eigen::Map<const RowMajor34>(pose.data() + i * stride);
    if (!lens.empty()) views[i].intrinsics = Eigen::Map<const RowMajor33>(lens.data() + i * 9);
  }
  return views;
}

inline std::vector<bool> GoldenMask(const SafetensorsFile& file, const std::string& name) {
  std::vector<bool> mask;
  for (const int64_t value : file.Values<int64_t>(name)) mask.push_back(value != 0);
  return mask;
}

template <class T>
Tensor AsTensor(const std::vector<T>& values) {
  return torch::tensor(std::vector<double>(values.begin(), values.end()), torch::kDouble);
}

/// The largest difference as a fraction of the largest value.
inline void ExpectRatio(const Tensor& actual, const Tensor& expected, double tolerance, const std::string& what) {
  ASSERT_EQ(actual.sizes(), expected.sizes()) << what;
  EXPECT_LE(MaxAbsError(actual, expected), tolerance * expected.abs().max().item<double>()) << what;
}

}  // namespace oraclegs::seva

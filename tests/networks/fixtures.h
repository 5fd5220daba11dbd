#pragma once
// What the parity tests of networks share: sizes out of a fixture's metadata, parameter lists, differences.

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <torch/cuda.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "networks/golden_tensors.h"
#include "oraclegs/networks/common/parameters.h"

namespace oraclegs {

/// The numbers of a text such as "[1, 2]", "4,8" or "0.1".
inline std::vector<double> Numbers(const SafetensorsFile& file, const std::string& key) {
  std::string text = file.metadata().at(key);
  for (char& c : text) {
    if (c == '[' || c == ']' || c == ',') c = ' ';
  }
  std::istringstream in(text);
  std::vector<double> out;
  for (double number = 0; in >> number;) out.push_back(number);
  return out;
}

inline double Number(const SafetensorsFile& file, const std::string& key) { return Numbers(file, key).at(0); }
inline int64_t Count(const SafetensorsFile& file, const std::string& key) {
  return static_cast<int64_t>(Number(file, key));
}

template <size_t N>
std::array<int64_t, N> Counts(const SafetensorsFile& file, const std::string& key) {
  const std::vector<double> numbers = Numbers(file, key);
  std::array<int64_t, N> out{};
  for (size_t i = 0; i < N; ++i) out[i] = static_cast<int64_t>(numbers.at(i));
  return out;
}

/// Names and shapes of tests/golden/NAME (columns name, shape as 1x2x3) but those that begin with `without`.
inline std::map<std::string, std::vector<int64_t>> GoldenParameterList(const std::string& name,
                                                                       const std::string& without = "-") {
  std::ifstream in(GoldenDir() / name);
  std::map<std::string, std::vector<int64_t>> out;
  std::string line;
  std::getline(in, line);  // the names of the columns
  while (std::getline(in, line)) {
    std::istringstream columns(line);
    std::string tensor, shape;
    columns >> tensor >> shape;
    if (tensor.starts_with(without)) continue;
    std::replace(shape.begin(), shape.end(), 'x', ' ');
    std::istringstream sizes(shape);
    for (int64_t size = 0; sizes >> size;) out[tensor].push_back(size);
  }
  return out;
}

/// Checks and records (in the report of --gtest_output) the largest difference to a stored tensor of the same shape.
inline void ExpectGolden(const Tensor& actual, const SafetensorsFile& file, const std::string& name, double tolerance) {
  const Tensor expected = GoldenTensor(file, name);
  ASSERT_EQ(actual.sizes(), expected.sizes()) << name;
  const double error = MaxAbsError(actual, expected);
  EXPECT_LE(error, tolerance) << name;
  std::ostringstream text;
  text << error;
  testing::Test::RecordProperty(name, text.str());
}

/// Number of threads that a test runs on, or kOnGpu.
inline constexpr int kOnGpu = 0;

/// One thread, two, and a GPU where there is one.
inline std::vector<int> ThreadsAndGpu() {
  std::vector<int> runs = {1, 2};
  if (torch::cuda::is_available()) runs.push_back(kOnGpu);
  return runs;
}

/// Runs a test on that many threads or on the GPU, there with convolutions in full float32, and restores libtorch's
/// settings.
class OnThreads : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    at::set_num_threads(std::max(GetParam(), 1));
    at::globalContext().setAllowTF32CuDNN(false);
    if (GetParam() == kOnGpu) ParityDevice() = torch::kCUDA;
  }
  void TearDown() override {
    at::set_num_threads(before_);
    at::globalContext().setAllowTF32CuDNN(tf32_before_);
    ParityDevice() = torch::kCPU;
  }

 private:
  const int before_ = at::get_num_threads();
  const bool tf32_before_ = at::globalContext().allowTF32CuDNN();
};

/// A parameter source over the tensors of a fixture, "weights." in front of their names.
inline FileParameters GoldenWeights(const std::string& fixture, const std::vector<std::string>& ignored = {}) {
  CheckpointOptions options;
  options.ignored = ignored;
  options.model = fixture;
  options.prefix = "weights.";
  options.device = ParityDevice();
  return FileParameters({GoldenDir() / (fixture + ".safetensors")}, options);
}

}  // namespace oraclegs

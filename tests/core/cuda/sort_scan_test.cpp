#include "oraclegs/core/cuda/sort_scan.h"

#include <algorithm>
#include <numeric>

#include "oraclegs/core/rng.h"
#include "support/cuda_device.h"

namespace oraclegs::cuda {
namespace {

class SortScan : public CudaTest {};

std::vector<uint32_t> RandomWords(int64_t n, uint32_t limit) {
  Rng rng(3, RandomStream::kInitialPoints);
  std::vector<uint32_t> words(static_cast<size_t>(n));
  for (uint32_t& w : words) w = static_cast<uint32_t>(rng.Index(limit));
  return words;
}

TEST_F(SortScan, SortsStablyByTheLowestBits) {
  const int64_t n = 5000;
  const std::vector<uint32_t> keys = RandomWords(n, 1u << 10);
  std::vector<uint32_t> values(n);
  std::iota(values.begin(), values.end(), 0u);
  DeviceArray<uint32_t> device_keys("k"), device_values("v"), sorted_keys("sk"), sorted_values("sv");
  device_keys.Upload(keys.data(), n);
  device_values.Upload(values.data(), n);
  sorted_keys.Reserve(n);
  sorted_values.Reserve(n);
  Scratch scratch("scratch");
  for (const int bits : {10, 5}) {
    SortByKey({device_keys.data(), device_values.data(), sorted_keys.data(), sorted_values.data(), n}, bits, &scratch,
              nullptr);
    std::vector<uint32_t> order = values;
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return (keys[a] & ((1u << bits) - 1)) < (keys[b] & ((1u << bits) - 1));
    });
    EXPECT_EQ(ToHost(sorted_values, n), order) << bits;
    EXPECT_EQ(ToHost(sorted_keys, n).back(), keys[order.back()]) << bits;
    EXPECT_EQ(ToHost(device_keys, n), keys);
  }
}

TEST_F(SortScan, SumsBeforeEachItem) {
  const int64_t n = 3001;
  const std::vector<uint32_t> values = RandomWords(n, 1000);
  std::vector<uint32_t> expected(n);
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
  DeviceArray<uint32_t> in("in"), out("out");
  in.Upload(values.data(), n);
  out.Reserve(n);
  Scratch scratch("scratch");
  ExclusiveSum(in.data(), out.data(), n, &scratch, nullptr);
  EXPECT_EQ(ToHost(out, n), expected);
}

TEST_F(SortScan, NothingIsNothing) {
  Scratch scratch("scratch");
  EXPECT_NO_THROW(SortByKey({}, 8, &scratch, nullptr));
  EXPECT_NO_THROW(ExclusiveSum(nullptr, nullptr, 0, &scratch, nullptr));
}

}  // namespace
}  // namespace oraclegs::cuda

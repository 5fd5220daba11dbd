#include "oraclegs/render/cpu/scratch_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace oraclegs::cpu {
namespace {

TEST(ScratchArray, KeepsItsMemoryUntilItGrows) {
  ScratchArray<float> array;
  EXPECT_EQ(array.data(), nullptr);
  array.Reserve(100);
  EXPECT_GE(array.capacity(), 125);
  float* first = array.data();
  for (int i = 0; i < 125; ++i) first[i] = static_cast<float>(i);
  array.Reserve(3);
  array.Reserve(125);
  EXPECT_EQ(array.data(), first);
  EXPECT_EQ(array.data()[124], 124.f);
  array.Reserve(126);
  EXPECT_GE(array.capacity(), 126);
}

TEST(ScratchArray, IsAlignedToCacheLines) {
  for (const int64_t count : {1, 3, 1000}) {
    ScratchArray<uint16_t> array;
    array.Reserve(count);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(array.data()) % 64, 0u);
  }
}

TEST(ScratchArray, IsEmptyAfterBadAlloc) {
  ScratchArray<double> array;
  array.Reserve(10);
  EXPECT_THROW(array.Reserve(INT64_MAX / 2), std::bad_alloc);
  EXPECT_EQ(array.capacity(), 0);
  array.Reserve(10);
  EXPECT_NE(array.data(), nullptr);
}

TEST(ScratchArray, HoldsNothing) {
  ScratchArray<double> array;
  array.Reserve(0);
  EXPECT_EQ(array.capacity(), 0);
}

}  // namespace
}  // namespace oraclegs::cpu

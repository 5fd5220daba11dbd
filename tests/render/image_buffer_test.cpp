#include "oraclegs/render/image_buffer.h"

#include <gtest/gtest.h>

#include "support/buffers.h"

namespace oraclegs {
namespace {

TEST(ImageBuffer, HasTheShapeAskedFor) {
  ImageBuffer buffer;
  EXPECT_EQ(buffer.Get({4, 5, 3}).shape(), Shape({4, 5, 3}));
  EXPECT_EQ(buffer.Get({7, 2}).shape(), Shape({7, 2}));
  EXPECT_EQ(buffer.Get({4, 5, 3}).shape(), Shape({4, 5, 3}));
}

TEST(ImageBuffer, KeepsOneHandleAShapeInOneStorage) {
  ImageBuffer buffer;
  const float* memory = buffer.Get({6, 5, 3}).data();
  const auto* small = &buffer.Get({3, 2});
  EXPECT_EQ(small->data(), memory);
  EXPECT_EQ(&buffer.Get({3, 2}), small);
  EXPECT_EQ(buffer.Get({5, 6, 3}).data(), memory);
  EXPECT_EQ(buffer.Get({6, 5, 3}).data(), memory);
}

TEST(ImageBuffer, MovesAllShapesToTheNewStorageAfterGrowing) {
  ImageBuffer buffer;
  const Buffer<float> old = buffer.Get({2, 2});
  Flat(old).setConstant(1);
  const Buffer<float> large = buffer.Get({20, 20});
  Flat(large).setConstant(7);
  EXPECT_EQ(Flat(old).sum(), 4);  // whoever kept it still owns it
  const Buffer<float> again = buffer.Get({2, 2});
  EXPECT_EQ(again.data(), large.data());
  EXPECT_EQ(Flat(again).sum(), 28);
}

TEST(ImageBuffer, TakesEmptyShapes) {
  ImageBuffer buffer;
  EXPECT_EQ(buffer.Get({0, 5}).count(), 0);
  EXPECT_EQ(buffer.Get({2, 5}).count(), 10);
}

}  // namespace
}  // namespace oraclegs

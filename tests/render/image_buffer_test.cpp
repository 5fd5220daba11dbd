#include "oraclegs/render/image_buffer.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(ImageBuffer, GivesContiguousFloatsOfTheShape) {
  ImageBuffer buffer;
  EXPECT_NO_THROW(RequireShape("ImageBuffer", "image", buffer.Get({4, 5, 3}), {4, 5, 3}));
  EXPECT_NO_THROW(RequireShape("ImageBuffer", "plane", buffer.Get({7, 2}), {7, 2}));
  EXPECT_NO_THROW(RequireShape("ImageBuffer", "image", buffer.Get({4, 5, 3}), {4, 5, 3}));
}

TEST(ImageBuffer, KeepsOneTensorAShapeInOneStorage) {
  ImageBuffer buffer;
  const Buffer<float> large = buffer.Get({6, 5, 3});
  const Buffer<float> small = buffer.Get({3, 2});
  const Buffer<float> turned = buffer.Get({5, 6, 3});
  EXPECT_TRUE(buffer.Get({6, 5, 3}).is_same(large));
  EXPECT_TRUE(buffer.Get({3, 2}).is_same(small));
  EXPECT_TRUE(buffer.Get({5, 6, 3}).is_same(turned));
  EXPECT_EQ(small.data_ptr(), large.data_ptr());
  EXPECT_EQ(turned.data_ptr(), large.data_ptr());
}

TEST(ImageBuffer, AfterGrowingAllShapesLieInTheNewStorage) {
  ImageBuffer buffer;
  const Buffer<float> old = buffer.Get({2, 2});
  old.fill_(1);
  const Buffer<float> large = buffer.Get({20, 20});
  large.fill_(7);
  EXPECT_EQ(old.sum().item<float>(), 4);  // who kept it still owns it
  const Buffer<float> again = buffer.Get({2, 2});
  EXPECT_EQ(again.data_ptr(), large.data_ptr());
  EXPECT_EQ(again.sum().item<float>(), 28);
}

TEST(ImageBuffer, EmptyShapesAreNotAnError) {
  ImageBuffer buffer;
  EXPECT_EQ(buffer.Get({0, 5}).count(), 0);
  EXPECT_EQ(buffer.Get({2, 5}).count(), 10);
}

}  // namespace
}  // namespace oraclegs

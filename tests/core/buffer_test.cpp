#include "oraclegs/core/buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

namespace oraclegs {
namespace {

using testing::Each;
using testing::ElementsAre;

Buffer<float> Counting(const Shape& shape) {
  const Buffer<float> buffer = Buffer<float>::Empty(shape);
  std::iota(buffer.span().begin(), buffer.span().end(), 0.f);
  return buffer;
}

template <class Body>
std::string ShapeMessage(const Body& body) {
  try {
    body();
  } catch (const ShapeError& error) {
    return error.what();
  }
  return "";
}

TEST(Buffer, IsUndefinedByDefault) {
  const Buffer<float> none;
  EXPECT_FALSE(none.defined());
  EXPECT_EQ(none.data(), nullptr);
  EXPECT_EQ(none.count(), 0);
  EXPECT_FALSE(none.Clone().defined());
  EXPECT_FALSE(none.To(kCpu).defined());
}

TEST(Buffer, StartsAtACacheLine) {
  for (const int64_t n : {1, 3, 1000}) {
    EXPECT_EQ(reinterpret_cast<uintptr_t>(Buffer<float>::Empty({n}).data()) % 64, 0u);
  }
}

TEST(Buffer, HoldsNoNumbersAndStaysDefined) {
  const Buffer<float> empty = Buffer<float>::Zeros({0, 3});
  EXPECT_TRUE(empty.defined());
  EXPECT_EQ(empty.count(), 0);
  EXPECT_EQ(empty.Clone().shape(), (Shape{0, 3}));
}

TEST(Buffer, FillsAndReads) {
  EXPECT_THAT(Buffer<double>::Zeros({2, 2}).span(), Each(0.0));
  EXPECT_THAT(Buffer<uint8_t>::Full({3}, 7).span(), Each(7));
  EXPECT_THAT((Buffer<float>::From({2, 2}, {1, 2, 3, 4}).span()), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(ShapeMessage([] { Buffer<float>::From({2, 2}, {1, 2, 3}); }), "3 values for an array of shape [2, 2]");
}

TEST(Buffer, CopiesShareTheirNumbersAndClonesDoNot) {
  const Buffer<float> a = Counting({4});
  const Buffer<float> shared = a, clone = a.Clone();
  a[0] = 9;
  EXPECT_EQ(shared[0], 9);
  EXPECT_EQ(clone[0], 0);
  EXPECT_EQ(a.To(kCpu).data(), a.data());
}

TEST(Buffer, ShowsTheSameNumbersInOtherShapes) {
  const Buffer<float> a = Counting({4, 3});
  EXPECT_THAT(a.Rows(1, 3).span(), ElementsAre(3, 4, 5, 6, 7, 8));
  EXPECT_EQ(a.Rows(1, 3).shape(), (Shape{2, 3}));
  EXPECT_EQ(a.Head({2, 6}).data(), a.data());
  EXPECT_THAT(a.Head({1, 2}).span(), ElementsAre(0, 1));
  EXPECT_EQ(ShapeMessage([&] { a.Head({13}); }), "[4, 3] has no room for [13]");
  EXPECT_EQ(ShapeMessage([&] { a.Rows(2, 5); }), "rows 2 to 5 of [4, 3]");
}

TEST(Buffer, GrowsInItsMemoryWhereThatHasRoom) {
  const Buffer<float> a = Counting({4, 3});
  const Buffer<float> grown = a.GrownTo(5);
  EXPECT_NE(grown.data(), a.data());
  EXPECT_EQ(grown.shape(), (Shape{5, 3}));
  EXPECT_TRUE(std::equal(a.span().begin(), a.span().end(), grown.span().begin()));
  EXPECT_EQ(grown.GrownTo(6).data(), grown.data());
  EXPECT_NE(grown.GrownTo(7).data(), grown.data());
  EXPECT_EQ(grown.GrownTo(2).shape(), (Shape{2, 3}));
}

TEST(Buffer, KeepsTheOwnerOfWrappedMemory) {
  auto owner = std::make_shared<std::vector<float>>(3, 1.f);
  std::weak_ptr<std::vector<float>> watch = owner;
  {
    const Buffer<float> wrapped = Buffer<float>::Wrap(owner->data(), {3}, kCpu, owner);
    owner.reset();
    EXPECT_FALSE(watch.expired());
    EXPECT_THAT(wrapped.span(), Each(1.f));
  }
  EXPECT_TRUE(watch.expired());
}

TEST(Buffer, CopiesFromAnother) {
  const Buffer<float> a = Buffer<float>::Zeros({2, 2});
  a.CopyFrom(Counting({4}));
  EXPECT_THAT(a.span(), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(ShapeMessage([&] { a.CopyFrom(Counting({5})); }), "[5] is copied to [2, 2]");
}

TEST(Buffer, RefusesADeviceThatIsNotThere) {
  EXPECT_THROW((Buffer<float>::Zeros({1}, {DeviceKind::kCuda, 12345})), UsageError);
}

TEST(RequireShape, SaysWhatWasFoundAndExpected) {
  const Buffer<float> a = Counting({4, 3});
  EXPECT_NO_THROW(RequireShape("F", "x", a, {-1, 3}));
  EXPECT_EQ(ShapeMessage([&] { RequireShape("F", "x", a, {4, 2}); }), "F: x is [4, 3], expected [4, 2]");
  EXPECT_EQ(ShapeMessage([&] { RequireShape("F", "x", a, {-1}); }), "F: x is [4, 3], expected [any]");
  EXPECT_EQ(ShapeMessage([] {
              RequireShape("F", "x", Buffer<float>(), {1, -1});
            }),
            "F: x is undefined, expected [1, any]");
}

}  // namespace
}  // namespace oraclegs

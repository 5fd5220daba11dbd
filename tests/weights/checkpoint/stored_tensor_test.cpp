#include "oraclegs/weights/checkpoint/stored_tensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

/// A heap of one storage of 12 bytes: 0, 1, 2, ...
struct Twelve {
  std::string bytes;
  PickleHeap heap;

  Twelve() {
    for (char c = 0; c < 12; ++c) bytes.push_back(c);
    heap.file = "f.pt";
    heap.storages.push_back({"0", {"U8", 1}, 12, bytes});
    heap.slices.push_back({0, 0, 12});
    heap.slices.push_back({0, 8, 4});
  }
  StoredTensor Of(PickleTensor tensor) const {
    if (!*tensor.element.name) tensor.element = {"U8", 1};
    return StoredTensorOf(tensor, "t", heap);
  }
  std::string ErrorOf(const PickleTensor& tensor) const {
    return MessageOf<InputError>([&] { Of(tensor); });
  }
};

std::vector<int> Numbers(const StoredTensor& tensor) {
  std::vector<int> numbers;
  ForEachPiece(tensor, [&](std::string_view piece) { numbers.insert(numbers.end(), piece.begin(), piece.end()); });
  return numbers;
}

TEST(StoredTensorOf, TakesTheBytesOfATensor) {
  const Twelve twelve;
  const StoredTensor tensor = twelve.Of({0, {}, 2, {2, 3}, {3, 1}});
  EXPECT_TRUE(tensor.IsContiguous());
  EXPECT_EQ(tensor.bytes.data(), twelve.bytes.data() + 2);
  EXPECT_EQ(tensor.bytes.size(), 6u);
  EXPECT_EQ(twelve.Of({1, {}, 0, {4}, {1}}).bytes.data(), twelve.bytes.data() + 8);
  EXPECT_EQ(twelve.Of({0, {"F32", 4}, 1, {2}, {1}}).bytes.data(), twelve.bytes.data() + 4);
  EXPECT_EQ(twelve.Of({0, {}, 11, {}, {}}).bytes.size(), 1u);
}

TEST(StoredTensorOf, AcceptsEmptyTensors) {
  const Twelve twelve;
  EXPECT_TRUE(twelve.Of({0, {}, 500, {0, 3}, {3, 1}}).bytes.empty());
  EXPECT_TRUE(twelve.Of({PickleTensor::kNoSlice, {}, 0, {0}, {1}}).bytes.empty());
}

TEST(StoredTensorOf, RefusesWhatLiesOutside) {
  const Twelve twelve;
  constexpr int64_t kHuge = int64_t{1} << 48;
  for (const PickleTensor& tensor : std::vector<PickleTensor>{{0, {}, 0, {13}, {1}},
                                                              {0, {}, 1, {12}, {1}},
                                                              {0, {}, 12, {1}, {1}},
                                                              {0, {}, kHuge, {1}, {1}},
                                                              {0, {}, 0, {2}, {12}},
                                                              {0, {}, 0, {5, 5}, {1, 1}},
                                                              {0, {}, 0, {kHuge}, {0}},
                                                              {0, {}, 0, {kHuge, kHuge}, {0, 0}},
                                                              {0, {}, 0, {kHuge, 2}, {kHuge, 1}},
                                                              {1, {}, 0, {5}, {1}},
                                                              {0, {"F32", 4}, 1, {3}, {1}},
                                                              {0, {"F64", 8}, 0, {2}, {1}},
                                                              {PickleTensor::kNoSlice, {}, 0, {1}, {1}}}) {
    EXPECT_EQ(twelve.ErrorOf(tensor), "f.pt: tensor 't' reaches beyond its numbers; get the file again");
  }
}

TEST(ForEachPiece, FollowsTheStrides) {
  const Twelve twelve;
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 3, {2, 2}, {2, 1}})), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 0, {4, 3}, {1, 4}})), ElementsAre(0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11));
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 0, {2, 2, 2}, {6, 3, 2}})), ElementsAre(0, 2, 3, 5, 6, 8, 9, 11));
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 1, {3, 2}, {1, 0}})), ElementsAre(1, 1, 2, 2, 3, 3));
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 0, {3}, {4}})), ElementsAre(0, 4, 8));
  EXPECT_THAT(Numbers(twelve.Of({0, {"U16", 2}, 1, {2}, {2}})), ElementsAre(2, 3, 6, 7));
  EXPECT_THAT(Numbers(twelve.Of({0, {}, 0, {0}, {1}})), ElementsAre());
}

TEST(ForEachPiece, HandsOverLimitedPieces) {
  const std::string bytes(40'000'000, 'x');
  for (const int64_t stride : {1, 2}) {
    const StoredTensor tensor{"U8", 1, {20'000'000}, {stride}, std::string_view(bytes).substr(0, 20'000'000u * stride)};
    std::vector<size_t> sizes;
    ForEachPiece(tensor, [&](std::string_view piece) { sizes.push_back(piece.size()); });
    EXPECT_THAT(sizes, ElementsAre(size_t{1} << 24, 20'000'000 - (size_t{1} << 24)));
  }
}

TEST(ContiguousStrides, AreRowMajor) {
  EXPECT_THAT(ContiguousStrides({2, 3, 4}), ElementsAre(12, 4, 1));
  EXPECT_THAT(ContiguousStrides({}), ElementsAre());
  const int64_t huge = int64_t{1} << 62;  // times 4 it is no number
  EXPECT_THAT(ContiguousStrides({0, huge, 4}), ElementsAre(1, 1, 1));
  EXPECT_TRUE((StoredTensor{"U8", 1, {0, huge, 4}, {1, 1, 1}, {}}.IsContiguous()));
}

}  // namespace
}  // namespace oraclegs

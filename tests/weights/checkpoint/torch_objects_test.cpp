#include "oraclegs/weights/checkpoint/pickle_heap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "torch_bytes.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using namespace torch_bytes;  // NOLINT: pieces of pickles

/// Object that the pickle makes, with its heap and the bytes that they refer to.
struct Made {
  std::string bytes;
  PickleHeap heap;
  PickleValue value;

  explicit Made(const std::string& body) : bytes(Pickle(body)) {
    heap.file = "f.pt";
    std::string_view left = bytes;
    value = ReadPickle(&left, &heap);
  }
  const PickleTensor& tensor() const {
    EXPECT_EQ(value.kind, PickleKind::kTensor);
    return heap.tensors.at(value.index());
  }
};
std::string ErrorOfMaking(const std::string& body) {
  return MessageOf<InputError>([&] { Made made(body); });
}

TEST(ReduceInCheckpoint, MakesTensors) {
  const Made made(Tensor(Storage("0", 24, "HalfStorage"), {{2, 3}, {3, 1}, 4}));
  EXPECT_EQ(made.tensor().shape, (std::vector<int64_t>{2, 3}));
  EXPECT_EQ(made.tensor().strides, (std::vector<int64_t>{3, 1}));
  EXPECT_EQ(made.tensor().offset, 4);
  EXPECT_STREQ(made.tensor().element.name, "F16");
  const PickleStorage& storage = made.heap.storages.at(0);
  EXPECT_EQ(storage.key, "0");
  EXPECT_EQ(storage.numel, 24);
}

TEST(ReduceInCheckpoint, LooksThroughParametersAndSubclasses) {
  const std::string tensor = Vector("0", 3);
  EXPECT_EQ(Made(Call(Global("torch._utils", "_rebuild_parameter"), {tensor, "\x88", "}"})).tensor().shape.size(), 1u);
  const std::string arguments = Tuple({Storage("0", 3), Int(0), Ints({3}), Ints({1}), "\x89", "}"});
  const std::string subclass =
      Call(Global("torch._tensor", "_rebuild_from_type_v2"),
           {Global("torch._utils", "_rebuild_tensor_v2"), Global("mine", "Special"), arguments, "}"});
  EXPECT_EQ(Made(subclass).tensor().shape, std::vector<int64_t>{3});
}

TEST(ReduceInCheckpoint, TakesTheTypeOfUntypedStorages) {
  const std::string storage =
      Tuple({Text("storage"), Global("torch.storage", "UntypedStorage"), Text("0"), Text("cpu"), Int(8)}) + 'Q';
  const auto typed = [&](const std::string& type) {
    return Call(Global("torch._utils", "_rebuild_tensor_v3"),
                {storage, Int(0), Ints({4}), Ints({1}), "\x89", "}", type});
  };
  EXPECT_STREQ(Made(typed(Global("torch", "uint16"))).tensor().element.name, "U16");
  EXPECT_THAT(ErrorOfMaking(typed("N")), HasSubstr("a tensor has a type that is not known"));
}

TEST(ReduceInCheckpoint, RefusesMalformedTensors) {
  for (const View& view :
       {View{{-1}, {1}}, View{{2}, {-1}}, View{{2}, {1, 1}}, View{{2}, {1}, -1},
        View{std::vector<int64_t>(17, 1), std::vector<int64_t>(17, 1)}, View{{int64_t{1} << 50}, {1}}}) {
    EXPECT_EQ(ErrorOfMaking(Tensor(Storage("0", 4), view)), "f.pt: a tensor is malformed; get the file again");
  }
  EXPECT_THAT(ErrorOfMaking(Call(Global("torch._utils", "_rebuild_tensor_v2"), {"N"})), HasSubstr("malformed"));
  EXPECT_THAT(ErrorOfMaking(Tensor("N", {{1}, {1}})), HasSubstr("malformed"));
}

TEST(ReduceInCheckpoint, MakesDicts) {
  const Made made(
      Call(Global("collections", "OrderedDict"), {List({Tuple({Text("a"), Int(1)}), List({Text("b"), Int(2)})})}));
  ASSERT_TRUE(made.heap.Find(made.value, "b"));
  EXPECT_EQ(made.heap.Find(made.value, "b")->number, 2);
  EXPECT_EQ(Made(Call(Global("collections", "defaultdict"), {Global("builtins", "list")})).value.kind,
            PickleKind::kDict);
  EXPECT_THAT(ErrorOfMaking(Call(Global("collections", "OrderedDict"), {List({Int(1)})})), HasSubstr("malformed"));
}

TEST(ReduceInCheckpoint, KnowsNothingOfOtherObjects) {
  const Made made(Call(Global("numpy.core.multiarray", "scalar"), {Text("x")}) + Dict({{"a", Int(1)}}) + 'b');
  ASSERT_EQ(made.value.kind, PickleKind::kObject);
  EXPECT_TRUE(made.heap.Find(made.heap.objects.at(made.value.index()).state, "a"));
  // An object that is called is another object.
  EXPECT_EQ(Made(Call(Call(Global("mine", "make"), {}), {Int(1)})).value.kind, PickleKind::kObject);
  EXPECT_THAT(ErrorOfMaking(Call(Global("torch", "FloatStorage"), {})), HasSubstr("calls what cannot be called"));
  EXPECT_THAT(ErrorOfMaking(Global("mine", "make") + "NR"), HasSubstr("calls what cannot be called"));
  EXPECT_THAT(ErrorOfMaking(Call(Global("torch", "Size"), {})), HasSubstr("calls torch Size without what it needs"));
}

TEST(BuildInCheckpoint, FillsTensorsOfTheFirstVersion) {
  const std::string empty = Call(Global("torch", "FloatTensor"), {});
  EXPECT_EQ(Made(empty).tensor().shape, std::vector<int64_t>{0});
  const Made made(empty + Tuple({Storage("0", 6), Int(0), Ints({2, 3}), Ints({3, 1})}) + 'b');
  EXPECT_EQ(made.tensor().shape, (std::vector<int64_t>{2, 3}));
  // Attributes of anything else change nothing.
  EXPECT_EQ(Made(Vector("0", 3) + Tuple({Int(1)}) + 'b').tensor().shape, std::vector<int64_t>{3});
}

TEST(StorageInCheckpoint, IsOneForAKey) {
  const Made made(Tuple({Vector("0", 4), Vector("0", 4), Vector("1", 4)}));
  EXPECT_EQ(made.heap.storages.size(), 2u);
  EXPECT_EQ(ErrorOfMaking(Tuple({Vector("0", 4), Vector("0", 5)})),
            "f.pt: storage '0' is said to be two different things; get the file again");
  EXPECT_THAT(ErrorOfMaking(Tuple({Storage("0", 4), Storage("0", 4, "HalfStorage")})),
              HasSubstr("two different things"));
}

TEST(StorageInCheckpoint, MayNameAPart) {
  const auto part = [](int64_t offset, int64_t numel) {
    return Tuple({Text("storage"), Global("torch", "FloatStorage"), Text("0"), Text("cpu"), Int(10),
                  Tuple({Text("1"), Int(offset), Int(numel)})}) +
           'Q';
  };
  const Made made(Tensor(part(4, 6), {{6}, {1}}));
  EXPECT_EQ(made.heap.slices.at(made.tensor().slice).offset, 4);
  for (const auto& [offset, numel] : std::map<int64_t, int64_t>{{5, 6}, {11, 0}, {-1, 2}}) {
    EXPECT_EQ(ErrorOfMaking(part(offset, numel)), "f.pt: a part of storage '0' lies outside it; get the file again");
  }
}

TEST(StorageInCheckpoint, RefusesOtherThings) {
  EXPECT_THAT(ErrorOfMaking(Text("x") + 'Q'), HasSubstr("refers to something that is no storage"));
  EXPECT_THAT(ErrorOfMaking(Tuple({Text("storage")}) + 'Q'), HasSubstr("no storage"));
  EXPECT_THAT(ErrorOfMaking(Storage("0", -1)), HasSubstr("a storage is malformed"));
  EXPECT_THAT(ErrorOfMaking(Storage("0", 1, "float32")), HasSubstr("a storage is malformed"));
  // The source of a network's class, which old files carry along.
  const std::string module = Tuple({Text("module"), Global("mine", "Net"), Text("net.py"), Text("class Net")}) + 'Q';
  EXPECT_EQ(Made(Call(module, {})).value.kind, PickleKind::kObject);
}

}  // namespace
}  // namespace oraclegs

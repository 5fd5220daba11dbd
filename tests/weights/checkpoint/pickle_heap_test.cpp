#include "oraclegs/weights/checkpoint/pickle_heap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::StartsWith;

PickleValue Word(const char* text) {
  return {PickleKind::kText, text, static_cast<int64_t>(std::char_traits<char>::length(text))};
}
PickleValue Whole(int64_t number) { return {PickleKind::kInteger, nullptr, number}; }

TEST(PickleHeap, FindsTheLastValueOfAKey) {
  PickleHeap heap;
  const PickleValue dict =
      heap.Add(PickleKind::kDict, {Word("a"), Whole(1), Word("b"), Whole(2), Word("a"), Whole(3), Whole(7), Word("b")});
  ASSERT_TRUE(heap.Find(dict, "a"));
  EXPECT_EQ(heap.Find(dict, "a")->number, 3);
  EXPECT_EQ(heap.Find(dict, "b")->number, 2);
  EXPECT_EQ(heap.Find(dict, "c"), nullptr);
  EXPECT_EQ(heap.Find(heap.Add(PickleKind::kList, {Word("a"), Whole(1)}), "a"), nullptr);
  EXPECT_EQ(heap.Find(Word("a"), "a"), nullptr);
}

TEST(PickleHeap, HoldsANameOnce) {
  PickleHeap heap;
  const PickleValue first = heap.AddGlobal("torch", "FloatStorage"), second = heap.AddGlobal("torch", "FloatStorage");
  EXPECT_EQ(first.number, second.number);
  EXPECT_EQ(heap.globals[first.index()].role, PickleRole::kStorageType);
  EXPECT_NE(heap.AddGlobal("torch", "HalfStorage").number, first.number);
}

TEST(PickleHeap, RefusesLongNamesAndAttacks) {
  PickleHeap heap;
  heap.file = "f.pt";
  EXPECT_EQ(MessageOf<InputError>([&] { heap.AddGlobal("m", std::string(501, 'x')); }),
            "f.pt: its pickle has a name of 501 bytes; get the file again");
  EXPECT_THAT(MessageOf<InputError>([&] { heap.AddGlobal("builtins", "eval"); }),
              StartsWith("f.pt: its pickle asks for 'builtins eval', which is no part of a checkpoint"));
  EXPECT_TRUE(heap.globals.empty());
}

TEST(PickleHeap, LimitsItsItems) {
  PickleHeap heap;
  heap.file = "f.pt";
  heap.Add(PickleKind::kList, std::vector<PickleValue>(3'000'000));
  EXPECT_EQ(MessageOf<InputError>([&] { heap.Add(PickleKind::kList, std::vector<PickleValue>(3'000'000)); }),
            "f.pt: its pickle has more than 4000000 values; save its state dict alone");
}

TEST(PickleHeap, DescribesValues) {
  PickleHeap heap;
  EXPECT_EQ(heap.Describe({}), "nothing");
  EXPECT_EQ(heap.Describe(Whole(1)), "a number");
  EXPECT_EQ(heap.Describe(heap.Add(PickleKind::kDict, {})), "a dict");
  heap.objects.push_back({heap.AddGlobal("a\n", "B").index(), {}});
  EXPECT_EQ(heap.Describe({PickleKind::kObject, nullptr, 0}), "an object of a? B");
}

TEST(KnownGlobal, KnowsTypes) {
  for (const std::string name :
       {"torch FloatStorage", "torch.cuda FloatStorage", "torch FloatTensor", "torch float32"}) {
    const PickleGlobal global = KnownGlobal(name);
    EXPECT_EQ(global.name, name);
    EXPECT_STREQ(global.element.name, "F32") << name;
    EXPECT_EQ(global.element.bytes, 4) << name;
  }
  EXPECT_EQ(KnownGlobal("torch FloatTensor").role, PickleRole::kTensorType);
  EXPECT_EQ(KnownGlobal("torch bfloat16").role, PickleRole::kElementType);
  EXPECT_EQ(KnownGlobal("torch.storage UntypedStorage").role, PickleRole::kStorageType);
  EXPECT_EQ(KnownGlobal("torch.storage UntypedStorage").element.bytes, 1);
}

TEST(KnownGlobal, KnowsFunctions) {
  EXPECT_EQ(KnownGlobal("torch._utils _rebuild_tensor_v2").role, PickleRole::kRebuildTensor);
  EXPECT_EQ(KnownGlobal("torch._utils _rebuild_parameter").role, PickleRole::kFirstArgument);
  EXPECT_EQ(KnownGlobal("collections OrderedDict").role, PickleRole::kDict);
  for (const std::string name : {"torch storage", "mine FloatStorage", "numpy.core.multiarray scalar", ""}) {
    EXPECT_EQ(KnownGlobal(name).role, PickleRole::kOther) << name;
    EXPECT_EQ(KnownGlobal(name).name, name);
  }
}

TEST(RunsPrograms, KnowsTheUsualAttacks) {
  EXPECT_TRUE(RunsPrograms("os", "system"));
  EXPECT_TRUE(RunsPrograms("posix", "system"));
  EXPECT_TRUE(RunsPrograms("subprocess", "Popen"));
  EXPECT_TRUE(RunsPrograms("__builtin__", "eval"));
  EXPECT_TRUE(RunsPrograms("_io", "open"));
}

TEST(RunsPrograms, LeavesWhatCheckpointsHold) {
  EXPECT_FALSE(RunsPrograms("builtins", "getattr"));  // enumerations
  EXPECT_FALSE(RunsPrograms("builtins", "set"));
  EXPECT_FALSE(RunsPrograms("code.models", "Net"));  // a package of the user's
  EXPECT_FALSE(RunsPrograms("argparse", "Namespace"));
  EXPECT_FALSE(RunsPrograms("numpy", "dtype"));
}

}  // namespace

}  // namespace oraclegs

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
using namespace std::string_literals;

struct Read {
  std::string bytes;
  PickleHeap heap;
  PickleValue value;
  std::string rest;

  explicit Read(std::string pickle) : bytes(std::move(pickle)) {
    heap.file = "f.pt";
    std::string_view left = bytes;
    value = ReadPickle(&left, &heap);
    rest = left;
  }
  const std::vector<PickleValue>& items() const { return heap.ItemsOf(value); }
};

std::string ErrorOfPickle(const std::string& pickle) {
  return MessageOf<InputError>([&] { Read read(pickle); });
}

TEST(ReadPickle, ReadsNumbers) {
  const std::string numbers = "J\xfe\xff\xff\xffK\xfeM\xfe\xff\x8a\x02\x00\x80\x8a\x00\x8b\x01\x00\x00\x00\x7f"s;
  const Read read(Pickle('(' + numbers + Int(-5) + 't'));
  std::vector<int64_t> found;
  for (const PickleValue& item : read.items()) {
    EXPECT_EQ(item.kind, PickleKind::kInteger);
    found.push_back(item.number);
  }
  EXPECT_EQ(found, (std::vector<int64_t>{-2, 254, 65534, -32768, 0, 127, -5}));
}

TEST(ReadPickle, ReadsDigits) {
  const Read read(Pickle("(I-99999999999\nI01\nI00\nt"));
  EXPECT_EQ(read.items()[0].number, -99'999'999'999);
  EXPECT_EQ(read.items()[1].kind, PickleKind::kBool);
  EXPECT_EQ(read.items()[1].number, 1);
  EXPECT_EQ(read.items()[2].number, 0);
  for (const std::string digits : {"", "x", "1x", " 1", "99999999999999999999"}) {
    EXPECT_THAT(ErrorOfPickle(Pickle("I" + digits + "\n")), StartsWith("f.pt: its pickle is damaged")) << digits;
  }
  EXPECT_THAT(ErrorOfPickle(Pickle("I1")), StartsWith("f.pt: its pickle is damaged"));
}

TEST(ReadPickle, ReadsTexts) {
  const std::string texts = Text("a") + "U\1bT" + Bytes(1, 4) + "cC\1dB" + Bytes(1, 4) + "e\x8c\1f\x8d" + Bytes(1, 8) +
                            "g\x8e" + Bytes(1, 8) + "h\x96" + Bytes(1, 8) + "i";
  const Read read(Pickle('(' + texts + 't'));
  std::string found;
  for (const PickleValue& item : read.items()) found += item.text();
  EXPECT_EQ(found, "abcdefghi");
}

TEST(ReadPickle, FillsContainers) {
  const Read read(Pickle("}(" + Text("a") + List({"K\1", "K\2"}) + Text("b") + "]K\3aK\4au" + Text("c") + "(K\5ls"));
  ASSERT_EQ(read.value.kind, PickleKind::kDict);
  for (const auto& [key, sizes] : std::map<std::string, size_t>{{"a", 2}, {"b", 2}, {"c", 1}}) {
    const PickleValue* list = read.heap.Find(read.value, key);
    ASSERT_TRUE(list && list->kind == PickleKind::kList) << key;
    EXPECT_EQ(read.heap.ItemsOf(*list).size(), sizes);
  }
  EXPECT_EQ(Read(Pickle("K\1K\2\x86K\3\x85K\4K\5K\6\x87\x87")).items().size(), 3u);
  EXPECT_EQ(Read(Pickle("(" + Text("k") + "K\1d")).value.kind, PickleKind::kDict);
  EXPECT_EQ(Read(Pickle("\x8f(K\1\x90")).items().size(), 1u);
  EXPECT_EQ(Read(Pickle("(K\1K\2\x91")).items().size(), 2u);
}

TEST(ReadPickle, RemembersValues) {
  const Read read(Pickle("]q\1K\7ah\1r\x05\0\0\0j\x05\0\0\0"s + "h\1\x87"));
  EXPECT_EQ(read.items()[0].number, read.items()[2].number);
  EXPECT_EQ(Read(Pickle("K\7\x94K\x08\x94h\0h\1\x86"s)).items()[1].number, 8);
  EXPECT_EQ(Read(Pickle("K\1K\2"
                        "0(K\3"
                        "12\x86"))
                .items()
                .size(),
            2u);
  // A list that contains itself.
  const Read circle(Pickle("]q\0h\0a"s));
  EXPECT_EQ(circle.items()[0].number, circle.value.number);
}

TEST(ReadPickle, StopsBehindThePickle) {
  EXPECT_EQ(Read(Pickle("N") + "rest").rest, "rest");
  EXPECT_EQ(Read("\x80\x04\x95" + Bytes(2, 8) + "N.").value.kind, PickleKind::kNone);
}

TEST(ReadPickle, RefusesForeignInstructions) {
  for (const std::string& code : std::vector<std::string>{"S'x'\n", "L1L\n", "\x82\1", "P0\n", "os", "\xff"}) {
    EXPECT_THAT(ErrorOfPickle("\x80\2" + code + "."), StartsWith("f.pt: its pickle uses the instruction 0x")) << code;
  }
  EXPECT_THAT(ErrorOfPickle("\x80\6N."), StartsWith("f.pt: its pickle is of a newer protocol than 5"));
}

TEST(ReadPickle, RefusesDamage) {
  for (const std::string& body : std::vector<std::string>{
           "",   "t", "0",  "a", "]a",    "K\1u",  "(K\1d",  "}(K\1u", "h\1", "R",     "NR",    "K\1K\2R", "(",
           "(.", "b", "Nb", "Q", "cname", "N\x93", "NN\x93", "e",      "](",  "}K\1s", "NK\1a", "\x85"}) {
    EXPECT_THAT(ErrorOfPickle("\x80\2" + body + "."), StartsWith("f.pt: ")) << body;
  }
}

TEST(ReadPickle, NeverBelievesLengths) {
  for (const std::string& body :
       std::vector<std::string>{"X" + Bytes(~0u, 4), "\x8d" + Bytes(~uint64_t{0}, 8), "\x8b" + Bytes(~0u, 4), "U\xff",
                                "\x95" + Bytes(1, 8), "\x96" + Bytes(uint64_t{1} << 62, 8), "J\1", "G", "\x80"}) {
    EXPECT_EQ(ErrorOfPickle("\x80\2" + body), "f.pt: its pickle has no end; get the file again") << body;
  }
}

TEST(ReadPickle, LimitsMemory) {
  EXPECT_THAT(ErrorOfPickle(Pickle(std::string(4'500'000, 'N'))),
              HasSubstr("more than 4000000 values; save its state dict"));
  EXPECT_THAT(ErrorOfPickle(Pickle("N" + std::string(4'500'000, '\x94'))), HasSubstr("more than 4000000 values"));
  // A dict of half a million items, copied again and again.
  std::string copies = "}q\0("s;
  for (int i = 0; i < 500'000; ++i) copies += "K\1N";
  copies += 'u' + Global("collections", "OrderedDict") + "q\1";
  for (int i = 0; i < 100; ++i) copies += "h\1h\0\x85R"s;
  EXPECT_THAT(ErrorOfPickle(Pickle(copies)), HasSubstr("more than 4000000 values"));
}

TEST(ReadPickle, SurvivesDepth) {
  EXPECT_EQ(Read(Pickle("N" + std::string(3'000'000, '\x85'))).value.kind, PickleKind::kTuple);
}

TEST(ReadPickle, CallsNothing) {
  EXPECT_THAT(ErrorOfPickle(Pickle(Call(Global("os", "system"), {Text("touch x")}))),
              StartsWith("f.pt: its pickle asks for 'os system', which is no part of a checkpoint and runs programs in "
                         "other readers; refused"));
  EXPECT_THAT(ErrorOfPickle(Pickle(Text("os") + Text("system") + "\x93")), HasSubstr("'os system'"));
  const Read harmless(Pickle(Global("pathlib", "PosixPath") + Tuple({Text("/")}) + "\x81"));
  EXPECT_EQ(harmless.heap.Describe(harmless.value), "an object of pathlib PosixPath");
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/networks/common/parameters.h"

#include <cstring>

#include "networks/golden_tensors.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

/// A file of float32 tensors of zeros, and "half" = 1, 2 in F16 and "integer" in I64.
void WriteCheckpoint(const std::filesystem::path& path, const std::map<std::string, std::vector<int64_t>>& shapes) {
  const std::vector<char> zeros(4096, '\0');
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [name, shape] : shapes) {
    TensorEntry entry{"F32", shape, {}};
    entry.bytes = std::string_view(zeros.data(), static_cast<size_t>(entry.numel()) * 4);
    tensors[name] = entry;
  }
  const std::vector<uint16_t> half = {0x3c00, 0x4000};
  tensors["half"] = {"F16", {2}, {reinterpret_cast<const char*>(half.data()), 4}};
  tensors["integer"] = {"I64", {1}, std::string_view(zeros.data(), 8)};
  WriteFileAtomically(path, SerializeSafetensors(tensors, {}));
}

TEST(FileParameters, OneErrorListsAllThatDoesNotFit) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"good", {2, 3}}, {"small", {2}}, {"stray", {1}}, {"both", {1}}, {"skip.me", {1}}});
  WriteCheckpoint(dir / "b.st", {{"both", {1}}});
  CheckpointOptions options;
  options.model = "Net S";
  options.ignored = {"skip.", "half"};
  FileParameters source({dir / "a.st", dir / "b.st"}, options);
  const ParameterScope at(source);
  EXPECT_EQ(at.Get("good", {2, 3}).sizes(), at::IntArrayRef({2, 3}));
  EXPECT_TRUE((at / "absent" / 3).Get("weight", {7}).is_meta());
  EXPECT_TRUE(at.Get("small", {2, 2}).is_meta());
  EXPECT_TRUE(at.Get("integer", {1}).is_meta());
  at.Unused("never there", {1});
  EXPECT_THAT(
      [&] { source.Finish(); },
      ThrowsMessage<InputError>(
          AllOf(StartsWith((dir / "a.st").string() + " + "), HasSubstr("does not hold Net S; "),
                HasSubstr("missing 1: absent.3.weight; "), HasSubstr("not part of it 2: both, stray; "),
                HasSubstr("twice there 2: both, integer; "), HasSubstr("no floating-point tensor 1: integer is I64; "),
                HasSubstr("of another shape 1: small is [2], expected [2, 2]; "),
                HasSubstr("get its official weights again"), Not(HasSubstr("skip")), Not(HasSubstr("\n")))));
}

TEST(FileParameters, LongListsAreCut) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"a\nname", {1}}});
  FileParameters source({dir / "a.st"}, {.ignored = {"half", "integer"}});
  for (int i = 0; i < 25; ++i) source.Get("layer" + std::to_string(i), {1});
  EXPECT_THAT([&] { source.Finish(); }, ThrowsMessage<InputError>(AllOf(
                                            HasSubstr("missing 25: layer0, layer1, "), HasSubstr("layer19 and 5 more"),
                                            Not(HasSubstr("layer20")), HasSubstr("not part of it 1: a?name"))));
}

TEST(FileParameters, WhatFitsPasses) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"net.good", {2, 3}}, {"other", {1}}, {"net.unused", {1}}});
  FileParameters source({dir / "a.st"}, {.prefix = "net."});
  source.Get("good", {2, 3});
  source.Unused("unused", {1});
  EXPECT_NO_THROW(source.Finish());
}

TEST(FileParameters, OlderNamesAreUnderstood) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"net.attn.query.weight", {2, 3}},
                                 {"net.to_q.weight", {1}},
                                 {"net.both.query.b", {1}},
                                 {"net.both.to_q.b", {1}}});
  FileParameters source({dir / "a.st"}, {.prefix = "net.", .older_names = {{".query.", ".to_q."}}});
  EXPECT_EQ(source.Get("attn.to_q.weight", {2, 3}).sizes(), at::IntArrayRef({2, 3}));
  source.Get("to_q.weight", {1});
  source.Get("both.to_q.b", {1});
  EXPECT_THAT([&] { source.Finish(); }, ThrowsMessage<InputError>(HasSubstr("; twice there 1: both.to_q.b; get")));
}

TEST(FileParameters, AMatrixMayBeStoredAsTheConvolutionOfAPixel) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"pixel", {2, 3, 1, 1}}, {"turned", {3, 2, 1, 1}}, {"wide", {2, 3, 1, 3}}});
  FileParameters source({dir / "a.st"}, {.ignored = {"half", "integer"}});
  EXPECT_EQ(source.Get("pixel", {2, 3}).sizes(), at::IntArrayRef({2, 3}));
  source.Get("turned", {2, 3});
  source.Get("wide", {2, 3});
  EXPECT_THAT([&] { source.Finish(); },
              ThrowsMessage<InputError>(HasSubstr("of another shape 2: turned is [3, 2, 1, 1], "
                                                  "expected [2, 3], wide is [2, 3, 1, 3]")));
}

TEST(FileParameters, TensorsAreTheMappedFileAndOutliveTheSource) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"good", {2, 3}}});
  Tensor first, second;
  {
    FileParameters source({dir / "a.st"}, {});
    first = source.Get("good", {2, 3});
    second = source.Get("good", {2, 3});
  }
  EXPECT_EQ(first.data_ptr(), second.data_ptr());
  EXPECT_EQ(first.abs().max().item<float>(), 0);
}

TEST(FileParameters, TypesAreConverted) {
  const TempDir dir;
  WriteCheckpoint(dir / "a.st", {{"trunk.w", {2}}, {"head.w", {2}}});
  FileParameters source({dir / "a.st"}, {.cast_type = torch::kBFloat16, .cast_prefix = "trunk."});
  EXPECT_EQ(source.Get("trunk.w", {2}).scalar_type(), torch::kBFloat16);
  EXPECT_EQ(source.Get("head.w", {2}).scalar_type(), torch::kFloat);
  const Tensor half = source.Get("half", {2});
  EXPECT_EQ(half.scalar_type(), torch::kFloat);
  EXPECT_TRUE(torch::equal(half, torch::tensor({1.f, 2.f})));
}

TEST(FileParameters, UnalignedTensorsAreCopied) {
  // A header whose length is no multiple of the element's size: allowed, and made by some writers.
  const std::string header = R"({"w":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})" + std::string(3, ' ');
  std::string bytes(8, '\0');
  bytes[0] = static_cast<char>(header.size());
  const float value = 3.5f;
  bytes += header + std::string(reinterpret_cast<const char*>(&value), 4);
  ASSERT_NE((8 + header.size()) % 4, 0u);
  const TempDir dir;
  WriteFileAtomically(dir / "a.st", bytes);
  FileParameters source({dir / "a.st"}, {});
  EXPECT_EQ(source.Get("w", {1}).item<float>(), value);
}

TEST(FileParameters, AMissingFileIsNamed) {
  const TempDir dir;
  EXPECT_THAT([&] { FileParameters({dir / "none.st"}, {}); }, ThrowsMessage<InputError>(HasSubstr("none.st")));
}

TEST(ListedParameters, HoldsNamesAndShapesWithoutMemory) {
  ListedParameters list;
  const ParameterScope at(list);
  const Tensor huge = (at / "blocks" / 2).Get("weight", {1 << 20, 1 << 20});
  EXPECT_TRUE(huge.is_meta());
  at.Unused("mask", {5});
  EXPECT_EQ(list.shapes(),
            (std::map<std::string, std::vector<int64_t>>{{"blocks.2.weight", {1 << 20, 1 << 20}}, {"mask", {5}}}));
}

TEST(RandomParameters, HaveTheSizeThatKeepsActivations) {
  const auto make = [](uint64_t seed) {
    RandomParameters source(seed);
    return std::vector<Tensor>{source.Get("fc.weight", {300, 400}), source.Get("norm.weight", {401}),
                               source.Get("fc.bias", {33})};
  };
  const int before = NumThreads();
  SetNumThreads(1);
  const auto one = make(5);
  SetNumThreads(2);
  const auto two = make(5), other = make(6);
  SetNumThreads(before);
  EXPECT_NEAR(one[0].square().mean().item<double>() * 400, 1, 0.02);
  EXPECT_NEAR(one[1].mean().item<double>(), 1, 0.02);
  EXPECT_NEAR(one[2].mean().item<double>(), 0, 0.05);
  for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(torch::equal(one[i], two[i]));
  EXPECT_FALSE(torch::equal(one[0], other[0]));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/weights/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/sha256.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

/// A file with these tensors, all zero.
std::string Zeros(const std::map<std::string, std::vector<int64_t>>& shapes, const std::string& dtype = "F16") {
  static const std::string kZeros(size_t{1} << 26, '\0');
  std::map<std::string, TensorEntry> tensors;
  for (const auto& [name, shape] : shapes) {
    TensorEntry entry{dtype, shape, {}};
    entry.bytes = std::string_view(kZeros).substr(0, static_cast<size_t>(entry.numel()) * (dtype == "I64" ? 8 : 2));
    tensors[name] = entry;
  }
  return SerializeSafetensors(tensors, {});
}

WeightsFaults Compare(const std::string& bytes, const std::string& list) {
  std::map<std::string, TensorLayout> held;
  const SafetensorsFile file = SafetensorsFile::Parse(bytes, "f");
  for (const auto& [name, entry] : file.tensors()) held[name] = {entry.dtype, entry.shape};
  return CompareParameters(held, ParseParameterList(list));
}

const std::string kList = "ignore text.\na 2x3\n?b 4\n";

TEST(CompareParameters, AcceptsOptionalAndIgnoredTensors) {
  EXPECT_TRUE(Compare(Zeros({{"a", {2, 3}}}), kList).only_extra());
  EXPECT_THAT(Compare(Zeros({{"a", {2, 3}}}), kList).extra, testing::IsEmpty());
  EXPECT_TRUE(Compare(Zeros({{"a", {2, 3}}, {"b", {4}}, {"text.x", {9}}}), kList).only_extra());
  EXPECT_TRUE(Compare(Zeros({{"module.a", {2, 3}}}), kList).only_extra());
}

TEST(CompareParameters, ListsFaults) {
  const WeightsFaults faults = Compare(Zeros({{"b", {5}}, {"c\n", {1}}, {"module.a", {2, 3}}}), kList);
  EXPECT_THAT(faults.missing, ElementsAre("a"));
  EXPECT_THAT(faults.extra, ElementsAre("c?", "module.a"));
  EXPECT_THAT(faults.wrong_shape, ElementsAre("b is [5], expected [4]"));
  EXPECT_THAT(Compare(Zeros({{"a", {2, 3}}}, "I64"), kList).wrong_type, ElementsAre("a is I64"));
}

TEST(CheckWeights, ListsTheFirstTwentyOfEachKind) {
  const TempDir dir;
  std::map<std::string, std::vector<int64_t>> shapes;
  for (const auto& [name, tensor] : ParametersOf("lpips-alex").tensors) shapes[name] = tensor.shape;
  const auto path = dir / "model.safetensors";
  WriteFileAtomically(path, Zeros(shapes));
  const WeightsInfo& model = WeightsNamed("lpips-alex");
  EXPECT_EQ(CheckWeights(model, path, Silent()), 15u);
  shapes["stray"] = {1};
  WriteFileAtomically(path, Zeros(shapes));
  EventRecorder recorder;
  EXPECT_EQ(CheckWeights(model, path, recorder.AsListener()), 15u);
  EXPECT_THAT(recorder.warnings,
              ElementsAre(HasSubstr("1 tensors that are no part of lpips-alex and are not read: stray")));
  shapes.erase("stray");
  shapes["features.0.bias"] = {65};
  shapes.erase("lin4.model.1.weight");
  for (int i = 10; i < 33; ++i) shapes[fmt::format("new.{}", i)] = {1};
  WriteFileAtomically(path, Zeros(shapes));
  EXPECT_THAT([&] { CheckWeights(model, path, Silent()); },
              ThrowsMessage<InputError>(AllOf(
                  StartsWith(path.string() + ": does not hold lpips-alex; 1 missing: lin4.model.1.weight; 23 that "
                                             "are no part of it: new.10, new.11, "),
                  HasSubstr("new.29 and 3 more; 1 of another shape: features.0.bias is [65], expected [64]; "
                            "`oraclegs models fetch lpips-alex` gets its official weights"),
                  Not(HasSubstr("new.30")), Not(HasSubstr("\n")))));
}

TEST(CheckWeights, RefusesAForeignFile) {
  const TempDir dir;
  WriteFileAtomically(dir / "model.safetensors", "PK\3\4 pickle");
  EXPECT_THROW(CheckWeights(WeightsNamed("seva"), dir / "model.safetensors", Silent()), InputError);
}

TEST(CheckPublished, ComparesTheChecksum) {
  const TempDir dir;
  const auto path = dir / "model.safetensors";
  const std::string bytes(2'500'000, 'x');
  WriteFileAtomically(path, bytes);
  WeightsInfo model = WeightsNamed("vggt");
  model.files[0].sha256 = Sha256().Add(bytes).Hex();
  EventRecorder recorder;
  EXPECT_TRUE(CheckPublished(model, path, recorder.AsListener()));
  WriteFileAtomically(path, bytes + "y");
  EXPECT_THAT([&] { CheckPublished(model, path, Silent()); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("is not the file that the authors of vggt publish"),
                                              HasSubstr("expected " + model.files[0].sha256))));
}

TEST(RefuseAnotherNetwork, NamesTheNetworkThatAFileIsPublishedAs) {
  const TempDir dir;
  const auto path = dir / "model.safetensors";
  const std::string bytes(1000, 'x');
  WriteFileAtomically(path, bytes);
  WeightsInfo asked = WeightsNamed("seva"), other = WeightsNamed("seva-1.0");
  asked.download_bytes = 1000;
  EXPECT_NO_THROW(RefuseAnotherNetwork(asked, {asked, other}, path, Silent())) << "nobody publishes it";
  other.files[0].sha256 = Sha256().Add(bytes).Hex();
  EXPECT_THAT(
      [&] {
        RefuseAnotherNetwork(asked, {asked, other}, path, Silent());
      },
      ThrowsMessage<InputError>(
          AllOf(StartsWith(path.string() + ": holds seva-1.0, not seva"), HasSubstr("`oraclegs models fetch seva`"))));
  EXPECT_NO_THROW(RefuseAnotherNetwork(other, {asked, other}, path, Silent())) << "it is what it should be";
  asked.download_bytes = 5000;
  EXPECT_NO_THROW(RefuseAnotherNetwork(asked, {asked, other}, path, Silent())) << "far too short: it is not read";
}

TEST(CheckPublished, IsNotPossibleForAllFiles) {
  EXPECT_FALSE(CheckPublished(WeightsNamed("lpips-alex"), "model.safetensors", Silent())) << "is converted";
  EXPECT_FALSE(CheckPublished(WeightsNamed("vggt-commercial"), "model.safetensors", Silent()))
      << "is published nowhere";
  EXPECT_FALSE(CheckPublished(WeightsNamed("vggt"), "model.safetensors.index.json", Silent())) << "has parts";
}

}  // namespace
}  // namespace oraclegs

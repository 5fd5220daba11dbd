#include "oraclegs/workspace/stage_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

StageRecords Inspect(const TempDir& dir, const std::string& text) {
  WriteText(dir / "stages.json", text);
  return InspectStageRecords(dir.path());
}

TEST(StageRecords, AreEmptyWhereThereIsNoFile) {
  const TempDir dir;
  const StageRecords records = InspectStageRecords(dir.path());
  EXPECT_TRUE(records.is_readable);
  EXPECT_EQ(records.by_stage, json::object());
  EXPECT_THAT(records.damaged, IsEmpty());
}

TEST(UnfinishedSplat, IsNamedByItsRecord) {
  const TempDir dir;
  EXPECT_EQ(UnfinishedSplat(dir.path()), "");
  Inspect(dir, R"({"best so far": {"of": "draft model", "worth": 3}})");
  EXPECT_EQ(UnfinishedSplat(dir.path()), "draft model");
  std::string said;
  WarnOfUnfinished(dir.path(), [&](const Event& event) { said = std::get<Warning>(event).text; });
  EXPECT_THAT(said, testing::HasSubstr("point_cloud.ply: its run was stopped: this is its draft model"));
  Inspect(dir, R"({"best so far": {"of": 3}})");
  EXPECT_EQ(UnfinishedSplat(dir.path()), "") << "a damaged record is none";
}

TEST(StageRecords, SayWhenTheFileIsNone) {
  const TempDir dir;
  for (const char* text : {"{\"train\":", "", "[]", "null", "3", "\xff\xfe"}) {
    const StageRecords records = Inspect(dir, text);
    EXPECT_FALSE(records.is_readable) << text;
    EXPECT_EQ(records.by_stage, json::object()) << text;
  }
  std::filesystem::remove(dir / "stages.json");
  std::filesystem::create_directory(dir / "stages.json");
  EXPECT_FALSE(InspectStageRecords(dir.path()).is_readable);
}

TEST(StageRecords, LeaveOutWhatHasAnotherType) {
  const TempDir dir;
  const json sound = {{"key", "k"},
                      {"seconds", 1.5},
                      {"files", {"a", "b"}},
                      {"points", 7},
                      {"mean_confidence", {{"a", 0.5}}},
                      {"test", {{"psnr", nullptr}}},
                      {"milliseconds_per_iteration", nullptr},
                      {"network", nullptr},
                      {"of a later version", {1, 2}}};
  EXPECT_EQ(Inspect(dir, json{{"train", sound}}.dump()).by_stage.at("train"), sound);
  const std::pair<const char*, json> damage[] = {{"key", 1},
                                                 {"seconds", "abc"},
                                                 {"files", "a"},
                                                 {"files", {1}},
                                                 {"points", nullptr},
                                                 {"gaussians", "x"},
                                                 {"targets", 4e64},
                                                 {"seconds", -1e300},
                                                 {"of", 3},
                                                 {"worth", "much"},
                                                 {"mean_confidence", {{"a", "b"}}},
                                                 {"mean_confidence", 1},
                                                 {"test", json::array()},
                                                 {"milliseconds_per_iteration", 3},
                                                 {"network", {{"commercial", "yes"}}}};
  for (const auto& [name, value] : damage) {
    json record = sound;
    record[name] = value;
    const StageRecords records = Inspect(dir, json{{"depth", sound}, {"train", record}, {"sfm", 3}}.dump());
    EXPECT_THAT(records.damaged, ElementsAre("sfm", "train")) << name;
    EXPECT_EQ(records.by_stage, (json{{"depth", sound}})) << name;
    EXPECT_EQ(ReadStageRecords(dir.path()), records.by_stage);
  }
}

}  // namespace
}  // namespace oraclegs

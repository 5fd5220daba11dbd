#include "oraclegs/app/project.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ExportEdits, BecomeOptionsOfExport) {
  EXPECT_THAT(EditArguments({}), IsEmpty());
  const ExportEdits edits = EditsFromJson(json::parse(R"({"crop": "box:-1,-2,0,1,2,3.5", "up": "-y", "scale": 2.5,
      "min_support": 0.25, "max_uncertainty": 0.1, "remove_outliers": true})"),
                                          {});
  EXPECT_THAT(EditArguments(edits),
              ElementsAre("--crop", "box:-1,-2,0,1,2,3.5", "--up=-y", "--scale", "2.5", "--min-support", "0.25",
                          "--max-uncertainty", "0.1", "--remove-outliers"));
  EXPECT_EQ(EditsToJson(EditsFromJson(EditsToJson(edits), {})), EditsToJson(edits));
}

TEST(ExportEdits, WhatIsMissingStays) {
  const ExportEdits edits = EditsFromJson(json::parse(R"({"up": "z"})"), {.crop = "auto", .scale = 3});
  EXPECT_EQ(edits.crop, "auto");
  EXPECT_EQ(edits.up, "z");
  EXPECT_EQ(edits.scale, 3);
  EXPECT_EQ(EditsFromJson(json::parse(R"({"scale": "auto"})"), {.scale = 3}).scale, 0);
}

TEST(ExportEdits, NothingElseReachesTheCommandLine) {
  for (const char* text : {R"({"crop": "box:1,2,3"})", R"({"crop": "box:1,2,3,4,5,x"})", R"({"crop": "--out"})",
                           R"({"crop": "box:1,2,3,4,5,inf"})", R"({"crop": "box:1,2,3,4,5,6,"})", R"({"crop": 3})"}) {
    EXPECT_THAT(MessageOf<InputError>([&] { EditsFromJson(json::parse(text), {}); }), HasSubstr("crop")) << text;
  }
  for (const char* text :
       {R"({"up": "w"})", R"({"scale": 0})", R"({"scale": -1})", R"({"scale": "2; rm"})", R"({"min_support": 2})",
        R"({"min_support": "1"})", R"({"max_uncertainty": null})", R"({"remove_outliers": 1})", "[]", "3"}) {
    EXPECT_THROW(EditsFromJson(json::parse(text), {}), InputError) << text;
  }
}

TEST(ProjectRecord, IsReadAsItWasWritten) {
  const TempDir dir;
  const ProjectPaths paths(dir / "garden");
  WriteProjectRecord(paths, {"Zoë's garden", "high", "cpu", 7, true, {4711, 99}, {.up = "-z"}});
  const ProjectRecord record = ReadProjectRecord(paths);
  EXPECT_EQ(record.name, "Zoë's garden");
  EXPECT_EQ(record.quality, "high");
  EXPECT_EQ(record.device, "cpu");
  EXPECT_EQ(record.queued, 7);
  EXPECT_TRUE(record.started);
  EXPECT_EQ(record.process.number, 4711);
  EXPECT_EQ(record.process.started, 99);
  EXPECT_EQ(record.edits.up, "-z");
}

TEST(ProjectRecord, ADamagedOneKeepsTheProjectInReach) {
  const TempDir dir;
  const ProjectPaths paths(dir / "garden");
  for (const char* text : {"", "{", "[]", R"({"name": 3, "queued": "x", "process": [], "edits": {"up": 1}})"}) {
    WriteText(paths.record(), text);
    const ProjectRecord record = ReadProjectRecord(paths);
    EXPECT_EQ(record.name, "garden") << text;
    EXPECT_EQ(record.queued, 0);
    EXPECT_EQ(record.edits.up, "auto");
  }
}

TEST(CleanName, LeavesATitle) {
  EXPECT_EQ(CleanName("  My garden, 2nd try  "), "My garden, 2nd try");
  EXPECT_EQ(CleanName("../../etc/passwd"), "../../etc/passwd") << "a title, not a path";
  EXPECT_EQ(CleanName("a\nb"), "a?b");
  EXPECT_EQ(CleanName(std::string(100, 'x')).size(), 80u);
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ä";
  EXPECT_EQ(CleanName(umlauts).size(), 160u);
  EXPECT_THROW(CleanName("   "), InputError);
  EXPECT_THROW(CleanName("\xff"), InputError);
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/app/documents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/fake_program.h"
#include "support/wait_until.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::Not;

class DocumentsTest : public testing::Test {
 protected:
  json DocumentOf(const Project& of) { return ProjectDocument(parts, library.Find(of.id).value()); }
  void Finish(const Project& of) {
    WriteText(of.paths.splat() / "live" / "state.json", R"({"state": "finished", "elapsed_seconds": 120, "stages": [
        {"name": "train", "state": "done", "seconds": 100}], "warnings": ["a warning"]})");
    WriteText(of.paths.splat() / "point_cloud.ply", "splat");
    WriteText(of.paths.splat() / "metrics.json", R"({"test": {"psnr": 27.5}})");
    WriteText(of.paths.splat() / "report" / "run.json",
              R"({"views": [{"image": {"url": "report/0.jpg"}, "render": {"url": "report/1.jpg"}}]})");
  }

  TempDir dir;
  Library library{dir / "library"};
  std::filesystem::path program = WriteFakeProgram(
      dir.path(), R"(echo '{"warnings": ["photos that are blurred: IMG_1.jpg, xIMG_2.jpg, IMG_3.jpg2"]}')");
  Errands errands{program};
  RunQueue queue{program, &library};
  AppChoices choices{{{"draft", "Draft"}, {"normal", "Normal"}}, {{"auto", "Fastest"}}, "normal"};
  Pictures pictures;
  AppParts parts{library, queue, &errands, &pictures, choices};
  Project project = MakeProject(&library, 4);
};

TEST_F(DocumentsTest, TheLibraryHasAllProjectsAndChoices) {
  const json document = LibraryDocument(parts);
  EXPECT_EQ(document["folder"], library.root().string());
  EXPECT_EQ(document["qualities"][1]["label"], "Normal");
  EXPECT_EQ(document["default_quality"], "normal");
  EXPECT_EQ(document["devices"].size(), 1u);
  EXPECT_EQ(document["formats"].size(), ExportFormats().size());
  ASSERT_EQ(document["projects"].size(), 1u);
  const json& summary = document["projects"][0];
  EXPECT_EQ(summary["name"], "garden");
  EXPECT_EQ(summary["state"], "new");
  EXPECT_EQ(summary["photos"], 4);
  EXPECT_EQ(summary["progress"], nullptr);
  EXPECT_THAT(summary["picture"].get<std::string>(), testing::HasSubstr("/photos/"));
  EXPECT_THAT(summary["changed"].get<std::string>(), testing::MatchesRegex("20..-..-..T..:..:..Z"));
}

TEST_F(DocumentsTest, WhatIsAllowedFollowsTheState) {
  EXPECT_THAT(DocumentOf(project)["can"], testing::UnorderedElementsAre("start", "upload", "rename", "delete"));
  library.Update(project.id, [](ProjectRecord* record) { record->queued = 1 << 20; });
  const Project other = MakeProject(&library, 3, "other");
  WriteText(other.paths.splat() / "live" / "state.json", R"({"state": "interrupted"})");
  EXPECT_THAT(DocumentOf(other)["can"], Contains("view"));
  Finish(other);
  EXPECT_THAT(DocumentOf(other)["can"], Contains("export"));
  EXPECT_THAT(DocumentOf(other)["can"], Not(Contains("report"))) << "there is none";
}

TEST_F(DocumentsTest, AFinishedRunIsShown) {
  Finish(project);
  const json document = DocumentOf(project);
  EXPECT_EQ(document["state"], "finished");
  EXPECT_EQ(document["picture"], "projects/" + project.id + "/files/report/1.jpg");
  EXPECT_EQ(document["scores"]["psnr"], 27.5);
  EXPECT_EQ(document["stages"][0]["label"], "Making the splat");
  EXPECT_EQ(document["warnings"][0], "a warning");
  EXPECT_EQ(document["files"].size(), 4u);
  EXPECT_EQ(document["edits"]["crop"], "none");
  EXPECT_TRUE(document["exports"].empty());
  WriteText(project.paths.splat() / "report" / "run.json", R"({"views": [{"image": {"url": "report/another.jpg"}}]})");
  EXPECT_EQ(DocumentOf(project)["picture"], "projects/" + project.id + "/files/report/another.jpg");
  WriteText(ExportFile(project, *FindExportFormat("spz")), "12345");
  EXPECT_EQ(DocumentOf(project)["exports"][0]["bytes"], 5);
  EXPECT_EQ(DocumentOf(project)["exports"][0]["name"], "garden.spz");
}

TEST_F(DocumentsTest, WarningsNameTheirPhotos) {
  errands.Check(project);
  EXPECT_TRUE(WaitUntil([&] { return DocumentOf(project)["check"]["state"] == "done"; }));
  const json document = DocumentOf(project);
  const json& warning = document["check"]["warnings"][0];
  EXPECT_THAT(warning["text"].get<std::string>(), testing::HasSubstr("are blurred"));
  ASSERT_EQ(warning["files"].size(), 1u);
  EXPECT_EQ(warning["files"][0], document["files"][1]["id"]);
}

TEST_F(DocumentsTest, TimeIsEstimatedByEarlierRuns) {
  const Project other = MakeProject(&library, 2, "other");
  EXPECT_EQ(DocumentOf(other)["estimates"], json::object());
  Finish(project);
  EXPECT_EQ(DocumentOf(other)["estimates"]["normal"]["seconds"], 60) << "half as many photos";
  EXPECT_FALSE(DocumentOf(other)["estimates"].contains("draft"));
}

TEST_F(DocumentsTest, DamagedFilesDoNoHarm) {
  WriteText(project.paths.splat() / "live" / "state.json",
            R"({"state": 3, "stages": [1, {"name": 2}], "warnings": "x"})");
  WriteText(project.paths.splat() / "report" / "run.json",
            R"({"views": [3, {"image": []}, {"image": {"url": "../x"}}]})");
  WriteText(project.paths.splat() / "metrics.json", R"({"test": []})");
  const json document = DocumentOf(project);
  EXPECT_EQ(document["warnings"], json::array());
  EXPECT_EQ(document["scores"], nullptr);
}

}  // namespace
}  // namespace oraclegs

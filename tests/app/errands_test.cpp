#include "oraclegs/app/errands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/fake_program.h"
#include "oraclegs/core/files.h"
#include "support/wait_until.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

class ErrandsTest : public testing::Test {
 protected:
  Errands::Outcome CheckWith(const std::string& script) {
    Errands errands(WriteFakeProgram(dir.path(), script));
    errands.Check(project);
    EXPECT_TRUE(WaitUntil([&] { return errands.CheckOf(project.id).state != "running"; }));
    return errands.CheckOf(project.id);
  }

  TempDir dir;
  Library library{dir / "library"};
  Project project = MakeProject(&library, 3);
  const ExportFormat& spz = *FindExportFormat("spz");
};

TEST_F(ErrandsTest, ACheckBringsWhatTheProgramFinds) {
  const Errands::Outcome outcome = CheckWith(R"(echo '{"warnings": ["IMG_1.jpg is blurred"]}')");
  EXPECT_EQ(outcome.state, "done");
  EXPECT_EQ(outcome.result.at("warnings").at(0), "IMG_1.jpg is blurred");
  EXPECT_THAT(ReadFile(dir / "calls"), HasSubstr("info " + project.paths.photos().string() + " --check --json"));
}

TEST_F(ErrandsTest, AFailureHasItsReason) {
  const Errands::Outcome outcome = CheckWith("echo 'error: a.jpg: is no image' >&2; exit 3");
  EXPECT_EQ(outcome.state, "failed");
  EXPECT_EQ(outcome.message, "a.jpg: is no image");
  EXPECT_EQ(CheckWith("exit 3").message, "it ended with code 3");
}

TEST_F(ErrandsTest, AnExportTakesTheEdits) {
  project.record.edits = {.crop = "auto", .min_support = .5};
  Errands errands(WriteFakeProgram(dir.path(), "echo splat > \"$OUT\""));
  EXPECT_EQ(errands.ExportOf(project.id, spz).state, "none");
  errands.Export(project, spz);
  EXPECT_TRUE(WaitUntil([&] { return errands.ExportOf(project.id, spz).state == "done"; }));
  EXPECT_EQ(ReadFile(ExportFile(project, spz)), "splat\n");
  EXPECT_THAT(ReadFile(dir / "calls"), HasSubstr("--crop auto --min-support 0.5 --quiet"));
  errands.ForgetExport(project.id, spz);
  EXPECT_EQ(errands.ExportOf(project.id, spz).state, "none");
}

TEST_F(ErrandsTest, AMeshIsMadeByItsOwnCommand) {
  project.record.edits = {.crop = "auto", .up = "-y"};
  EXPECT_THAT(ExportArgv("oraclegs", project, *FindExportFormat("mesh"), "a mesh.glb"),
              testing::ElementsAre("oraclegs", "mesh", project.paths.splat().string(), "--out", "a mesh.glb", "--crop",
                                   "auto", "--quiet"));
  EXPECT_EQ(FindExportFormat("exe"), nullptr);
}

TEST_F(ErrandsTest, BytesAreCountedBehindTheScenes) {
  Errands errands(WriteFakeProgram(dir.path(), ""));
  errands.BytesOf(project);
  EXPECT_TRUE(WaitUntil([&] { return errands.BytesOf(project) > 0; }));
  EXPECT_GE(errands.BytesOf(project), 3u * 12);
}

TEST_F(ErrandsTest, TheEndWaitsForNoErrand) {
  Errands errands(WriteFakeProgram(dir.path(), "sleep 600"));
  errands.Check(project);
  EXPECT_TRUE(WaitUntil([&] { return std::filesystem::exists(dir / "calls"); }));
}

}  // namespace
}  // namespace oraclegs

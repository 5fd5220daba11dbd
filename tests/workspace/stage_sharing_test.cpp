#include "oraclegs/workspace/stage_sharing.h"

#include <sys/stat.h>

#include "run/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

class StageSharingTest : public testing::Test {
 protected:
  StageSharingTest() { std::filesystem::create_directories(temp / "scene"); }

  Workspace Claim(const std::string& name) { return Workspace::Claim(temp / name, temp / "scene", {}, false); }

  /// A workspace with these stages, each of which left a file of its name and key.
  void Donate(const std::string& name, const std::vector<std::string>& stages) {
    Workspace workspace = Claim(name);
    for (const std::string& stage : stages) {
      const std::string folder = stage == "register" ? "sfm" : stage == "propose" ? "proposals" : stage;
      std::filesystem::create_directories(temp / name / folder);
      WriteText(temp / name / folder / "file", name);
      workspace.MarkDone(stage, {{"key", name}, {"seconds", 3}, {"files", {folder + "/file"}}});
    }
  }

  TempDir temp;
};

TEST_F(StageSharingTest, TakesFilesAndRecordsOfTheDonorThatHasDepth) {
  Donate("points", {"sfm"});
  Donate("depth", {"sfm", "depth", "train"});
  Workspace workspace = Claim("out");
  TakeOverGeometry(&workspace, {temp / "missing", temp / "points", temp / "depth"});
  EXPECT_TRUE(workspace.IsDone("depth", "depth"));
  EXPECT_TRUE(workspace.IsDone("sfm", "depth"));
  EXPECT_TRUE(workspace.Record("train").is_null()) << "only what was asked for";
  EXPECT_EQ(ReadFile(temp / "out" / "depth" / "file"), "depth");
  WriteText(temp / "out" / "depth" / "file", "changed");
  EXPECT_EQ(ReadFile(temp / "depth" / "depth" / "file"), "depth") << "a copy, not a link";
}

TEST_F(StageSharingTest, TakesPointsWhereNobodyHasDepth) {
  Donate("registered", {"register"});
  Workspace workspace = Claim("out");
  TakeOverGeometry(&workspace, {temp / "registered"});
  EXPECT_TRUE(workspace.IsDone("register", "registered"));
}

TEST_F(StageSharingTest, TakesPosesAloneWhereNothingElseIsNeeded) {
  Donate("posed", {"sfm", "depth"});
  Donate("registered", {"register", "depth"});
  Workspace workspace = Claim("out");
  TakeOverRegistration(&workspace, {temp / "posed"});
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "sfm"));
  TakeOverRegistration(&workspace, {temp / "posed", temp / "registered"});
  EXPECT_TRUE(workspace.IsDone("register", "registered"));
  EXPECT_TRUE(workspace.Record("depth").is_null());
}

TEST_F(StageSharingTest, TakesProposalsWithTheirProxyModels) {
  Donate("donor", {"propose"});
  {
    Workspace donor = Workspace::Open(temp / "donor");
    donor.MarkDone("proxy 0", {{"key", "k"}, {"files", {"proposals/file"}}});
  }
  Workspace workspace = Claim("out");
  TakeOverProposals(&workspace, {temp / "donor"});
  EXPECT_TRUE(workspace.IsDone("propose", "donor"));
  EXPECT_TRUE(workspace.IsDone("proxy 0", "k"));
}

TEST_F(StageSharingTest, LeavesAloneWhatIsThere) {
  Donate("donor", {"sfm", "depth"});
  Donate("out", {"sfm"});
  Workspace workspace = Workspace::Open(temp / "out");
  TakeOverGeometry(&workspace, {temp / "out", temp / "donor"});
  EXPECT_TRUE(workspace.IsDone("sfm", "out"));
  EXPECT_TRUE(workspace.Record("depth").is_null());
}

TEST_F(StageSharingTest, PassesOverDonorsInUseAndDamagedOnes) {
  Donate("busy", {"depth"});
  Donate("damaged", {"depth"});
  Donate("good", {"depth"});
  WriteText(temp / "damaged" / "stages.json", "{");
  const Workspace busy = Workspace::Open(temp / "busy");
  Workspace workspace = Claim("out");
  TakeOverGeometry(&workspace, {temp / "busy", temp / "damaged", temp / "good"});
  EXPECT_TRUE(workspace.IsDone("depth", "good"));
}

TEST_F(StageSharingTest, BelievesNothingThatCouldNotBeCopied) {
  Donate("donor", {"sfm", "depth"});
  Workspace workspace = Claim("out");
  ASSERT_EQ(mkfifo((temp / "donor" / "depth" / "pipe").c_str(), 0600), 0);  // nothing that can be copied
  TakeOverGeometry(&workspace, {temp / "donor"});
  EXPECT_TRUE(workspace.Record("depth").is_null());
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "depth"));
}

}  // namespace
}  // namespace oraclegs

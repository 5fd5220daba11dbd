#include "oraclegs/propose/proposal_files.h"

#include <nlohmann/json.hpp>

#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/transforms.h"
#include "propose/rigs.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Proposal Gray(const std::string& name, const std::string& source, float value) {
  Proposal proposal{name, source, RigCamera({1, 2, 3}, {0, 0, 0}), {64, 48, 3, {}}};
  proposal.rgb.data.assign(64 * 48 * 3, value);
  return proposal;
}

json FrameJson(const std::string& name) {
  const json identity = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  return {{"file_path", name}, {"transform_matrix", identity}, {"fl_x", 5}, {"w", 6}, {"h", 4}};
}

class ProposalFilesTest : public ::testing::Test {
 protected:
  std::string ErrorOf(const std::vector<json>& frames) {
    WriteText(dir_ / "transforms.json", json{{"frames", frames}}.dump());
    return MessageOf<InputError>([&] { ReadTargets(dir_.path()); });
  }
  TempDir dir_;
};

TEST_F(ProposalFilesTest, WritesReadableTransforms) {
  const std::vector<Proposal> proposals = {Gray("orbit_0000", "warp", 0.2f), Gray("dir/IMG.v2.JPG", "warp", 0.4f)};
  EXPECT_THAT(WriteProposals(dir_.path(), proposals),
              ElementsAre("orbit_0000.png", "dir_IMG.v2.png", "transforms.json"));
  EventRecorder events;
  const Scene scene = ReadTransformsScene(dir_.path(), {}, events.AsListener());
  EXPECT_THAT(events.warnings, IsEmpty());
  ASSERT_EQ(scene.views.size(), 2u);
  EXPECT_EQ(scene.views[1].name, "orbit_0000.png");
  EXPECT_EQ(scene.views[1].intrinsics.fy(), 52);
  EXPECT_EQ(scene.views[1].intrinsics.cx(), 31);
  EXPECT_TRUE(scene.views[1].cam_from_world->isApprox(proposals[0].camera.cam_from_world, 1e-12));
  const Image8 image = ReadImage(dir_ / "dir_IMG.v2.png");
  EXPECT_EQ(image.width, 64);
  EXPECT_EQ(image.data[5], 102);
}

TEST_F(ProposalFilesTest, NamesCandidatesBySource) {
  EXPECT_THAT(WriteProposals(dir_.path(), {Gray("a", "warp", 0), Gray("a", "proxies", 0), Gray("a", "proxies", 0)}),
              ElementsAre("a_warp.png", "a_proxies.png", "a_proxies_2.png", "transforms.json"));
}

TEST_F(ProposalFilesTest, RefusesWrongImageSize) {
  Proposal proposal = Gray("a", "warp", 0);
  proposal.camera.width = 63;
  EXPECT_THROW(WriteProposals(dir_.path(), {proposal}), ShapeError);
}

TEST_F(ProposalFilesTest, RoundTripsTargets) {
  std::vector<Target> targets;
  for (const Camera& camera : RigAround(5)) targets.push_back({"t_" + std::to_string(targets.size()), camera});
  EXPECT_THAT(WriteTargets(dir_.path(), targets), ElementsAre("transforms.json"));
  const std::vector<Target> read = ReadTargets(dir_.path());
  ASSERT_EQ(read.size(), 5u);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(read[i].name, targets[i].name);
    EXPECT_EQ(read[i].camera.width, 64);
    EXPECT_EQ(read[i].camera.height, 48);
    EXPECT_EQ(read[i].camera.fx, 50);
    EXPECT_EQ(read[i].camera.cy, 24.5);
    EXPECT_TRUE(read[i].camera.cam_from_world.isApprox(targets[i].camera.cam_from_world, 1e-12));
  }
}

TEST_F(ProposalFilesTest, RefusesDamagedTargets) {
  EXPECT_THAT(MessageOf<InputError>([&] { ReadTargets(dir_ / "no"); }), HasSubstr("transforms.json"));
  EXPECT_THAT(ErrorOf({}), HasSubstr("has no \"frames\""));
  EXPECT_THAT(ErrorOf({FrameJson("a.png"), FrameJson("a.jpg")}),
              HasSubstr("frame 'a.jpg': another frame is called 'a'"));
  json distorted = FrameJson("a.png");
  distorted["k1"] = 0.1;
  EXPECT_THAT(ErrorOf({distorted}), HasSubstr("frame 'a.png': its camera model is OPENCV, a target needs a pinhole"));
  json huge = FrameJson("a.png");
  huge["w"] = 1e18;
  EXPECT_THAT(ErrorOf({huge}), HasSubstr("\"w\" is 1e+18"));
  WriteTargets(dir_.path(), {{"a", RigAround(1)[0]}});
  std::string text = json{{"frames", {FrameJson("a")}}}.dump();
  for (size_t n = 0; n < text.size(); n += 3) {
    WriteText(dir_ / "transforms.json", text.substr(0, n));
    EXPECT_THROW(ReadTargets(dir_.path()), InputError) << n;
  }
}

Target StoredTarget(const std::string& name, int width) {
  Target target{name, {}};
  target.camera.width = width, target.camera.height = 3;
  return target;
}

TEST(StoredProposer, AnswersWithTheFilesOfItsSource) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36, 255)});
  const StoredProposer proposer(dir.path(), "seva");
  const auto proposal = proposer.Propose(StoredTarget("view", 4), std::nullopt);
  ASSERT_TRUE(proposal);
  EXPECT_EQ(proposal->source, "seva");
  EXPECT_EQ(proposal->rgb.data, std::vector<float>(36, 1.f));
  EXPECT_FALSE(proposer.Propose(StoredTarget("other", 4), std::nullopt));
  EXPECT_FALSE(StoredProposer(dir.path(), "command").Propose(StoredTarget("view", 4), std::nullopt));
}

TEST(StoredProposer, CannotHoldAViewOut) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36)});
  EXPECT_FALSE(StoredProposer(dir.path(), "seva").Propose(StoredTarget("view", 4), 2));
}

TEST(StoredProposer, RefusesAnImageOfAnotherSize) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36)});
  EXPECT_THAT(
      MessageOf<InputError>([&] { StoredProposer(dir.path(), "seva").Propose(StoredTarget("view", 5), std::nullopt); }),
      testing::HasSubstr("is 4 x 3 with 3 channels, not 5 x 3"));
}

}  // namespace
}  // namespace oraclegs

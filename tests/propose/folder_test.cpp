#include "oraclegs/propose/folder.h"

#include "propose/proposal_folders.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using FolderTest = ProposalFolderTest;

TEST_F(FolderTest, ReadsWhatIsWritten) {
  std::vector<Proposal> written;
  for (const char* name : {"orbit_0000", "orbit_0001"}) {
    written.push_back({name, "warp", RigCamera({5, written.empty() ? 0. : 1., 2}, {0, 0, 0}), {64, 48, 3, {}}});
    for (int i = 0; i < 64 * 48 * 3; ++i) written.back().rgb.data.push_back(static_cast<float>(i % 256) / 255);
  }
  WriteProposals(dir_.path(), written);
  const FolderProposals read = Read();
  ASSERT_THAT(NamesOf(read), ElementsAre("orbit_0000", "orbit_0001"));
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.proposals[i].source, "folder");
    EXPECT_EQ(read.proposals[i].rgb.data, written[i].rgb.data);
    EXPECT_EQ(read.proposals[i].camera.fy, 52);
    EXPECT_TRUE(read.proposals[i].camera.cam_from_world.isApprox(written[i].camera.cam_from_world, 1e-12));
    EXPECT_THAT(read.confidence[i], IsEmpty());
  }
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(FolderTest, ResizesToWorkingSize) {
  WriteFrames({"twice", "square", "small"});
  Paint("twice.png", {255, 0, 51}, 128, 96);
  EditFrame(1, [](nlohmann::json* frame) { (*frame)["w"] = 512, (*frame)["h"] = 512, (*frame)["fl_x"] = 512; });
  Paint("square.png", {255, 0, 51}, 128, 128);
  Paint("small.png", {255, 0, 51}, 32, 24);
  const FolderProposals read = Read();
  ASSERT_EQ(read.proposals.size(), 3u);
  for (const Proposal& p : read.proposals) {
    EXPECT_EQ(p.rgb.width, p.camera.width);
    EXPECT_EQ(p.rgb.height, p.camera.height);
    for (size_t i = 0; i < p.rgb.data.size(); i += 3) EXPECT_NEAR(p.rgb.data[i + 2], 0.2f, 1e-5f);
  }
  EXPECT_EQ(read.proposals[0].camera.width, 64);
  EXPECT_EQ(read.proposals[0].camera.fx, 50);
  EXPECT_EQ(read.proposals[1].camera.width, 55);  // no training image is square: its own shape, as many pixels
  EXPECT_EQ(read.proposals[1].camera.height, 55);
  EXPECT_NEAR(read.proposals[1].camera.fx, 55, 1e-9);
  EXPECT_EQ(read.proposals[2].camera.width, 64);
}

TEST_F(FolderTest, IgnoresSizeOfTransforms) {
  WriteFrames({"a"});
  EditFrame(0, [](nlohmann::json* frame) { (*frame)["w"] = 1 << 20, (*frame)["h"] = 1 << 20; });
  Paint("a.png", {1, 2, 3}, 16, 16);
  EXPECT_EQ(Read().proposals.at(0).camera.width, 55);
}

TEST_F(FolderTest, CompositesOnBackground) {
  WriteFrames({"a"});
  Paint("a.png", {255, 255, 255, 51});
  request_.background = {1, 0, 0.5f};
  const ImageF rgb = Read().proposals.at(0).rgb;
  EXPECT_NEAR(rgb.data[0], 1, 1e-5);
  EXPECT_NEAR(rgb.data[1], 0.2, 1e-5);
  EXPECT_NEAR(rgb.data[2], 0.6, 1e-5);
}

TEST_F(FolderTest, SkipsOtherShapes) {
  WriteFrames({"a", "b"});
  Paint("a.png", {1, 2, 3});
  Paint("b.png", {1, 2, 3}, 48, 64);
  Paint("synthetic_1/1.png", {1, 2, 3}, 640, 484);  // less than 1 % off
  Paint("synthetic_1/2.png", {1, 2, 3}, 640, 515);  // more than 6 %
  EXPECT_THAT(NamesOf(Read()), ElementsAre("a"));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("(b.png)"), HasSubstr("more than 1 %"))));
  const FolderProposals official = Read("synthetic_1");
  ASSERT_THAT(NamesOf(official), ElementsAre("1"));
  EXPECT_EQ(official.proposals[0].rgb.height, 48);
  EXPECT_EQ(official.proposals[0].camera.fx, 50);
}

// As Stable Virtual Camera makes them: its sides are multiples of 64, and what stands over is cropped.
TEST_F(FolderTest, TakesViewsOfAnotherShapeForTheirMiddle) {
  Paint("synthetic_1/1.png", {1, 2, 3}, 896, 640);  // 64 x 48 at a scale of 14 is 896 x 672
  const FolderProposals read = Read("synthetic_1");
  ASSERT_THAT(NamesOf(read), ElementsAre("1"));
  Paint("synthetic_1/1.png", {1, 2, 3}, 896, 672);
  const Camera camera = read.proposals[0].camera, whole = Read("synthetic_1").proposals.at(0).camera;
  EXPECT_EQ(whole.height, 48);
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 46);  // 640 / 14 = 45.7
  const double down = 46 / (640 / 14.0);
  EXPECT_DOUBLE_EQ(camera.fx, whole.fx);
  EXPECT_DOUBLE_EQ(camera.fy, whole.fy * down);
  EXPECT_NEAR(camera.cy / down - 640 / 28.0, whole.cy - 24, 1e-12) << "the middle of the view stays the middle";
  EXPECT_EQ(read.proposals[0].rgb.height, 46);
  EXPECT_THAT(events_.warnings, ElementsAre());
  EXPECT_THAT(events_.notes, Contains(HasSubstr("middle")));
}

TEST_F(FolderTest, CutsTheConfidenceOfTheWholeViewToTheMiddle) {
  Paint("synthetic_1/1.png", {1, 2, 3}, 896, 640);  // 64 x 46
  Image8 map{64, 48, 1, std::vector<uint8_t>(64 * 48, 255)};
  std::fill(map.data.begin(), map.data.begin() + 64, uint8_t{0});  // the topmost row, which the image does not show
  std::filesystem::create_directories(dir_ / "synthetic_1_attention_maps");
  WritePng(dir_ / "synthetic_1_attention_maps/1.png", map);
  const FolderProposals read = Read("synthetic_1");
  ASSERT_EQ(read.confidence.size(), 1u);
  EXPECT_EQ(read.confidence[0].size(), 64u * 46);
  EXPECT_THAT(read.confidence[0], Each(1.f));
}

TEST_F(FolderTest, SkipsDamagedImages) {
  Paint("synthetic_1/1.png", {1, 2, 3});
  Paint("synthetic_1/2.png", {1, 2, 3});
  const std::filesystem::path damaged = dir_ / "synthetic_1/2.png";
  std::filesystem::resize_file(damaged, std::filesystem::file_size(damaged) / 2);
  EXPECT_THAT(NamesOf(Read()), ElementsAre("1"));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("(2.png)"), HasSubstr("cannot be read; copy them again"))));
}

TEST_F(FolderTest, SkipsTestPosesOfAnyName) {
  WriteTargets(dir_.path(), {{"a", request_.test[1].camera}, {"b", RigCamera({5, 1, 1}, {0, 0, 0})}});
  Paint("a.png", {1, 2, 3});
  Paint("b.png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("b"));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("(a.png)"), HasSubstr("the pose of a test view"))));
}

TEST_F(FolderTest, ReadsConfidence) {
  Paint("synthetic_1/1.png", {1, 2, 3}, 128, 96);
  Paint("synthetic_1/2.png", {1, 2, 3}, 128, 96);
  Paint("synthetic_1_attention_maps/1.png", {51}, 128, 96);
  Paint("synthetic_1_attention_maps/2.png", {255});
  const FolderProposals read = Read();
  ASSERT_EQ(read.confidence.size(), 2u);
  EXPECT_EQ(read.confidence[0].size(), 64u * 48);
  EXPECT_THAT(read.confidence[0], Each(FloatNear(0.2f, 1e-5f)));
  EXPECT_THAT(read.confidence[1], Each(1.f));
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(FolderTest, WarnsOfUnusableConfidence) {
  WriteFrames({"a", "b", "c", "d", "e", "f"});
  for (const char* name : {"a.png", "b.png", "c.png", "d.png", "e.png", "f.png"}) Paint(name, {1, 2, 3});
  Paint("confidence/a.png", {128});
  Paint("confidence/c.png", {128}, 32, 32);
  Paint("confidence/d.png", {200, 10, 10});
  WriteText(dir_ / "confidence/e.png", "no image");
  const FolderProposals read = Read();
  ASSERT_EQ(read.proposals.size(), 6u);
  EXPECT_EQ(read.confidence[0].size(), 64u * 48);
  for (size_t i = 1; i < 6; ++i) EXPECT_THAT(read.confidence[i], IsEmpty()) << i;
  EXPECT_THAT(
      events_.warnings,
      ::testing::UnorderedElementsAre(
          AllOf(HasSubstr("confidence: 1 confidence maps"), HasSubstr("another shape than"), HasSubstr(": c.png")),
          AllOf(HasSubstr("in colors"), HasSubstr(": d.png")), AllOf(HasSubstr("not readable"), HasSubstr(": e.png")),
          AllOf(HasSubstr("2 proposals have no confidence map"), HasSubstr("b.png, f.png"))));
}

TEST_F(FolderTest, WarnsWhenNothingIsLeft) {
  WriteFrames({"a", "b"});
  EXPECT_TRUE(Read().proposals.empty());
  ASSERT_EQ(events_.warnings.size(), 2u);
  EXPECT_THAT(events_.warnings[0],
              AllOf(HasSubstr("2 proposals are skipped (a.png, b.png)"), HasSubstr("no image file is there")));
  EXPECT_THAT(events_.warnings[1], HasSubstr("none of its proposals can be used; going on without them"));
}

TEST_F(FolderTest, RequiresWorkingSize) {
  request_.width = 0;
  EXPECT_THROW(Read(), ShapeError);
}

}  // namespace
}  // namespace oraclegs

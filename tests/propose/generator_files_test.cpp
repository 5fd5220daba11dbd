#include "oraclegs/propose/generator_files.h"

#include <fstream>

#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "propose/generator_folders.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

using GeneratorFilesTest = GeneratorFolderTest;

size_t CountOf(const Image8& gray, uint8_t value) {
  size_t count = 0;
  for (size_t i = 0; i < gray.data.size(); i += 3) count += gray.data[i] == value ? 1 : 0;
  return count;
}

TEST_F(GeneratorFilesTest, RequestHasPosesWarpsMasksAndViews) {
  WriteRequest();
  const std::vector<Target> asked = ReadTargets(paths.request());
  ASSERT_EQ(asked.size(), 2u);
  EXPECT_EQ(asked[1].name, "aside");
  EXPECT_TRUE(asked[1].camera.cam_from_world.isApprox(targets[1].camera.cam_from_world));
  for (const Target& target : asked) {
    const Image8 warp = ReadImage(paths.request() / "warps" / (target.name + ".png"));
    EXPECT_EQ(warp.width, target.camera.width);
    EXPECT_EQ(warp.height, target.camera.height);
  }
  const std::vector<Target> shown = ReadTargets(paths.request() / "images");
  ASSERT_EQ(shown.size(), 3u);
  EXPECT_EQ(shown[0].name, "left_p0");
  EXPECT_TRUE(shown[0].camera.cam_from_world.isApprox(views[0].camera.cam_from_world));
  EXPECT_EQ(ReadImage(paths.request() / "images" / "left_p0.png").data, ToImage8(views[0].rgb).data);
  EXPECT_TRUE(fs::is_empty(paths.answer()));
}

TEST_F(GeneratorFilesTest, MasksAreWhiteWhereViewsShowTheSurface) {
  WriteRequest();
  const Image8 front = ReadImage(paths.request() / "masks" / "front.png"),
               aside = ReadImage(paths.request() / "masks" / "aside.png");
  const size_t pixels = size_t{64} * 48;
  EXPECT_GT(CountOf(front, 255), size_t{96} * 72 * 8 / 10);
  EXPECT_GT(CountOf(aside, 0), pixels / 5) << "no view looks there";
  EXPECT_GT(CountOf(aside, 255), pixels / 20);
  EXPECT_EQ(CountOf(aside, 0) + CountOf(aside, 255), pixels);
}

TEST_F(GeneratorFilesTest, KnownPixelsAreWarpedOrBackground) {
  WarpedView view;
  view.evidence.resize(4);
  view.evidence[0].views = 2;
  view.evidence[1].views = 2, view.evidence[1].ring = 1;  // its depth was made up
  view.evidence[2].views = 0.05f;                         // no view is known to show it
  view.evidence[3].background = 1;
  EXPECT_EQ(KnownPixels(view), (std::vector<uint8_t>{255, 0, 0, 255}));
}

TEST_F(GeneratorFilesTest, AnEarlierRequestAndItsAnswersAreRemoved) {
  fs::create_directories(paths.request() / "warps");
  Answer("front.png", 96, 72);
  std::ofstream(paths.request() / "warps" / "old.png") << "old";
  WriteRequest();
  EXPECT_FALSE(fs::exists(paths.request() / "warps" / "old.png"));
  EXPECT_EQ(CountAnswers(paths, targets), 0u);
}

TEST_F(GeneratorFilesTest, ReadsOneImageForEachTarget) {
  WriteRequest();
  Answer("front.png", 96, 72);
  EXPECT_EQ(CountAnswers(paths, targets), 1u);
  Answer("aside.png", 64, 48);
  Answer("unasked.png", 10, 10);
  EXPECT_EQ(CountAnswers(paths, targets), 2u);
  const std::vector<Image8> images = ReadAnswers(paths, targets);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[1].data, std::vector<uint8_t>(size_t{64} * 48 * 3, 90));
}

TEST_F(GeneratorFilesTest, RefusesMissingAndUnfitAnswers) {
  WriteRequest();
  const auto error = [&] { return MessageOf<InputError>([&] { ReadAnswers(paths, targets); }); };
  Answer("aside.png", 64, 48);
  EXPECT_THAT(error(), AllOf(HasSubstr("answer/front.png: is missing (1 of 2 images are: front.png)"),
                             HasSubstr("request/transforms.json"), HasSubstr("log.txt")));
  Answer("front.png", 95, 72);
  EXPECT_THAT(error(), AllOf(HasSubstr("answer/front.png: is 95 x 72, its pose is for 96 x 72"), HasSubstr("w and h")));
  Answer("front.png", 96, 72, 4);
  EXPECT_THAT(error(), AllOf(HasSubstr("answer/front.png: has transparent pixels"), HasSubstr("alpha channel")));
  std::ofstream(paths.answer() / "front.png") << "no image";
  EXPECT_THAT(error(), AllOf(HasSubstr("answer/front.png"), HasSubstr("8-bit PNG or JPEG")));
}

}  // namespace
}  // namespace oraclegs

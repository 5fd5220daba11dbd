#include "oraclegs/settings/run_size.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "oraclegs/image/codecs.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

constexpr SceneSize kPhones{12, {4000, 3000}};

RunOptions On(Quality quality) {
  RunOptions options;
  options.quality.quality = quality;
  return options;
}

TEST(WithSize, ReducesPhonePhotosOnACpu) {
  const RunOptions settled = WithSize({}, kPhones, {false});
  EXPECT_EQ(WorkingSize({4000, 3000}, settled.image.Settled()), (PixelSize{1000, 750}));
  EXPECT_EQ(settled.train.max_gaussians, 100000);
  EXPECT_EQ(settled.propose.proposers, std::string("proxies"));
}

TEST(WithSize, TakesMoreOfEverythingOnAGpu) {
  const RunOptions cpu = WithSize({}, kPhones, {false}), gpu = WithSize({}, kPhones, {true});
  EXPECT_EQ(gpu.image.max_size, 1600);
  EXPECT_GT(gpu.train.iterations.value(), cpu.train.iterations.value());
  EXPECT_GT(gpu.train.max_gaussians.value(), cpu.train.max_gaussians.value());
}

TEST(WithSize, GrowsWithQuality) {
  const RunOptions draft = WithSize(On(Quality::kDraft), kPhones, {false}), normal = WithSize({}, kPhones, {false}),
                   high = WithSize(On(Quality::kHigh), kPhones, {false});
  EXPECT_LT(draft.image.max_size.value(), normal.image.max_size.value());
  EXPECT_LT(normal.image.max_size.value(), high.image.max_size.value());
  EXPECT_LT(draft.train.iterations.value(), normal.train.iterations.value());
  EXPECT_LT(normal.train.iterations.value(), high.train.iterations.value());
  EXPECT_LT(draft.train.max_gaussians.value(), normal.train.max_gaussians.value());
  EXPECT_LT(normal.train.max_gaussians.value(), high.train.max_gaussians.value());
  EXPECT_EQ(draft.stereo.geometric_passes, 1);
  EXPECT_EQ(normal.stereo.geometric_passes, 2);
}

TEST(WithSize, WarpsViewsForADraftOfFewPhotosAlone) {
  EXPECT_EQ(WithSize(On(Quality::kDraft), kPhones, {false}).propose.proposers, std::string("none"));
  EXPECT_EQ(WithSize(On(Quality::kDraft), {5, {4000, 3000}}, {false}).propose.proposers, std::string("warp"));
  RunOptions with_generator = On(Quality::kDraft);
  with_generator.propose.generator = "paint {request} {answer}";
  const RunOptions settled = WithSize(with_generator, kPhones, {false});
  EXPECT_TRUE(settled.propose.Uses("command")) << "a generator that is asked for is asked";
}

TEST(WithSize, TrainsSmallImagesForLonger) {
  EXPECT_GT(WithSize({}, {12, {480, 270}}, {false}).train.iterations.value(),
            WithSize({}, kPhones, {false}).train.iterations.value());
}

TEST(WithSize, TrainsFewPhotosForLess) {
  EXPECT_LT(WithSize({}, {3, {4000, 3000}}, {false}).train.iterations.value(),
            WithSize({}, kPhones, {false}).train.iterations.value());
}

TEST(WithSize, TakesAsManyGaussiansAsPhotosHoldInPlace) {
  for (const bool gpu : {false, true}) {
    EXPECT_EQ(WithSize({}, {3, {400, 300}}, {gpu}).train.max_gaussians, 35000) << "a tenth of the pixels of three";
    EXPECT_EQ(WithSize({}, {6, {400, 200}}, {gpu}).train.max_gaussians, 95000) << "a fifth of those of six";
    EXPECT_EQ(WithSize({}, {3, {64, 48}}, {gpu}).train.max_gaussians, 5000);
  }
}

TEST(WithSize, LeavesWhatTheUserSet) {
  RunOptions asked;
  asked.image.max_size = 0, asked.train.iterations = 70, asked.train.max_gaussians = 500;
  asked.propose.proposers = std::string("none");
  const RunOptions settled = WithSize(asked, kPhones, {false});
  EXPECT_EQ(settled.image.max_size, 0);
  EXPECT_EQ(settled.train.iterations, 70);
  EXPECT_EQ(settled.train.max_gaussians, 500);
  EXPECT_EQ(settled.propose.proposers, std::string("none"));
}

TEST(WithSize, DownscaleStandsInForMaxSize) {
  RunOptions asked;
  asked.image.downscale = 2;
  EXPECT_EQ(WorkingSize({4000, 3000}, WithSize(asked, kPhones, {false}).image.Settled()), (PixelSize{2000, 1500}));
}

TEST(WithSize, TrainsToTheHorizon) {
  RunOptions asked;
  asked.train.horizon = 30000;
  EXPECT_EQ(WithSize(asked, kPhones, {false}).train.iterations, 30000);
}

TEST(WithBackground, IsWhiteBehindWhatStandsBeforeWhite) {
  const TempDir dir;
  Image8 photo{64, 48, 3, std::vector<uint8_t>(64 * 48 * 3, 255)};
  for (size_t i = 0; i < 64; ++i) photo.data[3 * (64 * 24) + i] = 90;
  Scene scene;
  scene.views.resize(2);
  for (SceneView& view : scene.views) view.image_path = dir / "photo.png";
  WritePng(dir / "photo.png", photo);
  const RunOptions white = WithBackground({}, scene);
  EXPECT_EQ(white.image.background, Background::kWhite);
  EXPECT_NE(DescribeSize({}, WithSize(white, kPhones, {false}), kPhones).find("a white background (--background)"),
            std::string::npos);
  EXPECT_EQ(WithSavedSize({}, SizeToJson(WithSize(white, kPhones, {false}))).image.background, Background::kWhite);
  EXPECT_FALSE(SizeToJson(WithSize({}, kPhones, {false})).contains("background")) << "nothing looked at the photos";
  RunOptions asked;
  asked.image.background = Background::kGray;
  EXPECT_EQ(WithBackground(asked, scene).image.background, Background::kGray);
  scene.views[1].mask_path = dir / "mask.png";
  EXPECT_EQ(WithBackground({}, scene).image.background, Background::kBlack);
  scene.views[1].mask_path.clear();
  RunOptions masked;
  masked.masks.masks = "true";
  EXPECT_EQ(WithBackground(masked, scene).image.background, Background::kBlack) << "the masks are still to come";
  std::fill_n(photo.data.begin(), 3 * 64 * 10, uint8_t{40});
  WritePng(dir / "photo.png", photo);
  EXPECT_EQ(WithBackground({}, scene).image.background, Background::kBlack);
}

TEST(SavedSize, IsWhatWasSettled) {
  const RunOptions settled = WithSize(WithBackground(On(Quality::kDraft), {}), kPhones, {false});
  const RunOptions again = WithSize(WithSavedSize(On(Quality::kDraft), SizeToJson(settled)), kPhones, {true});
  EXPECT_EQ(RunOptionsToJson(again), RunOptionsToJson(settled));
}

TEST(SavedSize, IgnoresDamage) {
  const nlohmann::json damaged = {
      {"max-size", "large"}, {"iterations", nullptr}, {"proposers", "nobody"}, {"background", "pink"}};
  EXPECT_EQ(RunOptionsToJson(WithSavedSize({}, damaged)), RunOptionsToJson({}));
  EXPECT_EQ(RunOptionsToJson(WithSavedSize({}, nullptr)), RunOptionsToJson({}));
}

TEST(WithUsualSizes, HoldsViewsOutAtFullSize) {
  const RunOptions usual = WithUsualSizes({});
  EXPECT_TRUE(usual.split.eval);
  EXPECT_EQ(WorkingSize({4000, 3000}, usual.image.Settled()), (PixelSize{4000, 3000}));
  EXPECT_EQ(usual.train.iterations, kUsualIterations);
}

TEST(DescribeSize, NamesWhatWasDecided) {
  const RunOptions settled = WithSize({}, kPhones, {false});
  const std::string text = DescribeSize({}, settled, kPhones);
  EXPECT_NE(text.find("photos of 4000x3000 are used at 1000x750 (--max-size 1000)"), std::string::npos) << text;
  EXPECT_NE(text.find("--quality normal"), std::string::npos) << text;
  EXPECT_EQ(DescribeSize(settled, settled, kPhones), "");
}

TEST(WithSize, FitsIntoTheMemoryOfAGpu) {
  const SceneSize many{24, {4000, 3000}};
  RunOptions before = WithSize(On(Quality::kHigh), many, {true});
  EXPECT_GT(GpuBytes(before, many), 8'000'000'000);
  for (const int64_t gigabytes : {24, 12, 8, 6, 2}) {
    const int64_t free = 1'000'000'000 * gigabytes;
    const RunOptions settled = WithSize(On(Quality::kHigh), many, {true, free});
    EXPECT_LT(GpuBytes(settled, many), free) << gigabytes;
    EXPECT_LE(settled.train.max_gaussians.value(), before.train.max_gaussians.value());
    EXPECT_LE(settled.image.max_size.value(), before.image.max_size.value());
    EXPECT_GE(settled.train.max_gaussians.value(), 100000);
    EXPECT_EQ(settled.train.iterations, before.train.iterations);
    before = settled;
  }
  EXPECT_LT(before.image.max_size.value(), 3200) << "two gigabytes";
  const RunOptions usual = WithSize({}, kPhones, {true});
  EXPECT_EQ(SizeToJson(WithSize({}, kPhones, {true, 24'000'000'000})), SizeToJson(usual)) << "plenty";
}

TEST(WithSize, ShrinksNothingThatTheUserSet) {
  RunOptions asked;
  asked.image.max_size = 1600, asked.train.max_gaussians = 5'000'000;
  const RunOptions settled = WithSize(asked, kPhones, {true, 1'000'000'000});
  EXPECT_EQ(settled.image.max_size, 1600);
  EXPECT_EQ(settled.train.max_gaussians, 5'000'000);
}

}  // namespace
}  // namespace oraclegs

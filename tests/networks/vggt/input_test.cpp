#include "oraclegs/networks/vggt/input.h"

#include "networks/fixtures.h"

namespace oraclegs::vggt {
namespace {

Image8 Flat(int width, int height, std::vector<uint8_t> pixel) {
  Image8 image{width, height, static_cast<int>(pixel.size()), {}};
  for (int i = 0; i < width * height; ++i) image.data.insert(image.data.end(), pixel.begin(), pixel.end());
  return image;
}

Image8 GoldenPhoto(const SafetensorsFile& file) {
  const auto& shape = file.Get("preproc.source_rgb_u8").shape;
  return {static_cast<int>(shape[1]), static_cast<int>(shape[0]), 3, file.Values<uint8_t>("preproc.source_rgb_u8")};
}

TEST(VggtInput, CropModeMatchesPillowToTheLastBit) {
  const SafetensorsFile file = OpenGolden("vggt_tiny");
  const Input input = PrepareInput({GoldenPhoto(file)}, Fit::kCrop);
  ExpectGolden(input.images[0], file, "preproc.images_crop", 1e-6);
}

TEST(VggtInput, PadModeCentersTheSameImageInWhite) {
  const SafetensorsFile file = OpenGolden("vggt_tiny");
  const Input padded = PrepareInput({GoldenPhoto(file)}, Fit::kPad);
  ASSERT_EQ(padded.images.sizes(), at::IntArrayRef({1, 3, 518, 518}));
  EXPECT_EQ(padded.places[0].top, 203);
  EXPECT_EQ(padded.images.slice(2, 0, 203).min().item<float>(), 1);
  EXPECT_EQ(padded.images.slice(2, 203 + 112).min().item<float>(), 1);
  const Tensor cropped = PrepareInput({GoldenPhoto(file)}, Fit::kCrop).images;
  EXPECT_TRUE(torch::equal(padded.images.slice(2, 203, 203 + 112), cropped));
}

TEST(VggtInput, PortraitsAreCroppedPaddedOrWhole) {
  const std::vector<Image8> portrait = {Flat(300, 400, {0, 128, 255})};
  const Input crop = PrepareInput(portrait, Fit::kCrop);
  EXPECT_EQ(crop.images.sizes(), at::IntArrayRef({1, 3, 518, 518}));
  EXPECT_EQ(crop.places[0].height, 686);
  EXPECT_EQ(crop.places[0].top, -84);
  const Input pad = PrepareInput(portrait, Fit::kPad);
  EXPECT_EQ(pad.places[0].width, 392);
  EXPECT_EQ(pad.places[0].left, 63);
  const Input whole = PrepareInput(portrait, Fit::kWhole);
  EXPECT_EQ(whole.images.sizes(), at::IntArrayRef({1, 3, 518, 392}));
  EXPECT_LT(MaxAbsError(whole.images[0].mean({1, 2}), torch::tensor({0.f, 128 / 255.f, 1.f})), 1e-6);
}

TEST(VggtInput, ViewsOfDifferentSizeMeetInTheLargest) {
  const Input input = PrepareInput({Flat(40, 30, {0, 0, 0}), Flat(30, 40, {0, 0, 0})}, Fit::kWhole, 56);
  ASSERT_EQ(input.images.sizes(), at::IntArrayRef({2, 3, 56, 56}));
  EXPECT_EQ(input.places[0].top, 7);
  EXPECT_EQ(input.places[1].left, 7);
  EXPECT_EQ(input.images[0].slice(1, 0, 7).min().item<float>(), 1);
  EXPECT_EQ(input.images[0].slice(1, 7, 49).max().item<float>(), 0);
}

TEST(VggtInput, TransparencyShowsWhite) {
  const Input input = PrepareInput({Flat(56, 56, {0, 100, 200, 128})}, Fit::kWhole, 56);
  EXPECT_LT(MaxAbsError(input.images[0].mean({1, 2}) * 255, torch::tensor({127.f, 177.f, 227.f})), 0.01);
}

TEST(VggtInput, RefusesWhatIsNoImage) {
  EXPECT_THROW(PrepareInput({}, Fit::kCrop), ShapeError);
  EXPECT_THROW(PrepareInput({Flat(0, 4, {1, 2, 3})}, Fit::kCrop), ShapeError);
  EXPECT_THROW(PrepareInput({Flat(4, 4, {1})}, Fit::kCrop), ShapeError);
}

}  // namespace
}  // namespace oraclegs::vggt

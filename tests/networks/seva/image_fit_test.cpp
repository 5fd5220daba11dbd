#include "oraclegs/networks/seva/image_fit.h"

#include "networks/seva/sampling_fixture.h"

namespace oraclegs::seva {
namespace {

Eigen::Matrix3d Intrinsics(const SafetensorsFile& file, const std::string& name) {
  const std::vector<double> k = file.Values<double>(name);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(k.data());
}

TEST(SevaImageFit, ImagesAndIntrinsicsMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  int cases = 0;
  for (const auto& [tensor, entry] : file.tensors()) {
    if (!tensor.starts_with("image.") || !tensor.ends_with(".in")) continue;
    ++cases;
    const std::string name = tensor.substr(0, tensor.size() - 2);
    const Tensor image = GoldenFloat(file, tensor);
    const Size original{image.size(3), image.size(2)};
    const std::vector<int64_t> wanted = file.Values<int64_t>(name + "size_stride");
    const Size working =
        wanted.size() == 3 ? Size{wanted[0], wanted[1]} : WorkingSize(original, wanted.at(0), wanted.at(1));
    const ImageFit fit = FitImage(original, working, FitMode::kCrop);
    ExpectRatio(ToWorkingSize(image, fit), GoldenTensor(file, name + "out"), 1e-4, name);
    const Eigen::Matrix3d k = FittedIntrinsics(Intrinsics(file, name + "K"), fit);
    EXPECT_LE((k - Intrinsics(file, name + "K_normalized")).cwiseAbs().maxCoeff(), 1e-4) << name;
  }
  EXPECT_GE(cases, 1);
}

/// A smooth image whose colors encode the position.
Tensor Gradient(int64_t height, int64_t width) {
  const Tensor y = (at::arange(height) + 0.5).div(static_cast<double>(height)).view({1, 1, height, 1});
  const Tensor x = (at::arange(width) + 0.5).div(static_cast<double>(width)).view({1, 1, 1, width});
  return at::cat({x.expand({1, 1, height, width}), y.expand({1, 1, height, width})}, 1).to(torch::kFloat);
}

TEST(SevaImageFit, WhatIsPaddedComesBackWhole) {
  for (const Size original : {Size{131, 81}, Size{60, 97}, Size{640, 512}}) {
    const ImageFit fit = FitImage(original, {128, 96}, FitMode::kPad);
    const Tensor image = Gradient(original.height, original.width);
    const Tensor working = ToWorkingSize(image, fit);
    EXPECT_EQ(working.size(2), 96);
    EXPECT_EQ(working.size(3), 128);
    const Tensor back = FromWorkingSize(working, fit);
    ASSERT_EQ(back.sizes(), image.sizes());
    EXPECT_LE(MaxAbsError(back, image), 0.02);
  }
}

TEST(SevaImageFit, CroppedStripsRepeatTheBorder) {
  const ImageFit fit = FitImage({100, 50}, {64, 64}, FitMode::kCrop);
  EXPECT_EQ(fit.left, -32);
  const Tensor back = FromWorkingSize(ToWorkingSize(Gradient(50, 100), fit), fit);
  EXPECT_EQ(back.size(3), 100);
  EXPECT_NEAR(back[0][0][25][2].item<double>(), 0.25, 0.02);
  EXPECT_NEAR(back[0][0][25][50].item<double>(), 0.5, 0.02);
}

TEST(SevaImageFit, ThePrincipalPointMovesWithTheImage) {
  Eigen::Matrix3d k;
  k << 90, 0, 50, 0, 90, 25, 0, 0, 1;
  const Eigen::Matrix3d crop = FittedIntrinsics(k, FitImage({100, 50}, {64, 64}, FitMode::kCrop));
  const Eigen::Matrix3d pad = FittedIntrinsics(k, FitImage({100, 50}, {64, 64}, FitMode::kPad));
  EXPECT_NEAR(crop(0, 2), 0.5, 1e-12);
  EXPECT_NEAR(pad(1, 2), 0.5, 1e-12);
  EXPECT_NEAR(crop(0, 0), 90 * 1.28 / 64, 1e-12);
  EXPECT_NEAR(pad(0, 0), 90 * 0.64 / 64, 1e-12);
}

TEST(SevaImageFit, RefusesEmptyImages) {
  EXPECT_THROW(WorkingSize({0, 5}, 576), ShapeError);
  EXPECT_THROW(WorkingSize({5, 5}, 0), ShapeError);
  EXPECT_THROW(FitImage({5, 5}, {0, 64}, FitMode::kCrop), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva

#include "oraclegs/scene/loaded_view.h"

#include <numeric>

#include "image/jpeg_files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A scene of one view in a folder of its own.
struct OneView {
  TempDir dir;
  Scene scene;

  OneView(int width, int height, SceneFormat format = SceneFormat::kColmap) {
    scene.root = dir.path();
    scene.format = format;
    SceneView view;
    view.name = "a.png";
    view.image_path = dir / "images" / "a.png";
    view.intrinsics = {CameraModel::kPinhole, width, height, {20, 22, width / 2., height / 2.}};
    view.cam_from_world = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3));
    scene.views.push_back(view);
  }
  SceneView& view() { return scene.views[0]; }
  void Write(const Image8& image) { WritePng(view().image_path, image); }
  LoadedView Load(const ImageOptions& options = {}) { return LoadViews(scene, {0}, options, Silent())[0]; }
};

Image8 Filled(int width, int height, std::vector<uint8_t> pixel) {
  Image8 image{width, height, static_cast<int>(pixel.size()), {}};
  for (int i = 0; i < width * height; ++i) image.data.insert(image.data.end(), pixel.begin(), pixel.end());
  return image;
}

TEST(BackgroundColor, GivesRgb) {
  EXPECT_THAT(BackgroundColor(Background::kBlack), ElementsAre(0.f, 0.f, 0.f));
  EXPECT_THAT(BackgroundColor(Background::kWhite), ElementsAre(1.f, 1.f, 1.f));
  EXPECT_THAT(BackgroundColor(Background::kGray), ElementsAre(0.5f, 0.5f, 0.5f));
}

TEST(LoadViews, KeepsThePixelsOfAPlainImage) {
  OneView one(12, 8);
  const Image8 image = SmoothImage(12, 8, 3);
  one.Write(image);
  const LoadedView loaded = one.Load();
  EXPECT_EQ(loaded.name, "a.png");
  EXPECT_EQ(ToImage8(loaded.rgb).data, image.data);
  EXPECT_TRUE(loaded.mask.empty());
  EXPECT_EQ(loaded.camera.fx, 20);
  EXPECT_EQ(loaded.camera.cam_from_world.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(LoadViews, DownscalesImageAndCamera) {
  OneView one(13, 9);
  const Image8 image = SmoothImage(13, 9, 3);
  one.Write(image);
  const LoadedView loaded = one.Load({.downscale = 2});
  EXPECT_EQ(loaded.rgb.width, 7);  // 6.5 and 4.5, rounded half up
  EXPECT_EQ(loaded.rgb.height, 5);
  EXPECT_EQ(loaded.rgb.data, ResizeArea(ToFloat(image), 7, 5).data);
  EXPECT_DOUBLE_EQ(loaded.camera.fx, 20 * 7 / 13.);
  EXPECT_DOUBLE_EQ(loaded.camera.fy, 22 * 5 / 9.);
  EXPECT_DOUBLE_EQ(loaded.camera.cx, 3.5);
  const Camera camera = WorkingCamera(one.view(), {.downscale = 2});
  EXPECT_EQ(camera.width, loaded.camera.width);
  EXPECT_EQ(camera.fx, loaded.camera.fx);
  EXPECT_EQ(one.Load({.downscale = 64}).rgb.data.size(), 3u);
}

TEST(LoadViews, ReadsAFittingDownscaledFolder) {
  OneView one(12, 8);
  one.Write(Filled(12, 8, {10, 10, 10}));
  const auto small = one.dir / "images_2" / "a.png";
  WritePng(small, Filled(6, 4, {200, 200, 200}));
  EXPECT_EQ(ToImage8(one.Load({.downscale = 2}).rgb).data[0], 200);
  EXPECT_EQ(ToImage8(one.Load({.downscale = 4}).rgb).data[0], 10);
  EXPECT_EQ(ToImage8(one.Load().rgb).data[0], 10);
  WritePng(small, Filled(5, 4, {200, 200, 200}));  // of another size: it is not what its name says
  EXPECT_EQ(ToImage8(one.Load({.downscale = 2}).rgb).data[0], 10);
}

TEST(LoadViews, UndistortsDownscaledAndFullFilesAlike) {
  OneView one(120, 80);
  one.view().intrinsics = {CameraModel::kRadial, 120, 80, {100, 60, 40, -0.2, 0.05}};
  const Image8 image = SmoothImage(120, 80, 3);
  one.Write(image);
  const LoadedView full = one.Load({.downscale = 2});
  WritePng(one.dir / "images_2" / "a.png", ToImage8(ResizeArea(ToFloat(image), 60, 40)));
  const LoadedView small = one.Load({.downscale = 2});
  EXPECT_EQ(full.camera.fx, small.camera.fx);
  EXPECT_TRUE(full.mask.empty());
  EXPECT_TRUE(small.mask.empty());
  ASSERT_EQ(full.rgb.data.size(), small.rgb.data.size());
  float largest = 0;
  for (size_t i = 0; i < full.rgb.data.size(); ++i) {
    largest = std::max(largest, std::abs(full.rgb.data[i] - small.rgb.data[i]));
  }
  EXPECT_LT(largest, 0.02f);
  EXPECT_NE(full.rgb.data, small.rgb.data);
}

TEST(LoadViews, ReducesAsPillowDoesWhereAskedTo) {
  OneView photo(13, 9), object(6, 4, SceneFormat::kBlender);
  const Image8 image = SmoothImage(13, 9, 3);
  photo.Write(image);
  const LoadedView loaded = photo.Load({.downscale = 2, .resize = ResizeFilter::kPillow});
  EXPECT_EQ(ToImage8(loaded.rgb).data, ResizeLikePillow(image, 7, 5).data);
  EXPECT_NE(loaded.rgb.data, photo.Load({.downscale = 2}).rgb.data);
  EXPECT_EQ(photo.Load({.resize = ResizeFilter::kPillow}).rgb.data, photo.Load().rgb.data) << "nothing is reduced";
  object.Write(Filled(6, 4, {200, 100, 7, 128}));
  const LoadedView half =
      object.Load({.downscale = 2, .resize = ResizeFilter::kPillow, .background = Background::kWhite});
  // int(255 * (200 / 255 * 128 / 255 + 127 / 255)): cut off, as bytes are where the public code composites.
  EXPECT_EQ(ToImage8(half.rgb).data[0], 227);
  EXPECT_EQ(ToImage8(half.rgb).data[2], 130);
  EXPECT_NEAR(half.alpha[0], 128 / 255., 1e-6);
}

TEST(LoadViews, CompositesBeforeFiltering) {
  OneView one(2, 2, SceneFormat::kBlender);
  Image8 image = Filled(2, 2, {255, 0, 0, 255});
  std::fill_n(image.data.begin(), 8, uint8_t{0});  // the upper row is transparent
  one.Write(image);
  const LoadedView white = one.Load({.downscale = 2, .background = Background::kWhite});
  EXPECT_THAT(white.rgb.data, ElementsAre(1.f, 0.5f, 0.5f));
  EXPECT_TRUE(white.mask.empty());  // what is behind a Blender scene is part of its images
  EXPECT_THAT(white.alpha, ElementsAre(0.5f));
  EXPECT_THAT(one.Load({.downscale = 2}).rgb.data, ElementsAre(0.5f, 0.f, 0.f));
}

TEST(LoadViews, KeepsTheAlphaOfABlenderScene) {
  OneView blender(2, 1, SceneFormat::kBlender), photos(2, 1, SceneFormat::kTransforms);
  Image8 image = Filled(2, 1, {10, 20, 30, 255});
  image.data[3] = 51;
  for (OneView* one : {&blender, &photos}) one->Write(image);
  EXPECT_THAT(blender.Load().alpha, ElementsAre(0.2f, 1.f));
  EXPECT_TRUE(photos.Load().alpha.empty());  // there it is a mask
  WritePng(blender.dir / "mask.png", Filled(2, 1, {0}));
  blender.view().mask_path = blender.dir / "mask.png";
  const LoadedView masked = blender.Load();
  EXPECT_THAT(masked.alpha, ElementsAre(0.2f, 1.f));
  EXPECT_THAT(masked.mask, ElementsAre(0, 0));
  blender.Write(Filled(2, 1, {10, 20, 30}));
  EXPECT_TRUE(blender.Load().alpha.empty());
}

TEST(LoadViews, MasksPhotosByAlpha) {
  OneView one(2, 2, SceneFormat::kTransforms);
  Image8 image = Filled(2, 2, {255, 255, 255, 255});
  image.data[3] = 127;
  image.data[7] = 128;
  one.Write(image);
  EXPECT_THAT(one.Load().mask, ElementsAre(0, 1, 1, 1));
  EXPECT_TRUE(one.Load({.downscale = 2}).mask.empty());  // three quarters of the pixel are used
  image.data[7] = image.data[11] = 0;
  one.Write(image);
  EXPECT_THAT(one.Load({.downscale = 2}).mask, ElementsAre(0));
}

TEST(LoadViews, KeepsStraightColorsAtSoftEdges) {
  OneView one(4, 2, SceneFormat::kTransforms);
  Image8 image = Filled(4, 2, {200, 100, 50, 255});
  image.data[4 * 1 + 3] = 153;                                                   // 0.6
  for (const size_t i : {2, 3}) std::fill_n(&image.data[4 * i], 4, uint8_t{0});  // black behind the edge
  one.Write(image);
  const LoadedView full = one.Load();
  EXPECT_NEAR(full.rgb.data[3], 200 / 255., 1e-6);
  EXPECT_THAT(full.mask, ElementsAre(1, 1, 0, 0, 1, 1, 1, 1));
  ASSERT_EQ(full.weights.size(), 8u);
  EXPECT_NEAR(full.weights[1], 0.6, 1e-6);
  EXPECT_EQ(full.weights[2], 0);
  EXPECT_EQ(full.weights[7], 1);
  // The filter weighs by alpha: the right pixel is half covered, and as bright as the object.
  const LoadedView half = one.Load({.downscale = 2});
  for (const size_t i : {0, 3}) {
    EXPECT_NEAR(half.rgb.data[i], 200 / 255., 1e-6);
    EXPECT_NEAR(half.rgb.data[i + 1], 100 / 255., 1e-6);
  }
  EXPECT_NEAR(half.weights.at(0), 0.9, 1e-6);
  EXPECT_NEAR(half.weights.at(1), 0.5, 1e-6);
  one.Write(Filled(4, 2, {200, 100, 50}));
  EXPECT_TRUE(one.Load().weights.empty());
}

TEST(LoadViews, JoinsMaskFileAndAlpha) {
  OneView one(2, 2);
  Image8 image = Filled(2, 2, {255, 255, 255, 255});
  image.data[3] = 0;
  one.Write(image);
  one.view().mask_path = one.dir / "masks" / "a.png";
  WritePng(one.view().mask_path, {2, 2, 1, {255, 127, 128, 255}});
  EXPECT_THAT(one.Load().mask, ElementsAre(0, 0, 1, 1));
  one.scene.format = SceneFormat::kBlender;
  EXPECT_THAT(one.Load().mask, ElementsAre(1, 0, 1, 1));
  WritePng(one.view().mask_path, {2, 2, 1, {255, 255, 255, 255}});
  EXPECT_TRUE(one.Load().mask.empty());
}

TEST(LoadViews, RefusesAMaskOfAnotherSize) {
  OneView one(4, 2);
  one.Write(Filled(4, 2, {9, 9, 9}));
  one.view().mask_path = one.dir / "masks" / "a.png";
  WritePng(one.view().mask_path, {3, 2, 1, std::vector<uint8_t>(6)});
  EXPECT_THAT(MessageOf<InputError>([&] { one.Load(); }),
              AllOf(HasSubstr("masks/a.png"), HasSubstr("3 x 2"), HasSubstr("4 x 2")));
}

TEST(LoadViews, FitsAFullSizeMaskToADownscaledFile) {
  OneView one(4, 2);
  one.Write(Filled(4, 2, {9, 9, 9}));
  WritePng(one.dir / "images_2" / "a.png", Filled(2, 1, {9, 9, 9}));
  one.view().mask_path = one.dir / "masks" / "a.png";
  WritePng(one.view().mask_path, {4, 2, 1, {0, 0, 255, 255, 0, 0, 255, 255}});
  EXPECT_THAT(one.Load({.downscale = 2}).mask, ElementsAre(0, 1));
}

TEST(LoadViews, MasksBlankPixelsOfUndistortion) {
  OneView one(40, 30);
  one.view().intrinsics = {CameraModel::kSimpleRadial, 40, 30, {30, -2, 15, 0.1}};  // the principal point lies outside
  one.Write(Filled(40, 30, {200, 100, 50}));
  const LoadedView loaded = one.Load();
  ASSERT_EQ(loaded.mask.size(), 1200u);
  const int counted = std::accumulate(loaded.mask.begin(), loaded.mask.end(), 0);
  EXPECT_GT(counted, 0);
  EXPECT_LT(counted, 1200);
  for (size_t i = 0; i < loaded.mask.size(); ++i) {
    if (loaded.mask[i] == 0) continue;
    EXPECT_NEAR(loaded.rgb.data[3 * i], 200 / 255., 1e-6);
  }
}

TEST(LoadViews, RefusesAnImageOfAnotherSize) {
  OneView one(12, 8);
  one.Write(Filled(13, 8, {1, 2, 3}));
  EXPECT_THAT(MessageOf<InputError>([&] { one.Load(); }),
              AllOf(HasSubstr("images/a.png"), HasSubstr("13 x 8"), HasSubstr("12 x 8")));
}

TEST(LoadViews, FitsIntrinsicsToTheStoredOrUprightImage) {
  const Image8 image = SmoothImage(24, 16, 3);
  const std::string jpeg = WithOrientation(EncodeJpeg(image), 6);
  OneView upright(16, 24), stored(24, 16);
  WriteText(upright.view().image_path, jpeg);
  WriteText(stored.view().image_path, jpeg);
  EXPECT_EQ(ToImage8(upright.Load().rgb).data, ReadImage(upright.view().image_path).data);
  EXPECT_EQ(ToImage8(stored.Load().rgb).data, ReadImage(stored.view().image_path, Orientation::kAsStored).data);
  OneView neither(16, 24);
  neither.Write(image);
  EXPECT_THAT(MessageOf<InputError>([&] { neither.Load(); }), HasSubstr("24 x 16"));
}

TEST(LoadViews, IgnoresTheOrientationOfAsStoredViews) {
  const Image8 wide = SmoothImage(24, 16, 3), square = SmoothImage(16, 16, 3);
  const auto load = [](const Image8& image, int orientation, int width, bool as_stored) {
    OneView one(width, 40 - width);
    if (image.width == image.height) one.view().intrinsics.height = width;
    one.view().as_stored = as_stored;
    WriteText(one.view().image_path, WithOrientation(EncodeJpeg(image), orientation));
    return ToImage8(one.Load().rgb).data;
  };
  const auto stored = load(wide, 1, 24, true), stored_square = load(square, 1, 16, true);
  for (const int orientation : {2, 3, 4}) {
    EXPECT_EQ(load(wide, orientation, 24, true), stored) << orientation;
    EXPECT_NE(load(wide, orientation, 24, false), stored) << orientation;
  }
  for (const int orientation : {5, 6, 7, 8}) {
    EXPECT_EQ(load(square, orientation, 16, true), stored_square) << orientation;
    EXPECT_NE(load(square, orientation, 16, false), stored_square) << orientation;
    EXPECT_EQ(load(wide, orientation, 24, true), stored) << orientation;
    EXPECT_EQ(load(wide, orientation, 16, true), load(wide, orientation, 16, false)) << orientation;
  }
}

TEST(ImageFile, IsTheDownscaledOneThatFits) {
  OneView one(12, 8);
  one.Write(Filled(12, 8, {10, 10, 10}));
  const auto small = one.dir / "images_2" / "a.png";
  EXPECT_EQ(ImageFile(one.view(), {.downscale = 2}), one.view().image_path);
  WritePng(small, Filled(6, 4, {200, 200, 200}));
  EXPECT_EQ(ImageFile(one.view(), {.downscale = 2}), small);
  EXPECT_EQ(ImageFile(one.view(), {.downscale = 1}), one.view().image_path);
  WritePng(small, Filled(5, 4, {200, 200, 200}));
  EXPECT_EQ(ImageFile(one.view(), {.downscale = 2}), one.view().image_path);
  // A turned one in the folder is held to the same rule.
  WriteText(small, WithOrientation(EncodeJpeg(SmoothImage(6, 4, 3)), 6));
  one.view().as_stored = true;
  EXPECT_EQ(ImageFile(one.view(), {.downscale = 2}), small);
  EXPECT_EQ(ToImage8(one.Load({.downscale = 2}).rgb).data, ReadImage(small, Orientation::kAsStored).data);
}

TEST(LoadViews, NamesDamagedFiles) {
  OneView one(12, 8);
  WriteText(one.view().image_path, "no image");
  EXPECT_THAT(MessageOf<InputError>([&] { one.Load(); }), HasSubstr("a.png"));
}

/// Four views of one size, each with its own gray.
Scene FourViews(const TempDir& dir) {
  Scene scene;
  scene.format = SceneFormat::kColmap;
  for (int i = 0; i < 4; ++i) {
    SceneView view;
    view.name = std::to_string(i) + ".png";
    view.image_path = dir / view.name;
    view.intrinsics = {CameraModel::kOpenCv, 30, 20, {25, 25, 15, 10, -0.1, 0, 0, 0.001}};
    view.cam_from_world = Eigen::Isometry3d::Identity();
    const auto gray = static_cast<uint8_t>(50 * i);
    WritePng(view.image_path, Filled(30, 20, {gray, gray, gray, static_cast<uint8_t>(i < 2 ? 0 : 255)}));
    scene.views.push_back(view);
  }
  return scene;
}

TEST(LoadViews, KeepsTheOrderOfViews) {
  const TempDir dir;
  const Scene scene = FourViews(dir);
  std::vector<int64_t> done;
  const auto loaded = LoadViews(scene, {3, 1, 2}, {}, [&done](const Event& event) {
    if (const auto* step = std::get_if<StepDone>(&event)) {
      EXPECT_EQ(step->stage, "load");
      EXPECT_EQ(step->total, 3);
      done.push_back(step->done);
    }
  });
  ASSERT_EQ(loaded.size(), 3u);
  EXPECT_EQ(loaded[0].name, "3.png");
  EXPECT_EQ(loaded[1].name, "1.png");
  EXPECT_EQ(loaded[2].name, "2.png");
  EXPECT_NEAR(loaded[0].rgb.data[0], 150 / 255., 1e-6);
  EXPECT_THAT(done, ElementsAre(1, 2, 3));
}

TEST(LoadViews, WarnsOfFullyMaskedViews) {
  const TempDir dir;
  EventRecorder events;
  LoadViews(FourViews(dir), {0, 1, 2, 3}, {}, events.AsListener());
  ASSERT_EQ(events.warnings.size(), 1u);
  EXPECT_THAT(events.warnings[0], HasSubstr("0.png, 1.png"));
  EXPECT_THAT(events.warnings[0], testing::Not(HasSubstr("2.png")));
}

TEST(LoadViews, GivesTheSameBitsForAnyThreadCount) {
  const TempDir dir;
  Scene scene = FourViews(dir);
  for (auto& view : scene.views) WritePng(view.image_path, SmoothImage(30, 20, 3));
  SetNumThreads(1);
  const auto one = LoadViews(scene, {0, 1, 2, 3}, {.downscale = 2}, Silent());
  SetNumThreads(4);
  const auto four = LoadViews(scene, {0, 1, 2, 3}, {.downscale = 2}, Silent());
  SetNumThreads(0);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(one[i].rgb.data, four[i].rgb.data);
}

TEST(LoadViews, StopsOnInterrupt) {
  OneView one(12, 8);
  one.Write(Filled(12, 8, {1, 2, 3}));
  RequestInterrupt(true);
  EXPECT_THROW(one.Load(), Interrupted);
  RequestInterrupt(false);
}

TEST(WorkingSize, LimitsTheLongerSide) {
  EXPECT_EQ(WorkingSize({4000, 3000}, {}), (PixelSize{4000, 3000}));
  EXPECT_EQ(WorkingSize({4032, 3024}, {.max_size = 1000}), (PixelSize{1000, 750}));
  EXPECT_EQ(WorkingSize({3024, 4032}, {.max_size = 1000}), (PixelSize{750, 1000}));
  EXPECT_EQ(WorkingSize({800, 600}, {.max_size = 1000}), (PixelSize{800, 600}));
  EXPECT_EQ(WorkingSize({4000, 3000}, {.max_size = 0}), (PixelSize{4000, 3000}));
  EXPECT_EQ(WorkingSize({4000, 3000}, {.downscale = 2, .max_size = 1000}), (PixelSize{1000, 750}));
  EXPECT_EQ(WorkingSize({100000, 1}, {.max_size = 10}), (PixelSize{10, 1}));
}

}  // namespace
}  // namespace oraclegs

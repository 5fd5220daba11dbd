#include "oraclegs/scene/masks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "image/jpeg_files.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/exif.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kSide = 20;

Image8 MaskOf(const std::function<uint8_t(int x, int y)>& level, int width = kSide, int height = kSide) {
  Image8 mask{width, height, 1, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mask.data.push_back(level(x, y));
  }
  return mask;
}

bool InDisc(int x, int y) { return (x - 10) * (x - 10) + (y - 10) * (y - 10) < 49; }

class MasksTest : public ::testing::Test {
 protected:
  SceneView& Add(const std::string& name, int width = kSide, int height = kSide) {
    SceneView view;
    view.name = name;
    view.image_path = dir_ / name;
    view.intrinsics.width = width;
    view.intrinsics.height = height;
    WritePng(view.image_path, {width, height, 3, std::vector<uint8_t>(static_cast<size_t>(3 * width * height), 90)});
    scene_.views.push_back(view);
    return scene_.views.back();
  }
  void AddMasked(const std::string& name, const Image8& mask) {
    SceneView& view = Add(name);
    view.mask_path = dir_ / ("masks/" + name);
    WritePng(view.mask_path, mask);
  }
  void Check() { CheckMasks(&scene_, events_.AsListener()); }
  std::string CheckError() {
    return MessageOf<InputError>([&] { Check(); });
  }
  /// Pixels that the mask of view 0 keeps.
  int Kept() {
    const SceneView& view = scene_.views[0];
    const Image8 mask = ReadMask(view, view.intrinsics.width, view.intrinsics.height, Orientation::kUpright);
    return static_cast<int>(std::count(mask.data.begin(), mask.data.end(), 255));
  }
  int DiscArea() const {
    const Image8 disc = MaskOf(InDisc);
    return static_cast<int>(std::count(disc.data.begin(), disc.data.end(), 1));
  }

  TempDir dir_;
  Scene scene_;
  EventRecorder events_;
};

TEST_F(MasksTest, TakesUsualMasksWithoutAWord) {
  for (const char* name : {"a.png", "b.png"}) AddMasked(name, MaskOf([](int x, int y) { return InDisc(x, y) * 255; }));
  Check();
  EXPECT_EQ(Kept(), DiscArea());
  EXPECT_THAT(events_.notes, IsEmpty());
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(MasksTest, ScalesMasksOfASmallValue) {
  for (const uint8_t white : {1, 2, 100}) {
    scene_.views.clear();
    events_ = {};
    for (const char* name : {"a.png", "b.png"}) {
      AddMasked(name, MaskOf([&](int x, int y) { return InDisc(x, y) ? white : uint8_t{0}; }));
    }
    Check();
    EXPECT_EQ(Kept(), DiscArea()) << int{white};
    EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("is taken for white"))) << int{white};
  }
}

TEST_F(MasksTest, RefusesLabels) {
  AddMasked("a.png", MaskOf([](int x, int) { return static_cast<uint8_t>(x % 3); }));
  EXPECT_THAT(CheckError(), AllOf(HasSubstr("masks/a.png"), HasSubstr("the values 0, 1, 2 of 255")));
}

TEST_F(MasksTest, RefusesMasksThatKeepNothing) {
  AddMasked("a.png", MaskOf(InDisc));
  AddMasked("b.png", MaskOf([](int, int) { return 255; }));
  EXPECT_THAT(CheckError(), AllOf(HasSubstr("masks/a.png: this mask ignores every pixel"), HasSubstr("is 1 of 255")));
  AddMasked("a.png", MaskOf([](int, int) { return 0; }));
  scene_.views.erase(scene_.views.begin(), scene_.views.begin() + 2);
  EXPECT_THAT(CheckError(), HasSubstr("masks/a.png: this mask ignores every pixel"));
}

TEST_F(MasksTest, ReadsMasksOf16Bits) {
  for (const uint16_t white : {1, 255, 65535}) {
    scene_.views.clear();
    SceneView& view = Add("a.png");
    view.mask_path = dir_ / "mask16.png";
    std::vector<uint16_t> values;
    for (const uint8_t in : MaskOf(InDisc).data) values.push_back(in ? white : 0);
    WritePng16(view.mask_path, kSide, kSide, values);
    Check();
    EXPECT_EQ(Kept(), DiscArea()) << white;
  }
}

TEST_F(MasksTest, ReadsMasksInColorsAndInAlpha) {
  const Image8 disc = MaskOf(InDisc);
  Image8 green{kSide, kSide, 3, {}}, alpha{kSide, kSide, 4, {}}, cut_out{kSide, kSide, 4, {}};
  for (size_t i = 0; i < disc.data.size(); ++i) {
    const auto in = static_cast<uint8_t>(disc.data[i] * 255);
    green.data.insert(green.data.end(), {0, static_cast<uint8_t>(in / 255 * 128), 0});
    alpha.data.insert(alpha.data.end(), {0, 0, 0, in});
    const auto shade = static_cast<uint8_t>(i % 200);
    cut_out.data.insert(cut_out.data.end(), {shade, shade, shade, in});
  }
  for (const Image8& mask : {green, alpha, cut_out}) {
    scene_.views.clear();
    AddMasked("a.png", mask);
    Check();
    EXPECT_EQ(Kept(), DiscArea());
  }
}

TEST_F(MasksTest, ReadsOpaqueMasksByTheirColors) {
  const Image8 disc = MaskOf(InDisc);
  Image8 soft{kSide, kSide, 4, {}};  // levels that are not those of black and white
  for (const uint8_t in : disc.data) {
    const auto level = static_cast<uint8_t>(in ? 240 : 20);
    soft.data.insert(soft.data.end(), {level, level, level, 255});
  }
  AddMasked("a.png", soft);
  Check();
  EXPECT_EQ(Kept(), DiscArea());
}

TEST_F(MasksTest, NamesPhotosWithoutAMask) {
  AddMasked("a.png", MaskOf([](int x, int y) { return InDisc(x, y) * 255; }));
  Add("b.png");
  Add("c.png");
  Check();
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("2 of 3 photos have no mask, so all of their pixels are used: "
                                                      "b.png, c.png")));
}

TEST_F(MasksTest, WarnsOfInvertedMasks) {
  for (const char* name : {"a.png", "b.png"}) AddMasked(name, MaskOf([](int x, int y) { return !InDisc(x, y) * 255; }));
  Check();
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("2 of 2 masks ignore the middle of the photo")));
}

TEST_F(MasksTest, WarnsOfMasksThatKeepAlmostNothing) {
  for (const char* name : {"a.png", "b.png"})
    AddMasked(name, MaskOf([](int x, int y) { return x + y == 0 ? 255 : 0; }));
  Check();
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("the masks keep 0.2 % of the pixels")));
}

TEST_F(MasksTest, ScalesMasksOfOneAspectAndRefusesOthers) {
  SceneView& view = Add("a.png", 2 * kSide, 2 * kSide);
  view.mask_path = dir_ / "mask.png";
  WritePng(view.mask_path, MaskOf([](int x, int y) { return InDisc(x, y) * 255; }));
  Check();
  EXPECT_EQ(Kept(), DiscArea());
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("the masks of a.png have another size")));
  WritePng(view.mask_path, MaskOf([](int, int) { return 255; }, kSide, 11));
  EXPECT_THAT(CheckError(), AllOf(HasSubstr("mask.png: is 20 x 11"), HasSubstr("40 x 40")));
  view.intrinsics.height = 22;  // not turned by EXIF, so a mask on its side is of something else
  WritePng(view.mask_path, MaskOf([](int, int) { return 255; }, 11, kSide));
  EXPECT_THAT(CheckError(), HasSubstr("mask.png: is 11 x 20"));
}

TEST_F(MasksTest, TurnsAMaskThatWasDrawnOnTheStoredPhoto) {
  SceneView& view = Add("a.jpg", 16, 24);  // upright
  WriteText(view.image_path, WithOrientation(EncodeJpeg({24, 16, 3, std::vector<uint8_t>(24 * 16 * 3, 90)}), 6));
  view.mask_path = dir_ / "mask.png";
  const Image8 top_of_stored = MaskOf([](int, int y) { return y < 4 ? 255 : 0; }, 24, 16);
  WritePng(view.mask_path, top_of_stored);
  Check();
  const Image8 upright = ReadMask(view, 16, 24, Orientation::kUpright);
  EXPECT_EQ(upright.data, MaskOf([](int x, int) { return x >= 12 ? 255 : 0; }, 16, 24).data);
  // The other way: drawn on the upright photo, whose camera describes the pixels as stored.
  WritePng(view.mask_path, upright);
  EXPECT_EQ(ReadMask(view, 24, 16, Orientation::kAsStored).data, top_of_stored.data);
}

TEST_F(MasksTest, WarnsOfMasksThatMayBeUpsideDown) {
  SceneView& view = Add("a.jpg");
  WriteText(view.image_path, WithOrientation(EncodeJpeg({kSide, kSide, 3, std::vector<uint8_t>(3 * 400, 90)}), 3));
  view.mask_path = dir_ / "mask.png";
  WritePng(view.mask_path, MaskOf([](int x, int y) { return InDisc(x, y) * 255; }));
  Check();
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("EXIF turns a.jpg by 180 degrees")));

  scene_.views.clear();
  events_ = {};
  AddMasked("a.png", MaskOf([](int x, int y) { return InDisc(x, y) * 255; }));
  std::string png = ReadFile(dir_ / "a.png");
  const std::string tiff("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x03\0\0\0\0\0\0", 26);
  png.insert(33, std::string("\0\0\0\x1a", 4) + "eXIf" + tiff + "CCCC");  // after the header
  WriteText(dir_ / "a.png", png);
  EXPECT_EQ(ReadExif(png).orientation, 3);
  Check();
  EXPECT_THAT(events_.warnings, IsEmpty()) << "no reader turns a PNG";
}

TEST_F(MasksTest, AreDroppedWithANote) {
  AddMasked("a.png", MaskOf([](int, int) { return 255; }));
  Add("b.png");
  DropMasks(&scene_, events_.AsListener());
  EXPECT_TRUE(scene_.views[0].mask_path.empty());
  DropMasks(&scene_, events_.AsListener());
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("its masks of a.png are not used: the command of --masks")));
}

}  // namespace
}  // namespace oraclegs

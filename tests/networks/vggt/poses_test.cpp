#include "oraclegs/networks/vggt/poses.h"

#include "networks/vggt/fixture.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs::vggt {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Image8 Pattern(int width, int height, int offset) {
  Image8 image{width, height, 3, {}};
  for (int i = 0; i < 3 * width * height; ++i) image.data.push_back(static_cast<uint8_t>(7 * i + offset));
  return image;
}

class PosesTest : public testing::Test {
 protected:
  PosesTest() {
    request.weights = WriteTinyVggt(dir / "tiny.safetensors");
    request.network = "VGGT-1B";
    request.images = {Pattern(56, 42, 0), Pattern(42, 56, 9), Pattern(56, 42, 31)};
    request.names = {"a.jpg", "b.jpg", "c.jpg"};
  }

  TempDir dir;
  PoseRequest request;
};

TEST_F(PosesTest, EveryImageGetsACameraInItsOwnPixels) {
  std::vector<std::string> notes;
  const PoseEstimate estimate =
      EstimatePoses(request, [&](const Event& event) { notes.push_back(std::get<Note>(event).text); });
  ASSERT_EQ(estimate.cameras.size(), 3u);
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(estimate.cameras[v].width, request.images[v].width);
    EXPECT_EQ(estimate.cameras[v].height, request.images[v].height);
    EXPECT_NO_THROW(estimate.cameras[v].Check("camera"));
  }
  for (const CloudPoint& point : estimate.cloud) EXPECT_GE(point.sights.size(), 2u);
  EXPECT_THAT(notes,
              testing::ElementsAre(AllOf(HasSubstr("VGGT-1B looks at 3 photos of 70 x 70 at once"), HasSubstr("GiB"))));
}

TEST_F(PosesTest, RefusesMoreThanTheMemoryHolds) {
  request.free_bytes = 1000;
  EXPECT_THAT(MessageOf<RunError>([&] { EstimatePoses(request, Silent()); }), HasSubstr("to look at 3 photos at once"));
  EXPECT_THAT(MessageOf<RunError>([&] { RequirePoseMemory(40, int64_t{3} << 30, uint64_t{2} << 30); }),
              AllOf(HasSubstr("3.0 GiB of memory to look at 40 photos"), HasSubstr("2.0 GiB are free"),
                    HasSubstr("--poses colmap")));
  EXPECT_NO_THROW(RequirePoseMemory(40, 5, 0));
}

TEST_F(PosesTest, RefusesWeightsThatDoNotFit) {
  WriteTinyVggt(request.weights, [](TinyVggtParts* parts) { parts->tensors.erase("depth_head.norm.weight"); });
  EXPECT_THAT(MessageOf<InputError>([&] { EstimatePoses(request, Silent()); }),
              HasSubstr("missing 1: depth_head.norm.weight"));
}

}  // namespace
}  // namespace oraclegs::vggt

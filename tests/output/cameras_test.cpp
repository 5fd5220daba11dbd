#include "oraclegs/output/cameras.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/transforms.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(DatasetNames, ArePlainAndUnique) {
  EXPECT_THAT(DatasetNames({"0001.JPG", "left/1.png", "left_1.jpg", "my photo's.jpeg", "größe.jpg", ".a.jpg"}),
              ElementsAre("0001.jpg", "left_1.jpg", "left_1_2.jpg", "my_photo_s.jpg", "größe.jpg", "_.a.jpg"));
}

TEST(DatasetNames, DropTheFolderOfAllViews) {
  EXPECT_THAT(DatasetNames({"images/000.png", "images/001.png"}), ElementsAre("000.jpg", "001.jpg"));
}

class CamerasTest : public testing::Test {
 protected:
  ~CamerasTest() override { RequestInterrupt(false); }

  PosedScene Read(int downscale = 1) {
    request.options.image.downscale = downscale;
    return ReadPosedScene(request.scene, request.options, Silent());
  }
  static void ExpectSamePoses(const Scene& made, const PosedScene& posed, const ImageOptions& image) {
    ASSERT_EQ(made.views.size(), posed.split.train.size() + posed.split.test.size());
    for (size_t i = 0; i < made.views.size(); ++i) {
      const Camera want = WorkingCamera(posed.scene.views[i], image),
                   got = WorkingCamera(made.views[i], ImageOptions());
      EXPECT_TRUE(got.cam_from_world.isApprox(want.cam_from_world, 1e-9)) << made.views[i].name;
      EXPECT_EQ(got.width, want.width);
      EXPECT_EQ(got.height, want.height);
      EXPECT_DOUBLE_EQ(got.fx, want.fx);
      EXPECT_DOUBLE_EQ(got.cy, want.cy);
    }
  }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
};

TEST_F(CamerasTest, ReadBackAsColmapModelAndAsTransforms) {
  const PosedScene posed = Read(2);
  const ImageOptions image = request.options.image.Settled();
  std::vector<ScenePoint> points;
  points.push_back({Eigen::Vector3d(0.125, 0.25, -0.5), {1, 2, 3}, {0, 1, 3}});
  const fs::path out = temp / "made/";
  const CameraDatasetResult made = WriteCameraDataset({posed.scene, posed.split, image, points}, out, Silent());
  EXPECT_EQ(made.images, 6);
  const Scene colmap = ReadScene(out, {}, Silent());
  EXPECT_EQ(colmap.format, SceneFormat::kColmap);
  ExpectSamePoses(colmap, posed, image);
  ASSERT_EQ(colmap.points.size(), 1u);
  EXPECT_EQ(colmap.points[0].xyz, points[0].xyz);
  EXPECT_EQ(colmap.points[0].views, points[0].views);
  ExpectSamePoses(ReadTransformsScene(out, {}, Silent()), posed, image);
  const Image8 first = ReadImage(out / "images" / colmap.views[0].name);
  EXPECT_EQ(first.width, 24);
  EXPECT_EQ(first.height, 18);
}

TEST_F(CamerasTest, WriteSharedIntrinsicsSplitAndPointsForNerfstudio) {
  const PosedScene posed = Read();
  std::vector<ScenePoint> points{{Eigen::Vector3d::Zero(), {1, 2, 3}, {0, 1}}};
  WriteCameraDataset({posed.scene, posed.split, {}, points}, temp / "made", Silent());
  const auto json = nlohmann::json::parse(ReadFile(temp / "made" / "transforms.json"));
  EXPECT_EQ(json.at("w"), 48);
  EXPECT_FALSE(json.at("frames")[0].contains("fl_x"));
  EXPECT_EQ(json.at("ply_file_path"), "sparse_pc.ply");
  EXPECT_EQ(json.at("train_filenames").size(), posed.split.train.size());
  EXPECT_EQ(json.at("val_filenames"), json.at("test_filenames"));
  EXPECT_THAT(ReadFile(temp / "made" / "sparse_pc.ply"), HasSubstr("element vertex 1\n"));
  const auto split = nlohmann::json::parse(ReadFile(temp / "made" / "split.json"));
  EXPECT_EQ(split.at("test").size(), posed.split.test.size());
}

TEST_F(CamerasTest, KeepMasks) {
  PosedScene posed = Read();
  SceneView& view = posed.scene.views[0];
  Image8 mask{48, 36, 1, std::vector<uint8_t>(48 * 36, 255)};
  mask.data[0] = 0;
  WritePng(temp / "mask.png", mask);
  view.mask_path = temp / "mask.png";
  WriteCameraDataset({posed.scene, posed.split, {}, {}}, temp / "made", Silent());
  const Scene made = ReadScene(temp / "made", {}, Silent());
  ASSERT_FALSE(made.views[0].mask_path.empty());
  EXPECT_EQ(LoadViews(made, {0}, {}, Silent())[0].mask, LoadViews(posed.scene, {0}, {}, Silent())[0].mask);
  EXPECT_TRUE(made.views[1].mask_path.empty());
}

TEST_F(CamerasTest, RefuseFoldersThatHoldSomethingAndTheScene) {
  const PosedScene posed = Read();
  const CameraDataset dataset{posed.scene, posed.split, {}, {}};
  WriteText(temp / "full" / "note.txt", "mine");
  EXPECT_THAT(MessageOf<InputError>([&] { WriteCameraDataset(dataset, temp / "full", Silent()); }),
              HasSubstr("full: is not an empty folder; choose a new one with -o"));
  EXPECT_THAT(MessageOf<InputError>([&] { WriteCameraDataset(dataset, request.scene / "made", Silent()); }),
              HasSubstr("never written to"));
}

TEST_F(CamerasTest, LeaveNothingWhenInterrupted) {
  const PosedScene posed = Read();
  const Listener stop = [](const Event&) { RequestInterrupt(true); };
  EXPECT_THROW(WriteCameraDataset({posed.scene, posed.split, {}, {}}, temp / "made", stop), Interrupted);
  EXPECT_FALSE(fs::exists(temp / "made"));
  for (const auto& entry : fs::directory_iterator(temp.path())) EXPECT_NE(entry.path().extension(), ".tmp");
}

TEST_F(CamerasTest, OfARunWithoutPointsAreAWarning) {
  EventRecorder recorder;
  Reconstruct(request, Silent());
  oraclegs::Run run = OpenRun(request, recorder.AsListener());
  EXPECT_TRUE(SparsePointsOf(&run).empty());
  EXPECT_THAT(recorder.warnings, testing::Contains(HasSubstr("without points")));
}

}  // namespace
}  // namespace oraclegs

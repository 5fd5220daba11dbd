#include "oraclegs/stages/vggt_registration.h"

#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/stages/metrics.h"
#include "run/weights.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A folder of photos without poses, one of them upright.
class VggtPosesTest : public testing::Test {
 protected:
  void SetUp() override { SKIP_WITHOUT_NETWORKS(); }
  VggtPosesTest() {
    MakeTinyScene(temp / "posed", 5);
    fs::create_directories(temp / "photos");
    for (const auto& entry : fs::directory_iterator(temp / "posed" / "images")) {
      fs::copy(entry.path(), temp / "photos" / entry.path().filename());
    }
    Image8 upright{36, 48, 3, {}};
    for (int i = 0; i < 36 * 48; ++i) upright.data.insert(upright.data.end(), {static_cast<uint8_t>(i), 90, 20});
    WritePng(temp / "photos" / "upright.png", upright);
    photos = ReadScene(temp / "photos", {}, Silent());
    weights = *FindVggtWeights(WriteTinyVggt(temp / "tiny.safetensors"));
  }

  TempDir temp;
  Scene photos;
  VggtWeights weights;
  EventRecorder recorder;
};

TEST_F(VggtPosesTest, EveryImageGetsACameraInItsOwnPixels) {
  const Scene scene = RegisterWithVggt(photos, weights, temp / "sfm", recorder.AsListener());
  EXPECT_EQ(scene.format, SceneFormat::kColmap);
  ASSERT_EQ(scene.views.size(), 6u);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const SceneView& view = scene.views[v];
    EXPECT_EQ(view.name, photos.views[v].name);
    EXPECT_EQ(view.image_path, photos.views[v].image_path);
    EXPECT_EQ(view.intrinsics.width, photos.views[v].intrinsics.width);
    EXPECT_EQ(view.intrinsics.height, photos.views[v].intrinsics.height);
    EXPECT_EQ(view.intrinsics.model, CameraModel::kPinhole);
    EXPECT_GT(view.intrinsics.fx(), 0);
    EXPECT_NEAR(view.intrinsics.cx(), view.intrinsics.width / 2.0, 0.5);
    ASSERT_TRUE(view.cam_from_world.has_value());
  }
  for (const ScenePoint& point : scene.points) EXPECT_GE(point.views.size(), 2u);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("registered 6 of 6 photos with VGGT-1B")));
  EXPECT_THAT(recorder.notes, Contains(AllOf(HasSubstr("6 photos of 70 x 70"), HasSubstr("GiB"))));
  EXPECT_TRUE(fs::exists(temp / "sfm" / "sparse" / "0" / "points3D.txt"));
}

TEST_F(VggtPosesTest, AFinishedModelIsReadAgain) {
  const Scene first = RegisterWithVggt(photos, weights, temp / "sfm", Silent());
  fs::remove(weights.path);  // nobody needs them for that
  const Scene again = RegisterWithVggt(photos, weights, temp / "sfm", Silent());
  ASSERT_EQ(again.points.size(), first.points.size());
  for (size_t v = 0; v < first.views.size(); ++v) {
    EXPECT_EQ(again.views[v].intrinsics.params, first.views[v].intrinsics.params);
    EXPECT_EQ(again.views[v].cam_from_world->matrix(), first.views[v].cam_from_world->matrix());
  }
  VggtWeights other = weights;
  other.fingerprint = "another";
  EXPECT_THROW(RegisterWithVggt(photos, other, temp / "sfm", Silent()), InputError);
}

TEST_F(VggtPosesTest, MaskedPixelsGiveNoPoints) {
  const size_t before = RegisterWithVggt(photos, weights, temp / "sfm", Silent()).points.size();
  for (const SceneView& view : photos.views) {
    WritePng(temp / "masks" / view.name,
             {view.intrinsics.width, view.intrinsics.height, 1,
              std::vector<uint8_t>(static_cast<size_t>(view.intrinsics.width) * view.intrinsics.height, 0)});
  }
  Scene masked = photos;
  for (SceneView& view : masked.views) view.mask_path = temp / "masks" / view.name;
  const Scene scene = RegisterWithVggt(masked, weights, temp / "sfm", recorder.AsListener());
  EXPECT_TRUE(scene.points.empty()) << before;
  EXPECT_THAT(recorder.warnings, ElementsAre(AllOf(HasSubstr("agree on 0 points only"), HasSubstr("--poses colmap"))));
}

TEST_F(VggtPosesTest, WhatCannotBeIsRefused) {
  Scene alone = photos;
  alone.views.resize(1);
  EXPECT_THAT(MessageOf<InputError>([&] { RegisterWithVggt(alone, weights, temp / "sfm", Silent()); }),
              AllOf(HasSubstr("has one photo"), HasSubstr("at least two")));
  WriteTinyVggt(weights.path, [](TinyVggtParts* parts) { parts->tensors.erase("depth_head.norm.weight"); });
  EXPECT_THAT(MessageOf<InputError>([&] { RegisterWithVggt(photos, weights, temp / "sfm", Silent()); }),
              HasSubstr("missing 1: depth_head.norm.weight"));
}

TEST_F(VggtPosesTest, ARunWithoutPosesGoesThroughAndSaysWhoseItIs) {
  const ModelsAt models(temp / "models");
  fs::remove(temp / "photos" / "upright.png");
  RunRequest request = TinyRequest(temp / "photos", temp / "out");
  request.options.input.poses = PoseSource::kVggt;
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              AllOf(HasSubstr("--poses vggt needs the weights"), HasSubstr("models fetch vggt")));
  EXPECT_FALSE(fs::exists(temp / "out"));
  request.options.weights.vggt_weights = weights.path;
  const nlohmann::json metrics = Reconstruct(request, recorder.AsListener());
  EXPECT_EQ(metrics.at("non_commercial"), nlohmann::json({"VGGT-1B"}));
  EXPECT_THAT(
      ReadGaussianPly(temp / "out" / "point_cloud.ply").comments,
      ElementsAre("up is -y, the origin is what the cameras look at", "not for commercial use: made with VGGT-1B"));
  const nlohmann::json stages = nlohmann::json::parse(ReadFile(temp / "out" / "stages.json"));
  EXPECT_EQ(stages.at("register").at("registered"), 5);
  EXPECT_EQ(Reconstruct(request, Silent()), metrics);  // nothing has changed
  fs::remove(weights.path);
  EXPECT_EQ(OpenRun(request, Silent()).scene.views.size(), 5u);  // poses that are found stand without them
}

TEST_F(VggtPosesTest, AnImportedRunGoesThroughAndIsOpenedInItsFrame) {
  RunRequest request = TinyRequest({}, temp / "out");
  for (const auto& entry : fs::directory_iterator(temp / "photos")) {
    if (entry.path().filename() != "upright.png") request.inputs.push_back(entry.path());
  }
  std::sort(request.inputs.begin(), request.inputs.end());
  request.options.input.poses = PoseSource::kVggt;
  request.options.weights.vggt_weights = weights.path;
  request.options.train.iterations = {};
  request.options.train.horizon = 20;  // few, settled after the import
  const nlohmann::json metrics = Reconstruct(request, recorder.AsListener());
  EXPECT_EQ(metrics.at("train").at("iterations"), 20);
  const SavedRun saved = ReadSavedRun(temp / "out");
  EXPECT_EQ(saved.size.at("iterations"), 20);
  EXPECT_EQ(saved.inputs.size(), request.inputs.size());
  EXPECT_EQ(Reconstruct(request, Silent()), metrics) << "nothing has changed";

  const std::string points = ReadFile(temp / "out" / "point_cloud.ply");
  {
    oraclegs::Run opened = OpenRun(request, Silent());
    EvaluateRun(&opened);
  }
  EXPECT_EQ(ReadMetrics(temp / "out").at("test"), metrics.at("test")) << "of the same frame";
  EXPECT_EQ(ReadFile(temp / "out" / "point_cloud.ply"), points);
  const Eigen::Matrix3d rotation = OpenRun(request, Silent()).frame.rotation;
  WriteText(WorkspacePaths(temp / "out").frame(), "{ damaged");
  EXPECT_EQ(OpenRun(request, Silent()).frame.rotation, rotation) << "it is found again";

  request.options.capture.frames = 7;
  EXPECT_EQ(Reconstruct(request, Silent()), metrics) << "there is no video";

  // A length that becomes known afterwards trains nothing anew.
  const std::string train = ReadFile(temp / "out" / "train.csv");
  request.options.frame.scale = "000,001=0.5";
  const nlohmann::json measured = Reconstruct(request, Silent());
  EXPECT_TRUE(measured.at("frame").at("unit_meters").is_number());
  EXPECT_EQ(ReadFile(temp / "out" / "train.csv"), train);
  EXPECT_EQ(UnitMetersOf(ReadGaussianPly(temp / "out" / "point_cloud.ply").comments),
            measured.at("frame").at("unit_meters").get<double>());
}

TEST_F(VggtPosesTest, PosesThatAreThereAreKept) {
  RunRequest request = TinyRequest(temp / "posed", temp / "out2");
  request.options.input.poses = PoseSource::kVggt;
  StartRun(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("--poses vggt: the scene has poses, which are used")));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/pipeline/stages/vggt_registration.h"

#include "networks/vggt_fixture.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/reconstruct.h"
#include "pipeline/weights.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A folder of photographs without poses, one of them upright.
class VggtPosesTest : public testing::Test {
 protected:
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
  Recorder recorder;
};

TEST_F(VggtPosesTest, EveryPhotographGetsACameraInItsOwnPixels) {
  const Scene scene = RegisterWithVggt(photos, weights, temp / "sfm", recorder.AsListener());
  EXPECT_EQ(scene.format, SceneFormat::kColmap);
  ASSERT_EQ(scene.views.size(), 6u);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const SceneView& view = scene.views[v];
    EXPECT_EQ(view.name, photos.views[v].name);
    EXPECT_EQ(view.image_path, photos.views[v].image_path);
    EXPECT_EQ(view.lens.width, photos.views[v].lens.width);
    EXPECT_EQ(view.lens.height, photos.views[v].lens.height);
    EXPECT_EQ(view.lens.model, CameraModel::kPinhole);
    EXPECT_GT(view.lens.fx(), 0);
    EXPECT_NEAR(view.lens.cx(), view.lens.width / 2.0, 0.5);
    ASSERT_TRUE(view.cam_from_world.has_value());
  }
  for (const ScenePoint& point : scene.points) EXPECT_GE(point.views.size(), 2u);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("registered 6 of 6 photographs with VGGT-1B")));
  EXPECT_THAT(recorder.notes, Contains(AllOf(HasSubstr("6 photographs of 70 x 70"), HasSubstr("GiB"))));
  EXPECT_TRUE(fs::exists(temp / "sfm" / "sparse" / "0" / "points3D.txt"));
}

TEST_F(VggtPosesTest, AFinishedModelIsReadAgain) {
  const Scene first = RegisterWithVggt(photos, weights, temp / "sfm", Silent());
  fs::remove(weights.path);  // nobody needs them for that
  const Scene again = RegisterWithVggt(photos, weights, temp / "sfm", Silent());
  ASSERT_EQ(again.points.size(), first.points.size());
  for (size_t v = 0; v < first.views.size(); ++v) {
    EXPECT_EQ(again.views[v].lens.params, first.views[v].lens.params);
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
             {view.lens.width, view.lens.height, 1,
              std::vector<uint8_t>(static_cast<size_t>(view.lens.width) * view.lens.height, 0)});
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
              AllOf(HasSubstr("has one photograph"), HasSubstr("at least two")));
  WriteTinyVggt(weights.path, [](TinyVggtParts* parts) { parts->tensors.erase("depth_head.norm.weight"); });
  EXPECT_THAT(MessageOf<InputError>([&] { RegisterWithVggt(photos, weights, temp / "sfm", Silent()); }),
              HasSubstr("missing 1: depth_head.norm.weight"));
  EXPECT_THAT(MessageOf<RunError>([&] { RequirePoseMemory(40, int64_t{3} << 30, uint64_t{2} << 30); }),
              AllOf(HasSubstr("3.0 GiB of memory to look at 40 photographs"), HasSubstr("2.0 GiB are free"),
                    HasSubstr("--poses colmap")));
  EXPECT_NO_THROW(RequirePoseMemory(40, 5, 0));
}

TEST_F(VggtPosesTest, ARunWithoutPosesGoesThroughAndSaysWhoseItIs) {
  const ModelsAt models(temp / "models");
  fs::remove(temp / "photos" / "upright.png");
  RunRequest request = TinyRequest(temp / "photos", temp / "out");
  request.options.input.poses = "vggt";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              AllOf(HasSubstr("--poses vggt needs the weights"), HasSubstr("models fetch vggt")));
  EXPECT_FALSE(fs::exists(temp / "out"));
  request.options.weights.vggt_weights = weights.path;
  const nlohmann::json metrics = Reconstruct(request, recorder.AsListener());
  EXPECT_EQ(metrics.at("non_commercial"), nlohmann::json({"VGGT-1B"}));
  EXPECT_THAT(ReadGaussianPly(temp / "out" / "point_cloud.ply").comments,
              ElementsAre("not for commercial use: made with VGGT-1B"));
  const nlohmann::json stages = nlohmann::json::parse(ReadFile(temp / "out" / "stages.json"));
  EXPECT_EQ(stages.at("register").at("registered"), 5);
  EXPECT_EQ(Reconstruct(request, Silent()), metrics);  // nothing has changed
  fs::remove(weights.path);
  EXPECT_EQ(OpenRun(request, Silent()).scene.views.size(), 5u);  // poses that are found stand without them
}

TEST_F(VggtPosesTest, PosesThatAreThereAreKept) {
  RunRequest request = TinyRequest(temp / "posed", temp / "out2");
  request.options.input.poses = "vggt";
  StartRun(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("--poses vggt: the scene has poses, which are used")));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/output/render_path.h"

#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "run/fake_program.h"
#include "run/trained.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using RenderPathTest = TrainedTest;

TEST_F(RenderPathTest, RendersItsPaths) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  RenderPathOptions path;
  path.video = false;
  path.frames = 3;
  const auto orbit = PathCameras(posed, request->options.image.Settled(), path);
  ASSERT_EQ(orbit.size(), 3u);
  EXPECT_EQ(orbit[2].name, "0002");
  path.path = PathKind::kTest;
  const auto test = PathCameras(posed, request->options.image.Settled(), path);
  EXPECT_EQ(test.size(), posed.split.test.size());
  path.path = PathKind::kTrain;
  EXPECT_EQ(PathCameras(posed, request->options.image.Settled(), path).size(), posed.split.train.size());

  const Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu, posed.frame);
  RenderCameras(model, orbit, *temp / "pictures", path, Silent());
  const Image8 picture = ReadImage(*temp / "pictures" / "0000.png");
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 36);
}

TEST_F(RenderPathTest, WritesEachValueIntoItsFolder) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu, posed.frame);
  RenderPathOptions path;
  path.video = false, path.frames = 2, path.path = PathKind::kInterpolate, path.what = "normals,color,depth";

  const auto cameras = PathCameras(posed, request->options.image.Settled(), path);
  ASSERT_EQ(cameras.size(), 2u);
  RenderCameras(model, cameras, *temp / "values", path, Silent());
  for (const char* file : {"0000.png", "normals/0001.png", "depth/0001.png"}) {
    EXPECT_EQ(ReadImage(*temp / "values" / file).channels, 3) << file;
  }
  path.what = "support";
  model.marks.support.clear();
  EXPECT_THAT(MessageOf<InputError>([&] { RenderCameras(model, cameras, *temp / "values", path, Silent()); }),
              testing::HasSubstr("train again"));
  path.what = "colors";
  EXPECT_THAT(MessageOf<UsageError>([&] { RenderCameras(model, cameras, *temp / "values", path, Silent()); }),
              testing::HasSubstr("color, depth, normals, support, uncertainty"));
}

TEST_F(RenderPathTest, SpiralHasItsFrames) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  RenderPathOptions path;
  path.frames = 5, path.path = PathKind::kSpiral;
  EXPECT_EQ(PathCameras(posed, request->options.image.Settled(), path).size(), 5u);
}

TEST_F(RenderPathTest, KeepsViewsOfOneStemApart) {
  PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const auto rename = [&](int view, const char* name) {
    posed.scene.views[static_cast<size_t>(posed.split.train[static_cast<size_t>(view)])].name = name;
  };
  rename(0, "1.jpg");
  rename(1, "1.png");
  RenderPathOptions path;
  path.path = PathKind::kTrain;
  const auto cameras = PathCameras(posed, request->options.image.Settled(), path);
  EXPECT_EQ(cameras[0].name, "1_jpg");
  EXPECT_EQ(cameras[1].name, "1_png");
}

TEST_F(RenderPathTest, WritesTheVideoIntoTheNamedFolderAlone) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  const Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu, posed.frame);
  RenderPathOptions path;
  path.frames = 2;
  const auto orbit = PathCameras(posed, request->options.image.Settled(), path);
  const std::filesystem::path out = *temp / "holiday";
  WriteText(*temp / "holiday.mp4", "the user's own");
  {
    const FakeProgram ffmpeg("ffmpeg", "for last; do :; done; echo film > \"$last\"");
    EXPECT_THAT(RenderCameras(model, orbit, out, path, Silent()), testing::ElementsAre(out / "video.mp4"));
  }
  EXPECT_EQ(ReadFile(out / "video.mp4"), "film\n");
  EXPECT_EQ(ReadFile(*temp / "holiday.mp4"), "the user's own");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out)) names.push_back(entry.path().filename());
  EXPECT_THAT(names, testing::UnorderedElementsAre("0000.png", "0001.png", "video.mp4"));
  const FakeProgram broken("ffmpeg", "exit 1");
  EXPECT_THAT(RenderCameras(model, orbit, *temp / "broken", path, recorder.AsListener()), testing::IsEmpty());
  EXPECT_THAT(recorder.warnings, testing::Contains(testing::HasSubstr("ffmpeg failed")));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/pipeline/render_path.h"

#include <cstdlib>

#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "pipeline/trained.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using RenderPathTest = TrainedTest;

TEST_F(RenderPathTest, RendersItsPaths) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  RenderPathOptions path;
  path.video = false;
  path.frames = 3;
  const auto orbit = PathCameras(posed, request->options.image, path);
  ASSERT_EQ(orbit.size(), 3u);
  EXPECT_EQ(orbit[2].name, "0002");
  path.path = PathKind::kTest;
  const auto test = PathCameras(posed, request->options.image, path);
  EXPECT_EQ(test.size(), posed.split.test.size());
  path.path = PathKind::kTrain;
  EXPECT_EQ(PathCameras(posed, request->options.image, path).size(), posed.split.train.size());

  const Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu);
  RenderCameras(model, orbit, *temp / "pictures", path, Silent());
  const Image8 picture = ReadImage(*temp / "pictures" / "0000.png");
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 36);
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
  const auto cameras = PathCameras(posed, request->options.image, path);
  EXPECT_EQ(cameras[0].name, "1_jpg");
  EXPECT_EQ(cameras[1].name, "1_png");
}

/// A program of this name that is found first while the scope lasts.
class FakeProgram {
 public:
  FakeProgram(const std::string& name, const std::string& body) : old_path_(std::getenv("PATH")) {
    WriteText(dir_ / name, "#!/bin/sh\n" + body + "\n");
    std::filesystem::permissions(dir_ / name, std::filesystem::perms::owner_all);
    setenv("PATH", (dir_.path().string() + ":" + old_path_).c_str(), 1);
  }
  ~FakeProgram() { setenv("PATH", old_path_.c_str(), 1); }
  FakeProgram(const FakeProgram&) = delete;
  FakeProgram& operator=(const FakeProgram&) = delete;

 private:
  TempDir dir_;
  std::string old_path_;
};

TEST_F(RenderPathTest, WritesTheVideoIntoTheNamedFolderAlone) {
  const Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu);
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  RenderPathOptions path;
  path.frames = 2;
  const auto orbit = PathCameras(posed, request->options.image, path);
  const std::filesystem::path out = *temp / "holiday";
  WriteText(*temp / "holiday.mp4", "the user's own");
  {
    const FakeProgram ffmpeg("ffmpeg", "for last; do :; done; echo film > \"$last\"");
    EXPECT_EQ(RenderCameras(model, orbit, out, path, Silent()), out / "video.mp4");
  }
  EXPECT_EQ(ReadFile(out / "video.mp4"), "film\n");
  EXPECT_EQ(ReadFile(*temp / "holiday.mp4"), "the user's own");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out)) names.push_back(entry.path().filename());
  EXPECT_THAT(names, testing::UnorderedElementsAre("0000.png", "0001.png", "video.mp4"));
  const FakeProgram broken("ffmpeg", "exit 1");
  EXPECT_EQ(RenderCameras(model, orbit, *temp / "broken", path, recorder.AsListener()), "");
  EXPECT_THAT(recorder.warnings, testing::Contains(testing::HasSubstr("ffmpeg failed")));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/pipeline/render_path.h"

#include "oraclegs/scene/image.h"
#include "pipeline/trained.h"

namespace oraclegs {
namespace {

using RenderPathTest = TrainedTest;

TEST_F(RenderPathTest, RendersItsPaths) {
  const PosedScene posed = ReadPosedScene(request->scene, request->options, Silent());
  RenderPathOptions path;
  path.video = false;
  path.frames = 3;
  const auto orbit = PathCameras(posed.scene, posed.split, request->options.photo, path);
  ASSERT_EQ(orbit.size(), 3u);
  EXPECT_EQ(orbit[2].name, "0002");
  path.path = "test";
  const auto test = PathCameras(posed.scene, posed.split, request->options.photo, path);
  EXPECT_EQ(test.size(), posed.split.test.size());
  path.path = "train";
  EXPECT_EQ(PathCameras(posed.scene, posed.split, request->options.photo, path).size(), posed.split.train.size());

  const Model model = LoadModel(*temp / "out" / "point_cloud.ply", request->options);
  RenderCameras(model, orbit, *temp / "pictures", path, Silent());
  const Image8 picture = ReadImage(*temp / "pictures" / "0000.png");
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 36);
}

}  // namespace
}  // namespace oraclegs

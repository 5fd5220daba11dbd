#include "oraclegs/output/info.h"

#include "run/trained.h"

namespace oraclegs {
namespace {

using InfoTest = TrainedTest;

TEST_F(InfoTest, DescribesScenesWorkspacesAndModels) {
  EXPECT_EQ(Describe(request->scene, Silent()).at("views"), 6);
  EXPECT_EQ(Describe(request->scene, Silent()).at("kind"), "scene");
  const auto workspace = Describe(request->out, Silent());
  EXPECT_EQ(workspace.at("kind"), "workspace");
  EXPECT_EQ(workspace.at("metrics"), *metrics);
  const auto ply = Describe(request->out / "point_cloud.ply", Silent());
  EXPECT_EQ(ply.at("kind"), "gaussians");
  EXPECT_EQ(ply.at("gaussians"), metrics->at("gaussians"));
  EXPECT_EQ(ply.at("sh_degree"), 3);
  EXPECT_EQ(Describe(request->scene / "images", Silent()).at("sizes"), nlohmann::json({{"48x36", 6}}))
      << "of plain photos";
  EXPECT_THROW(Describe(*temp / "nowhere", Silent()), InputError);
}

}  // namespace
}  // namespace oraclegs

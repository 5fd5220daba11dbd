#include "oraclegs/output/info.h"

#include "run/trained.h"

namespace oraclegs {
namespace {

using InfoTest = TrainedTest;

TEST_F(InfoTest, DescribesScenesWorkspacesAndModels) {
  EXPECT_EQ(Describe(request->scene, false, Silent()).at("views"), 6);
  EXPECT_EQ(Describe(request->scene, false, Silent()).at("kind"), "scene");
  const auto workspace = Describe(request->out, false, Silent());
  EXPECT_EQ(workspace.at("kind"), "workspace");
  EXPECT_EQ(workspace.at("metrics"), *metrics);
  const auto ply = Describe(request->out / "point_cloud.ply", false, Silent());
  EXPECT_EQ(ply.at("kind"), "gaussians");
  EXPECT_EQ(ply.at("gaussians"), metrics->at("gaussians"));
  EXPECT_EQ(ply.at("sh_degree"), 3);
  EXPECT_EQ(Describe(request->scene / "images", false, Silent()).at("sizes"), nlohmann::json({{"48x36", 6}}))
      << "of plain photos";
  EXPECT_THROW(Describe(*temp / "nowhere", false, Silent()), InputError);
}

TEST_F(InfoTest, LooksAtPhotosWhereItIsAsked) {
  const TempDir dir;
  const std::filesystem::path photo = std::filesystem::directory_iterator(request->scene / "images")->path();
  for (const char* name : {"a.png", "b.png", "c.png"}) std::filesystem::copy_file(photo, dir / name);
  EXPECT_FALSE(Describe(dir.path(), false, Silent()).contains("warnings"));
  const nlohmann::json warnings = Describe(dir.path(), true, Silent()).at("warnings");
  ASSERT_FALSE(warnings.empty()) << "one photo three times";
  EXPECT_THAT(warnings[0].get<std::string>(), testing::HasSubstr("a.png"));
}

}  // namespace
}  // namespace oraclegs

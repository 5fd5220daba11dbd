#include "oraclegs/output/report/report_views.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

using nlohmann::json;

TEST(CameraToJson, IsTheMatrixRowByRow) {
  Camera camera;
  camera.width = 8, camera.height = 6, camera.fx = 7, camera.fy = 5;
  camera.cam_from_world.translation() = Eigen::Vector3d(1, 2, 3);
  const json camera_json = CameraToJson(camera);
  EXPECT_EQ(camera_json["fy"], 5);
  EXPECT_EQ(camera_json["world_to_camera"], json::parse("[1,0,0,1, 0,1,0,2, 0,0,1,3, 0,0,0,1]"));
}

class ReportViewsTest : public TrainedTest {
 protected:
  /// A proposal at the pose of the first training view, trusted in its left half.
  void GiveProposal(const oraclegs::Run& run, const Camera& camera) {
    const Image8 image{camera.width, camera.height, 3,
                       std::vector<uint8_t>(static_cast<size_t>(camera.width * camera.height * 3), 100)};
    Image8 confidence{camera.width, camera.height, 1, {}};
    for (int p = 0; p < camera.width * camera.height; ++p) {
      confidence.data.push_back(p % camera.width < camera.width / 2 ? 255 : 0);
    }
    WriteTargets(run.workspace.confidence(), {{"given", camera}, {"without_image", camera}},
                 RunFromScene(run.frame).Inverse());
    WritePng(run.workspace.proposals() / "given.png", image);
    WritePng(run.workspace.confidence() / "given.png", confidence);
  }
};

TEST_F(ReportViewsTest, ShowsProposalsWithConfidenceAndTheirNearestView) {
  RunRequest other = *request;
  other.out = *temp / "with_proposal";
  const oraclegs::Run run = StartRun(other, Silent());
  const auto training = LoadViews(run.scene, run.split.train, run.plan.image, Silent());
  GiveProposal(run, training[2].camera);
  const Model model = LoadModel(*temp / "out/point_cloud.ply", request->options, kCpu, run.frame);
  const ReportFiles files(other.out);
  ReportViews views(run, files, &model);
  for (const LoadedView& view : training) views.AddTraining(view);
  views.AddProposals();
  const json rows = views.Rows();
  ASSERT_EQ(rows.size(), training.size() + 1);
  const json& row = rows.back();
  EXPECT_EQ(row["name"], "given");
  EXPECT_EQ(row["role"], "proposal");
  EXPECT_EQ(row["nearest"], 2);
  EXPECT_NEAR(row["mean_confidence"].get<double>(), 0.5, 1e-6);
  for (const char* part : {"image", "thumbnail", "confidence", "render"}) {
    EXPECT_TRUE(std::filesystem::exists(other.out / row[part]["url"].get<std::string>())) << part;
  }
}

TEST(Evenly, KeepsAtMostSoMany) {
  EXPECT_EQ(Evenly(std::vector<int>{0, 1, 2, 3, 4, 5}, 3), (std::vector<int>{0, 2, 4}));
  EXPECT_EQ(Evenly(std::vector<int>{7}, 3), std::vector<int>{7});
}

/// Turned around, so that it sees nothing that the photos show.
Eigen::Isometry3d TurnedAround(const Eigen::Isometry3d& cam_from_world) {
  return Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()) * cam_from_world;
}

TEST_F(ReportViewsTest, AdvisesWhereTheModelIsLeastSure) {
  RunRequest other = *request;
  other.out = *temp / "with_advice";
  const oraclegs::Run run = StartRun(other, Silent());
  const auto training = LoadViews(run.scene, run.split.train, run.plan.image, Silent());
  const Model model = LoadModel(*temp / "out/point_cloud.ply", request->options, kCpu, run.frame);
  const ReportFiles files(other.out);
  Camera camera = training[0].camera;
  camera.cam_from_world = TurnedAround(camera.cam_from_world);
  GiveProposal(run, camera);
  ReportViews open(run, files, &model);
  for (const LoadedView& view : training) open.AddTraining(view);
  open.AddProposals();
  const json advice = open.Advice();
  ASSERT_EQ(advice.size(), 1u);
  EXPECT_THAT(advice[0]["text"].get<std::string>(), testing::StartsWith("Take a photo near " + training[0].name));
  EXPECT_EQ(open.Rows()[advice[0]["view"].get<size_t>()]["role"], "proposal") << "a picture of the place";

  GiveProposal(run, training[0].camera);
  ReportViews enough(run, files, &model);
  for (const LoadedView& view : training) enough.AddTraining(view);
  enough.AddProposals();
  ASSERT_EQ(enough.Advice().size(), 1u);
  EXPECT_THAT(enough.Advice()[0]["text"].get<std::string>(), testing::HasSubstr("You have enough photos"));
  EXPECT_TRUE(enough.Advice()[0]["view"].is_null());

  ReportViews unknown(run, files, nullptr);
  for (const LoadedView& view : training) unknown.AddTraining(view);
  unknown.AddProposals();
  EXPECT_TRUE(unknown.Advice().empty());
}

TEST_F(ReportViewsTest, AdvisesToUseASpareThatShowsMore) {
  RunRequest other = *request;
  other.out = *temp / "with_spare";
  oraclegs::Run run = StartRun(other, Silent());
  const auto training = LoadViews(run.scene, run.split.train, run.plan.image, Silent());
  const Model model = LoadModel(*temp / "out/point_cloud.ply", request->options, kCpu, run.frame);
  const ReportFiles files(other.out);
  ASSERT_FALSE(run.split.test.empty());
  SceneView& spare = run.scene.views[static_cast<size_t>(run.split.test[0])];
  spare.cam_from_world = TurnedAround(*spare.cam_from_world);
  run.split.test.clear();
  ReportViews views(run, files, &model);
  for (const LoadedView& view : training) views.AddTraining(view);
  views.AddSpares();
  const json advice = views.Advice();
  ASSERT_FALSE(advice.empty());
  EXPECT_THAT(advice[0]["text"].get<std::string>(), testing::StartsWith("Use " + spare.name + ", too"));
  const json row = views.Rows()[advice[0]["view"].get<size_t>()];
  EXPECT_EQ(row["role"], "spare");
  EXPECT_TRUE(std::filesystem::exists(other.out / row["render"]["url"].get<std::string>()));
}

}  // namespace
}  // namespace oraclegs

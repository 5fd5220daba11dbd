#include "oraclegs/experiments/ablation_suite.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "run/proposing.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

AblationRun SceneRun(uint64_t seed, double psnr) {
  AblationRun run;
  run.seed = seed, run.psnr = psnr, run.ssim = psnr / 100, run.training_seconds = 10 * psnr, run.gaussians = 100;
  return run;
}

Ablation OfScene(const std::string& scene, double psnr) {
  Ablation a;
  a.scene = scene, a.train_views = 12, a.iterations = 100, a.seeds = {0, 1};
  a.rows = {{1, "mcmc", "MCMC", "alone", {}, {SceneRun(0, psnr), SceneRun(1, psnr + 2)}},
            {2, "union", "+ all", "views", {}, {SceneRun(0, psnr + 1)}}};
  a.notes = {"Of " + scene, "Of both"};
  return a;
}

TEST(MeanOver, IsTheMeanOverScenesOfEachSeed) {
  Ablation second = OfScene("/data/lego", 30);
  second.rows[0].runs[0].lpips = 0.5;
  const Ablation mean = MeanOver({OfScene("/data/fox/", 20), second});
  EXPECT_THAT(mean.scenes, ElementsAre("fox", "lego"));
  EXPECT_THAT(mean.notes, ElementsAre("Of /data/fox/", "Of both", "Of /data/lego"));
  EXPECT_EQ(mean.train_views, 0u);
  ASSERT_EQ(mean.rows.size(), 2u);
  ASSERT_EQ(mean.rows[0].runs.size(), 2u);
  EXPECT_DOUBLE_EQ(*mean.rows[0].runs[0].psnr, 25);
  EXPECT_DOUBLE_EQ(*mean.rows[0].runs[1].psnr, 27);
  EXPECT_DOUBLE_EQ(*mean.rows[0].runs[1].ssim, 0.27);
  EXPECT_FALSE(mean.rows[0].runs[0].lpips) << "one scene has none";
  EXPECT_DOUBLE_EQ(mean.rows[0].runs[0].training_seconds, 250);
  EXPECT_DOUBLE_EQ(GainOf(mean, 1)->psnr.mean, 1);
  EXPECT_THAT(AblationText(mean), HasSubstr("mean over fox, lego: 100 iterations"));
}

TEST(MeanOver, StandsBesideThePaperOverAllOfItsScenesAlone) {
  std::vector<Ablation> scenes;
  for (const char* name : {"bicycle", "bonsai", "counter", "garden", "kitchen", "room", "stump"}) {
    scenes.push_back(OfScene(name, 20));
    scenes.back().published_views = 24;
  }
  const Ablation mean = MeanOver(scenes);
  EXPECT_EQ(mean.published_views, 24);
  EXPECT_THAT(AblationText(mean), AllOf(HasSubstr("paper"), HasSubstr("17.95 / 0.479 / 0.409"), HasSubstr("misprint")));
  EXPECT_THAT(AblationMarkdown(mean), HasSubstr("| 16.88 / 0.428 / 0.565 |"));
  scenes[3].published_views = 12;
  EXPECT_EQ(MeanOver(scenes).published_views, 0);
  scenes.pop_back();
  EXPECT_EQ(MeanOver(scenes).published_views, 0);
  EXPECT_THAT(AblationText(scenes[0]), testing::Not(HasSubstr("paper"))) << "one scene is no mean";
}

TEST(MeanOver, LeavesOutWhatOneSceneLacks) {
  Ablation second = OfScene("lego", 30);
  second.rows.pop_back();
  second.rows[0].runs[1].failure = "no points";
  const Ablation mean = MeanOver({OfScene("fox", 20), second});
  ASSERT_EQ(mean.rows.size(), 1u);
  EXPECT_EQ(mean.rows[0].runs[1].failure, "lego: no points");
}

class AblationSuiteTest : public ProposingTest {};

TEST_F(AblationSuiteTest, TrainsEachSceneInItsFolder) {
  const fs::path other = *temp / "other";
  fs::copy(*temp / "scene", other, fs::copy_options::recursive);
  AblationRequest request{Request("suite"), {1, "mcmc"}, "oraclegs ablate scene -o out"};
  request.run.options.train.iterations = 10;
  request.options.also = other.string();
  const Ablation mean = RunScenes(request, ScenesOf(request), Silent());
  const fs::path out = request.run.out;
  for (const char* scene : {"scene", "other"}) {
    EXPECT_TRUE(fs::exists(out / scene / "rows/01-mcmc/seed-0/metrics.json")) << scene;
  }
  const auto saved = nlohmann::json::parse(ReadFile(out / "ablation.json"));
  EXPECT_EQ(saved, AblationToJson(mean));
  EXPECT_EQ(saved.at("scenes"), nlohmann::json({"scene", "other"}));
  EXPECT_NEAR(saved.at("rows").at(0).at("psnr").at("mean").get<double>(),
              nlohmann::json::parse(ReadFile(out / "scene/ablation.json")).at("rows").at(0).at("psnr").at("mean"), 1e-9)
      << "the same scene twice";
  RunScenes(request, ScenesOf(request), Silent());  // finds all of it done

  request.options.also = (*temp / "deeper/scene").string();
  EXPECT_THAT(MessageOf<UsageError>([&] { ScenesOf(request); }), AllOf(HasSubstr("two scenes"), HasSubstr("'scene'")));
}

}  // namespace
}  // namespace oraclegs

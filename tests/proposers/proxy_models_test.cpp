#include "oraclegs/proposers/proxy_models.h"

#include "oraclegs/core/cuda_library.h"
#include "oraclegs/depth/confidence.h"
#include "run/proposing.h"
#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

using ProxyModelsTest = ProposingTest;

TEST_F(ProxyModelsTest, HoldOutEachViewOnceAndAreReadBack) {
  auto run = StartRun(Request(), Silent());
  const std::vector<ProxyModel> first = Bring(&run, "proxies").proxies;
  const AutoTrainOptions options = ProxyOptions(run.options.propose.proxy_share, run.options.train);
  EXPECT_EQ(options.iterations, 6);  // 0.2 of 30
  EXPECT_EQ(options.schedule, ScheduleKind::kNone);
  ASSERT_EQ(first.size(), 3u);
  EXPECT_FALSE(ProxiesAlonePropose(run)) << "beside warps";
  run.options.propose.proposers = std::string("proxies");
  EXPECT_TRUE(ProxiesAlonePropose(run));
  run.options.propose.proposers = std::string("proxies,warp");
  EXPECT_EQ(first[0].held_out, (std::vector<int>{0, 3, 6, 9}));
  EXPECT_EQ(first[1].held_out, (std::vector<int>{1, 4, 7, 10}));
  EXPECT_FALSE(Equal(first[0].gaussians.means, first[1].gaussians.means));
  EXPECT_FALSE(Equal(first[0].before.means, first[0].gaussians.means)) << "it went on with all views";
  int steps = 0;
  int64_t iterations = 0;
  run.listener = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (!step || step->stage != "proxies") return;
    ++steps, iterations = step->total;
  };
  run.results->keys.erase("proxies");
  const std::vector<ProxyModel> again = Bring(&run, "proxies").proxies;
  EXPECT_EQ(steps, 0);
  EXPECT_TRUE(Equal(again[1].gaussians.means, first[1].gaussians.means));
  EXPECT_TRUE(Equal(again[1].before.means, first[1].before.means));
  // Only what is lost is trained again, to the same bits.
  const auto kept = run.workspace.proposals() / "proxy_models" / "0.ply";
  const auto written = fs::last_write_time(kept);
  fs::remove(run.workspace.proposals() / "proxy_models" / "1_before.ply");
  run.results->keys.erase("proxies");
  const std::vector<ProxyModel> trained_again = Bring(&run, "proxies").proxies;
  EXPECT_GT(steps, 0);
  EXPECT_EQ(iterations, 3 * (6 + 12)) << "0.4 of 30 with all views";
  EXPECT_EQ(fs::last_write_time(kept), written);
  EXPECT_TRUE(Equal(trained_again[1].gaussians.means, first[1].gaussians.means));

  const auto cut = run.workspace.proposals() / "proxy_models" / "1.ply";
  fs::resize_file(cut, fs::file_size(cut) / 2);
  run.results->keys.erase("proxies");
  const std::vector<ProxyModel> mended = Bring(&run, "proxies").proxies;
  EXPECT_EQ(fs::last_write_time(kept), written);
  EXPECT_TRUE(Equal(mended[1].gaussians.means, first[1].gaussians.means));
}

TEST_F(ProxyModelsTest, AreAtFirstAsIfTheHeldOutViewsHadNeverAgreed) {
  auto run = StartRun(Request("with"), Silent()), other = StartRun(Request("without"), Silent());
  const ProxyModel with = Bring(&run, "proxies").proxies[0];
  Bring(&other, "depth");
  std::vector<DepthMap>& maps = other.results->geometry.maps;
  const std::vector<DepthMap> all = maps;
  bool has_changed = false;
  for (size_t v = 0; v < maps.size(); ++v) {
    if (std::find(with.held_out.begin(), with.held_out.end(), static_cast<int>(v)) != with.held_out.end()) {
      maps[v] = {all[v].name, all[v].camera, {}, {}, {}};
    } else {
      maps[v].confidence = ConfidenceWithout(all, v, with.held_out);
      has_changed |= maps[v].confidence != all[v].confidence;
    }
  }
  ASSERT_TRUE(has_changed);
  Bring(&other, "proxies");  // later models may have too little left to be trained
  const auto first = [](const auto& of) {
    return ReadFile(of.workspace.proposals() / "proxy_models" / "0_before.ply");
  };
  EXPECT_TRUE(first(run) == first(other));
}

TEST_F(ProxyModelsTest, WithoutAFinishAreWhatTheyWereBefore) {
  RunRequest request = Request("unfinished");
  request.options.propose.proxy_finish = 0;
  auto run = StartRun(request, Silent());
  const std::vector<ProxyModel>& proxies = Bring(&run, "proxies").proxies;
  ASSERT_EQ(proxies.size(), 3u);
  EXPECT_TRUE(Equal(proxies[0].before.means, proxies[0].gaussians.means));
}

TEST_F(ProxyModelsTest, AreTrainedOnTheDeviceOfTheRun) {
  if (HasCudaLibrary()) GTEST_SKIP() << "this build would train on a GPU";
  auto run = StartRun(Request("device"), Silent());
  Bring(&run, "depth");
  run.plan.device = {DeviceKind::kCuda, 0};
  EXPECT_THAT(MessageOf<UsageError>([&] { Bring(&run, "proxies"); }), HasSubstr("a GPU needs liboraclegs_cuda.so"));
}

TEST_F(ProxyModelsTest, SayWhyThereAreNone) {
  auto run = StartRun(Request("none"), recorder.AsListener());
  Bring(&run, "depth");
  for (DepthMap& map : run.results->geometry.maps) std::fill(map.confidence.begin(), map.confidence.end(), 0.f);
  EXPECT_THAT(Bring(&run, "proxies").proxies, IsEmpty());
  EXPECT_THAT(recorder.warnings,
              Contains(testing::AllOf(HasSubstr("one would have 8 views and 0 dense points, and needs 2 and 1000"),
                                      HasSubstr("views are warped instead"))));
  EXPECT_TRUE(run.workspace.Record("proxies").is_null());
  run.options.propose.proposers = std::string("proxies");
  EXPECT_FALSE(ProxiesAlonePropose(run)) << "views are warped";
}

TEST(ProxyCount, LeavesEachModelThreeViews) {
  const ProposeOptions two;
  EXPECT_EQ(ProxyCount(two, 12), 2);
  EXPECT_EQ(ProxyCount(two, 6), 2);
  EXPECT_EQ(ProxyCount(two, 5), 3);
  EXPECT_EQ(ProxyCount(two, 4), 4);
  EXPECT_EQ(ProxyCount(two, 3), 3) << "two views each";
  ProposeOptions many;
  many.proxy_models = 16;
  EXPECT_EQ(ProxyCount(many, 7), 7);
}

TEST_F(ProxyModelsTest, DependOnTheHorizonThatTheirRatesFollow) {
  auto run = StartRun(Request(), Silent());
  const auto key_of = [&](int horizon) {
    run.options.train.horizon = horizon;
    Fingerprint key;
    ProxyStage().own(&run, &key);
    return key.Hex();
  };
  EXPECT_NE(key_of(0), key_of(30000));
}

TEST_F(ProxyModelsTest, DoNotDependOnHowProposalsAreTrainedOn) {
  const AutoTrainOptions options = Request().options.train;
  AutoTrainOptions other = options;
  other.synthetic_floor = 0.7, other.proposal_ssim = 0.1, other.confidence_power = 0.5;
  EXPECT_EQ(OptionsToJson(ProxyOptions(0.2, other)), OptionsToJson(ProxyOptions(0.2, options)));
}

TEST(ProxyOptions, KeepTheRatesOfTheRunAndFinishAtTheirOwn) {
  RunOptions asked;
  asked.train.iterations = 3000;
  const TrainOptions run = SettleTraining(asked.train, {}, Silent());
  EXPECT_EQ(ProxyOptions(0.2, run).rate_scale, run.rate_scale);
  const TrainOptions finish = FinishOptions(asked, {});
  EXPECT_EQ(finish.iterations, 1200);
  EXPECT_EQ(finish.rate_scale, 5);
  EXPECT_EQ(finish.sh_degree_interval, 240);
  EXPECT_NEAR(run.rate_scale, std::sqrt(10), 1e-9);
  EXPECT_EQ(FinishOptions(asked, {.is_object = true}).iterations, 1800);
  asked.train.rate_scale = 2;
  EXPECT_EQ(FinishOptions(asked, {}).rate_scale, 2);
  asked.propose.proxy_finish = 0;
  EXPECT_EQ(FinishOptions(asked, {}).iterations, 0);
}

}  // namespace
}  // namespace oraclegs

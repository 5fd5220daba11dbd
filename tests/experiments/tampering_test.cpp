#include "oraclegs/experiments/tampering.h"

#include "oraclegs/core/interrupt.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/proposing.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class TamperingTest : public ProposingTest {
 protected:
  static AblationRequest Ask(const std::string& out, const std::string& shares) {
    AblationRequest request{Request(out), {1, "", Comparison::kTampering, shares}, "oraclegs ablate scene -o out"};
    request.run.options.train.iterations = 60;
    request.run.options.propose.proposers = std::string("proxies"), request.run.options.propose.proxy_models = 2;
    return request;
  }
};

TEST_F(TamperingTest, TrainsAllTrustsAndGoesOnWhereItWasStopped) {
  const AblationRequest request = Ask("whole", "0,15,100");
  const fs::path out = request.run.out, runs = out / "runs/seed-0";
  const Listener stop = [](const Event& event) {
    const auto* note = std::get_if<Note>(&event);
    if (note && note->text.rfind("share-15-uniform", 0) == 0) RequestInterrupt(true);
  };
  EXPECT_THROW(RunTampering(request, stop), Interrupted);
  RequestInterrupt(false);
  EXPECT_FALSE(fs::exists(runs / "share-15-oracle"));
  const auto written = fs::last_write_time(runs / "share-15-uniform/point_cloud.ply");
  const auto drawn = fs::last_write_time(out / "tampered/seed-0/share-15/tampering.json");

  const TamperingReport report = RunTampering(request, recorder.AsListener());
  EXPECT_EQ(fs::last_write_time(runs / "share-15-uniform/point_cloud.ply"), written);
  EXPECT_EQ(fs::last_write_time(out / "tampered/seed-0/share-15/tampering.json"), drawn);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("share-15-oracle, seed 0: ")));
  ASSERT_EQ(report.shares.size(), 3u);
  for (const TamperingShare& share : report.shares) EXPECT_EQ(share.runs.size(), 3u) << share.percent;
  EXPECT_EQ(TamperingPsnr(report, 0, TamperingTrust::kIdeal)->mean,
            TamperingPsnr(report, 0, TamperingTrust::kUniform)->mean);
  EXPECT_EQ(TamperingPsnr(report, 2, TamperingTrust::kIdeal)->mean,
            TamperingPsnr(report, 2, TamperingTrust::kNone)->mean);
  EXPECT_EQ(report.none[0].psnr, ReadMetrics(runs / "none").at("test").at("psnr"));
  EXPECT_EQ(report.train_views, 12u);
  EXPECT_GT(report.proposals, 3u);

  const TamperedConfidence& some = report.shares[1].confidence[0];
  EXPECT_GE(some.tampered, 0.15);
  EXPECT_TRUE(some.auroc && some.on_tampered && some.on_honest);
  EXPECT_FALSE(report.shares[0].confidence[0].on_tampered);
  EXPECT_FALSE(report.shares[2].confidence[0].on_honest);

  const auto saved = [&](const char* name) { return ReadSavedRun(runs / name).options; };
  EXPECT_EQ(saved("models").at("proposals"), 96) << "also where a run would do without";
  EXPECT_EQ(saved("none").at("proposal-folder"), "");
  EXPECT_EQ(saved("share-15-uniform").at("oracle"), "uniform");
  EXPECT_EQ(saved("share-15-oracle").at("oracle"), "consistency");
  EXPECT_THAT(saved("share-15-ideal").at("proposal-folder").get<std::string>(), HasSubstr("share-15/ideal"));
  for (const char* name : {"none", "share-15-oracle"}) {
    EXPECT_EQ(saved(name).at("proposers"), "none");
    EXPECT_EQ(ReadStageRecords(runs / name).at("depth"), ReadStageRecords(runs / "models").at("depth"));
  }
  EXPECT_EQ(nlohmann::json::parse(ReadFile(out / "tampering.json")), TamperingToJson(report));
  EXPECT_EQ(ReadFile(out / "tampering.md"), TamperingMarkdown(report));
  EXPECT_THAT(ReadFile(out / "tampering.svg"), HasSubstr("</svg>"));

  AblationRequest other = request;
  other.run.options.train.iterations = 61;
  EXPECT_THAT(MessageOf<InputError>([&] { RunTampering(other, Silent()); }),
              HasSubstr("--iterations was 60, now is 61"));
}

TEST_F(TamperingTest, RefusesContradictingOptions) {
  const auto refusal = [](auto change) {
    AblationRequest request = Ask("refused", "30");
    change(&request);
    const std::string message = MessageOf<UsageError>([&] { RunTampering(request, Silent()); });
    EXPECT_FALSE(fs::exists(request.run.out));
    return message;
  };
  EXPECT_THAT(refusal([](AblationRequest* r) { r->options.rows = "mcmc"; }), HasSubstr("--rows"));
  EXPECT_THAT(refusal([](AblationRequest* r) { r->options.shares = "30,x"; }), HasSubstr("--shares names 'x'"));
  EXPECT_THAT(refusal([](AblationRequest* r) { r->run.options.propose.proposers = std::string("warp"); }),
              HasSubstr("--proposers"));
  EXPECT_THAT(refusal([](AblationRequest* r) { r->run.options.validate.oracle = OracleKind::kUniform; }),
              HasSubstr("--oracle uniform"));
  EXPECT_THAT(refusal([](AblationRequest* r) { r->run.options.train.schedule = ScheduleKind::kNone; }),
              HasSubstr("--schedule none"));
  EXPECT_THAT(refusal([](AblationRequest* r) { r->run.options.depth.depth_prior = DepthPrior::kNone; }),
              HasSubstr("--depth-prior none"));
  AblationRequest parts = Ask("refused", "30");
  parts.options.compare = Comparison::kParts;
  EXPECT_THAT(MessageOf<UsageError>([&] { RunAblation(parts, Silent()); }), HasSubstr("--shares"));
}

TEST_F(TamperingTest, RefusesAFolderOfSomethingElse) {
  fs::create_directories(*temp / "theirs");
  WriteText(*temp / "theirs" / "thesis.tex", "x");
  EXPECT_THAT(MessageOf<InputError>([&] { RunTampering(Ask("theirs", ""), Silent()); }),
              AllOf(HasSubstr("theirs"), HasSubstr("holds no tampering benchmark")));
}

TEST(ParseShares, SortsAndRefuses) {
  EXPECT_THAT(ParseShares(""), ElementsAre(0, 10, 30, 50, 100));
  EXPECT_THAT(ParseShares("50, 0,50"), ElementsAre(0, 50));
  for (const char* bad : {"10,", "-1", "101", "1.5", "ten", "10 20"}) {
    EXPECT_THAT(MessageOf<UsageError>([&] { ParseShares(bad); }), HasSubstr("--shares names")) << bad;
  }
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/pipeline/stages/calibrated_oracle.h"

#include "networks/vggt_fixture.h"
#include "pipeline/proposing.h"
#include "pipeline/weights.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Judges of one run, its targets the first photographs' poses.
class JudgeTest : public ProposingTest {
 protected:
  JudgeTest() {
    RunRequest request = Request("judge");
    request.options.propose.proposers = "warp";
    request.options.split.views = 6;
    run.emplace(StartRun(request, Silent()));
    prepared = Prepare(&*run);
    proposers.emplace(*run, prepared.photos, prepared.geometry, std::vector<ProxyModel>());
    run->listener = [this](const Event& event) {
      if (const auto* s = std::get_if<StepDone>(&event)) steps.push_back({s->done, s->total});
    };
  }

  std::vector<Validated> Ask(const std::string& oracle, int chunk = 0) {
    OracleChoice choice{oracle, std::nullopt};
    if (oracle.starts_with("vggt")) choice.weights = FindVggtWeights(weights);
    run->options.validate.oracle_chunk = chunk;
    const Judge judge(*run, prepared.photos, *proposers, choice, 3);
    together = judge.together();
    std::vector<Target> targets;
    for (size_t v = 0; v < 3; ++v) targets.push_back({prepared.photos[v].name, prepared.photos[v].camera});
    return judge(proposers->Ask(targets, {-1, -1, -1}));
  }

  const std::filesystem::path weights = WriteTinyVggt(*temp / "tiny.safetensors");
  std::optional<oraclegs::Run> run;
  Preparation prepared;
  std::optional<Proposers> proposers;
  std::vector<std::pair<int64_t, int64_t>> steps;
  size_t together = 0;
};

TEST_F(JudgeTest, EveryWordIsAnOracleOfItsOwn) {
  const auto uniform = Ask("uniform"), consistency = Ask("consistency");
  EXPECT_EQ(together, 8u);
  EXPECT_TRUE(steps.empty());
  const auto vggt = Ask("vggt"), both = Ask("vggt+consistency");
  EXPECT_EQ(uniform[0].confidence, ConfidenceMap(uniform[0].confidence.size(), 1.f));
  EXPECT_NE(vggt[0].confidence, consistency[0].confidence);
  EXPECT_NE(both[0].confidence, consistency[0].confidence);
  EXPECT_NE(both[0].confidence, vggt[0].confidence);
  for (const auto* answer : {&uniform, &consistency, &vggt, &both}) {
    ASSERT_EQ(answer->size(), 3u);
    for (const Validated& v : *answer) {
      EXPECT_GE(*std::min_element(v.confidence.begin(), v.confidence.end()), 0.f);
      EXPECT_LE(*std::max_element(v.confidence.begin(), v.confidence.end()), 1.f);
    }
  }
}

TEST_F(JudgeTest, PassesOfTheNetworkAreTold) {
  Ask("vggt", 3);
  EXPECT_EQ(together, 3u);
  ASSERT_EQ(steps.size(), 3u);  // six hidden photographs in two passes, three targets in one
  EXPECT_EQ(steps[0], (std::pair<int64_t, int64_t>{3, 9}));
  EXPECT_EQ(steps[2], (std::pair<int64_t, int64_t>{9, 9}));
}

TEST_F(JudgeTest, WithoutCalibrationVggtCountsAsItIsAndOthersByTheirOrder) {
  const auto vggt = Ask("vggt"), consistency = Ask("consistency");
  run->options.validate.calibrate = false;
  steps.clear();
  const auto raw = Ask("vggt");
  EXPECT_EQ(steps, (std::vector<std::pair<int64_t, int64_t>>{{3, 3}})) << "no photograph is hidden to learn from";
  EXPECT_NE(raw[0].confidence, vggt[0].confidence);
  EXPECT_NE(Ask("consistency")[0].confidence, consistency[0].confidence);
  EXPECT_EQ(Ask("uniform")[0].confidence, ConfidenceMap(raw[0].confidence.size(), 1.f));
}

TEST_F(JudgeTest, ModesGiveOtherConfidence) {
  const auto reference = Ask("vggt");
  run->options.validate.oracle_mode = "others";
  const auto others = Ask("vggt");
  run->options.validate.oracle_mode = "official";
  const auto official = Ask("vggt");
  EXPECT_NE(reference[0].confidence, others[0].confidence);
  EXPECT_NE(reference[0].confidence, official[0].confidence);
  EXPECT_NE(others[0].confidence, official[0].confidence);
}

TEST_F(JudgeTest, WeightsOfAnotherNetworkAreRefused) {
  WriteTinyVggt(weights, [](TinyVggtParts* parts) { parts->tensors.erase("aggregator.camera_token"); });
  EXPECT_THAT(MessageOf<InputError>([&] { Ask("vggt"); }),
              testing::AllOf(HasSubstr(weights.string()), HasSubstr("missing 1: aggregator.camera_token")));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/validate/calibrated_oracle.h"

#include "oraclegs/stages/proposer_row.h"
#include "run/proposing.h"
#include "run/weights.h"
#include "support/errors.h"
#include "support/network_files.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Oracles of one run, its targets the first views' poses.
class CalibratedOracleTest : public ProposingTest {
 protected:
  void SetUp() override { SKIP_WITHOUT_NETWORKS(); }
  CalibratedOracleTest() {
    RunRequest request = Request("oracle");
    request.options.propose.proposers = std::string("warp");
    request.options.split.views = 6;
    run.emplace(StartRun(request, Silent()));
    Bring(&*run, "depth");
    run->listener = [this](const Event& event) {
      if (const auto* s = std::get_if<StepDone>(&event)) steps.push_back({s->done, s->total});
    };
  }

  OracleSetup SetupOf(OracleKind kind, size_t targets) const {
    OracleSetup setup{kind, options};
    if (kind == OracleKind::kVggt || kind == OracleKind::kVggtAndConsistency) setup.vggt = weights;
    setup.targets = targets;
    return setup;
  }

  std::vector<Validated> Classify(OracleKind kind, Auto<int> chunk = {}) {
    options.oracle_chunk = chunk;
    OracleSetup setup = SetupOf(kind, 3);
    setup.unknown_errors = has_folder;
    const TrainingViews& training = ViewsOf(&*run);
    const Proposers& proposers = ProposersOf(&*run);
    const CalibratedOracle oracle(setup, training.views, proposers, run->listener);
    together = oracle.together();
    std::vector<Target> targets;
    for (size_t v = 0; v < 3; ++v) targets.push_back({training.views[v].name, training.views[v].camera});
    return oracle.Classify(proposers.Ask(targets));
  }

  ValidateOptions options;
  bool has_folder = false;
  const std::filesystem::path weights = WriteTinyVggt(*temp / "tiny.safetensors");
  std::optional<oraclegs::Run> run;
  std::vector<std::pair<int64_t, int64_t>> steps;
  size_t together = 0;
};

TEST_F(CalibratedOracleTest, DiffersByKind) {
  const auto uniform = Classify(OracleKind::kUniform), consistency = Classify(OracleKind::kConsistency);
  EXPECT_EQ(together, 8u);
  EXPECT_TRUE(steps.empty());
  const auto vggt = Classify(OracleKind::kVggt), both = Classify(OracleKind::kVggtAndConsistency);
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

TEST_F(CalibratedOracleTest, ReportsPassesOfTheNetwork) {
  Classify(OracleKind::kVggt, 3);
  EXPECT_EQ(together, 3u);
  ASSERT_EQ(steps.size(), 3u);  // six held-out views in two passes, three targets in one
  EXPECT_EQ(steps[0], (std::pair<int64_t, int64_t>{3, 9}));
  EXPECT_EQ(steps[2], (std::pair<int64_t, int64_t>{9, 9}));
}

TEST_F(CalibratedOracleTest, LeavesOutCandidatesOfFoldersThatAreWrongAsAWhole) {
  const TrainingViews& training = ViewsOf(&*run);
  const Proposers& proposers = ProposersOf(&*run);
  const LoadedView& view = training.views[1];
  const Proposal made = proposers.Ask({{view.name, view.camera}})[0][0];
  Proposal right = made, wrong = made;
  right.source = wrong.source = "folder";
  right.rgb = view.rgb;
  std::fill(wrong.rgb.data.begin(), wrong.rgb.data.end(), 0.3f);
  OracleSetup setup = SetupOf(OracleKind::kConsistency, 1);
  const auto calibrated_alone = CalibratedOracle(setup, training.views, proposers, Silent()).Classify({{made}});
  setup.unknown_errors = true;
  const CalibratedOracle oracle(setup, training.views, proposers, Silent());
  const auto answers = oracle.Classify({{made}, {made, wrong}, {wrong}, {made, right}});
  ASSERT_EQ(answers.size(), 4u);
  EXPECT_EQ(answers[0].confidence, calibrated_alone[0].confidence) << "as without a folder";
  EXPECT_EQ(answers[1].proposal.source, "warp");
  EXPECT_EQ(answers[1].confidence, answers[0].confidence);
  EXPECT_EQ(answers[2].confidence, ConfidenceMap(answers[2].confidence.size(), 0.f));
  EXPECT_EQ(answers[3].proposal.source, kMixed);
  EXPECT_GT(*std::max_element(answers[3].confidence.begin(), answers[3].confidence.end()), 0.5f);
}

TEST_F(CalibratedOracleTest, TeachesTheNetworkTamperedViewsForFolders) {
  has_folder = true;
  Classify(OracleKind::kVggtAndConsistency);
  EXPECT_EQ(steps.back().second, 6 + 3 + 24);
  EXPECT_EQ(steps.back().first, steps.back().second);
}

TEST_F(CalibratedOracleTest, UsesVggtAsItIsWithoutCalibration) {
  const auto vggt = Classify(OracleKind::kVggt), consistency = Classify(OracleKind::kConsistency);
  options.calibrate = false;
  steps.clear();
  const auto raw = Classify(OracleKind::kVggt);
  EXPECT_EQ(steps, (std::vector<std::pair<int64_t, int64_t>>{{3, 3}})) << "no view is held out to learn from";
  EXPECT_NE(raw[0].confidence, vggt[0].confidence);
  EXPECT_NE(Classify(OracleKind::kConsistency)[0].confidence, consistency[0].confidence);
  EXPECT_EQ(Classify(OracleKind::kUniform)[0].confidence, ConfidenceMap(raw[0].confidence.size(), 1.f));
}

TEST_F(CalibratedOracleTest, DiffersByMode) {
  const auto reference = Classify(OracleKind::kVggt);
  options.oracle_mode = AttentionMode::kOthers;
  const auto others = Classify(OracleKind::kVggt);
  options.oracle_mode = AttentionMode::kOfficial;
  const auto official = Classify(OracleKind::kVggt);
  EXPECT_NE(reference[0].confidence, others[0].confidence);
  EXPECT_NE(reference[0].confidence, official[0].confidence);
  EXPECT_NE(others[0].confidence, official[0].confidence);
}

TEST_F(CalibratedOracleTest, LooksAtAllImagesTogetherAsThePapersCode) {
  options.calibrate = false, options.oracle_mode = AttentionMode::kOfficial;
  const auto chunk = Classify(OracleKind::kVggt);
  options.oracle_pass = OraclePass::kAll;
  steps.clear();
  const auto all = Classify(OracleKind::kVggt);
  EXPECT_EQ(together, 3u);
  EXPECT_EQ(steps, (std::vector<std::pair<int64_t, int64_t>>{{3, 3}})) << "six photos and three proposals in one pass";
  EXPECT_NE(all[0].confidence, chunk[0].confidence);
  Classify(OracleKind::kVggt, 3);
  EXPECT_EQ(together, 3u) << "all proposals, in passes of three images";
  EXPECT_GT(steps.size(), 2u);
}

TEST_F(CalibratedOracleTest, DiffersByLayers) {
  options.calibrate = false;
  const auto usual = Classify(OracleKind::kVggt);
  options.vggt_layers = "0,2", options.vggt_layer_weights = "1,3";
  EXPECT_EQ(Classify(OracleKind::kVggt)[0].confidence, usual[0].confidence) << "what the file names";
  options.vggt_layers = "1", options.vggt_layer_weights = "";
  EXPECT_NE(Classify(OracleKind::kVggt)[0].confidence, usual[0].confidence);
}

TEST_F(CalibratedOracleTest, RefusesWeightsOfAnotherNetwork) {
  WriteTinyVggt(weights, [](TinyVggtParts* parts) { parts->tensors.erase("aggregator.camera_token"); });
  EXPECT_THAT(MessageOf<InputError>([&] { Classify(OracleKind::kVggt); }),
              testing::AllOf(HasSubstr(weights.string()), HasSubstr("missing 1: aggregator.camera_token")));
}

TEST(ChooseChunk, IsEightOrWhatTheMemoryHolds) {
  const auto bytes = [](int64_t chunk) { return (10 + chunk) << 20; };
  const auto mebibytes = [](uint64_t n) { return n << 20; };
  EventRecorder recorder;
  EXPECT_EQ(ChooseChunk(bytes, {{}, 8, 40}, mebibytes(100), recorder.AsListener()), 8u);
  EXPECT_EQ(ChooseChunk(bytes, {{}, 8, 40}, 0, recorder.AsListener()), 8u);  // unknown
  EXPECT_EQ(ChooseChunk(bytes, {20, 8, 40}, mebibytes(100), recorder.AsListener()), 20u);
  EXPECT_TRUE(recorder.warnings.empty());
  EXPECT_EQ(ChooseChunk(bytes, {{}, 8, 40}, mebibytes(13), recorder.AsListener()), 3u);
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(testing::AllOf(HasSubstr("3 images at a time, not 8"),
                                                                     HasSubstr("--set oracle-chunk=3"))));
  EXPECT_EQ(ChooseChunk(bytes, {20, 8, 40}, mebibytes(13), recorder.AsListener()), 20u);
  EXPECT_THAT(recorder.warnings.back(), testing::AllOf(HasSubstr("--set oracle-chunk=20"), HasSubstr("are free")));
  EXPECT_THAT(MessageOf<RunError>([&] {
                ChooseChunk(bytes, {{}, 8, 40}, mebibytes(10), Silent());
              }),
              testing::AllOf(HasSubstr("for one proposal beside an image"), HasSubstr("--oracle consistency")));
}

TEST(ChooseChunk, TakesAllAtOnceForZero) {
  const auto bytes = [](int64_t chunk) { return (10 + chunk) << 20; };
  EventRecorder recorder;
  EXPECT_EQ(ChooseChunk(bytes, {0, 8, 40}, uint64_t{100} << 20, recorder.AsListener()), 40u);
  EXPECT_EQ(ChooseChunk(bytes, {0, 8, 0}, uint64_t{100} << 20, recorder.AsListener()), 1u) << "no proposal at all";
  EXPECT_TRUE(recorder.warnings.empty());
  EXPECT_EQ(ChooseChunk(bytes, {0, 8, 40}, uint64_t{42} << 20, recorder.AsListener()), 32u);
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(HasSubstr("32 images at a time, not 40")));
}

}  // namespace
}  // namespace oraclegs

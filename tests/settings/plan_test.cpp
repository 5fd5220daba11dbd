#include "oraclegs/settings/plan.h"

#include "oraclegs/networks/loader.h"
#include "run/weights.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RunOptions With(Auto<OracleKind> oracle) {
  RunOptions options;
  options.validate.oracle = oracle;
  return options;
}

TEST(ChooseOracle, FollowsTheWeights) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir dir;
  const ModelsAt models(dir / "models");
  EventRecorder recorder;
  EXPECT_EQ(ChooseOracle(With({})).kind, OracleKind::kConsistency);
  ReportOracleChoice(With({}), ChooseOracle(With({})), recorder.AsListener());
  EXPECT_THAT(recorder.notes, IsEmpty()) << "nobody asked for a network";
  const std::string before = ChooseOracle(With({})).Key();
  WriteTinyVggt(dir / "models" / "vggt" / "model.safetensors");
  const OracleChoice choice = ChooseOracle(With({}));
  EXPECT_EQ(choice.kind, OracleKind::kVggtAndConsistency);
  EXPECT_NE(choice.Key(), before);
  ReportOracleChoice(With({}), choice, recorder.AsListener());
  EXPECT_THAT(recorder.notes.back(), HasSubstr("VGGT-1B with the images"));
}

TEST(ChooseOracle, TakesWhatIsNamed) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  EventRecorder recorder;
  for (const OracleKind kind : {OracleKind::kConsistency, OracleKind::kUniform}) {
    EXPECT_EQ(ChooseOracle(With(kind)).kind, kind);
    ReportOracleChoice(With(kind), ChooseOracle(With(kind)), recorder.AsListener());
  }
  EXPECT_TRUE(recorder.notes.empty());
  for (const OracleKind kind : {OracleKind::kVggt, OracleKind::kVggtAndConsistency}) {
    EXPECT_THAT(MessageOf<InputError>([&] { ChooseOracle(With(kind)); }),
                AllOf(HasSubstr("--oracle " + Word(kind) + " needs"), HasSubstr("models fetch vggt")));
  }
  SKIP_WITHOUT_NETWORKS();
  RunOptions named = With(OracleKind::kVggt);
  named.weights.vggt_weights = WriteTinyVggt(dir / "named.safetensors");
  EXPECT_EQ(ChooseOracle(named).weights->path, dir / "named.safetensors");
}

TEST(ChooseOracle, AllowsAPassOverAllOnlyWhereNothingIsHeldOutAndSizesMayDiffer) {
  RunOptions options = With(OracleKind::kConsistency);
  options.validate.oracle_pass = OraclePass::kAll;
  EXPECT_NO_THROW(ChooseOracle(options)) << "it does not ask VGGT";
  options.validate.oracle = OracleKind::kVggtAndConsistency;
  const auto message = [&] { return MessageOf<UsageError>([&] { ChooseOracle(options); }); };
  EXPECT_THAT(message(), AllOf(HasSubstr("oracle-pass=all"), HasSubstr("oracle-mode=official")));
  options.validate.oracle = OracleKind::kVggt;
  EXPECT_FALSE(message().empty());
  options.validate.oracle_mode = AttentionMode::kOfficial;
  EXPECT_FALSE(message().empty());
  options.validate.calibrate = false;
  EXPECT_THROW(ChooseOracle(options), InputError) << "the weights are all that is missing";
}

TEST(MakePlan, RefusesTheSizeOfAGeneratorThatIsNotAsked) {
  RunOptions options;
  options.propose.proposal_size = ProposalSize::kOwn;
  EXPECT_THAT(MessageOf<UsageError>([&] { MakePlan(options, true); }),
              AllOf(HasSubstr("proposal-size=own"), HasSubstr("seva")));
}

TEST(ChooseOracle, RefusesLayersThatTheNetworkLacks) {
  const TempDir dir;
  RunOptions options = With(OracleKind::kVggt);
  options.weights.vggt_weights = WriteTinyVggt(dir / "tiny.safetensors");
  options.validate.vggt_layers = "0,4";
  EXPECT_THAT(MessageOf<UsageError>([&] { ChooseOracle(options); }),
              HasSubstr("--set vggt-layers names layer 4; VGGT-1B has the layers 0 to 3"));
  options.validate.oracle = OracleKind::kConsistency;
  EXPECT_NO_THROW(ChooseOracle(options)) << "it does not ask VGGT";
}

TEST(NeedsDepth, FollowsStartLossAndPruning) {
  RunOptions options;
  options.propose.proposers = std::string("none");
  options.train.depth_weight = 0;
  const auto needs = [&](Auto<StartKind> init) {
    options.start.init = init;
    return NeedsDepth(options);
  };
  EXPECT_TRUE(needs({}) && needs(StartKind::kDense) && needs(StartKind::kHybrid));
  EXPECT_FALSE(needs(StartKind::kSfm) || needs(StartKind::kRandom));
  options.train.prune_floaters = true;
  EXPECT_TRUE(needs(StartKind::kSfm));
  options.train.prune_floaters = false;
  options.method.method = "dngaussian";
  EXPECT_TRUE(needs(StartKind::kSfm));
  options.method.method = "comapgs";
  EXPECT_TRUE(needs(StartKind::kSfm));
  options.method.method = "3dgs";
  EXPECT_FALSE(needs(StartKind::kSfm));
  options.train = {};
  EXPECT_GT(options.train.depth_weight, 0);
  EXPECT_TRUE(needs(StartKind::kRandom));
  options.depth.depth_prior = DepthPrior::kNone;
  EXPECT_FALSE(needs(StartKind::kRandom) || needs({}));
}

TEST(HasProposals, FollowsProposersAndFolder) {
  RunOptions options;
  EXPECT_TRUE(ProposesViews(options) && HasProposals(options));
  options.train.schedule = ScheduleKind::kNone;
  EXPECT_FALSE(ProposesViews(options) || HasProposals(options));
  options.propose.proposal_folder = "/somewhere";
  EXPECT_FALSE(ProposesViews(options));
  EXPECT_TRUE(HasProposals(options));
}

TEST(MakePlan, SettlesWhatTheRunComesTo) {
  RunOptions options;
  options.device.device = "cpu";
  const Plan plan = MakePlan(options, true);
  EXPECT_TRUE(plan.needs_depth && plan.proposes && plan.has_proposals);
  EXPECT_EQ(plan.depth.prior, DepthPrior::kStereo);
  EXPECT_EQ(plan.oracle.kind, OracleKind::kConsistency);
  EXPECT_TRUE(plan.device.is_cpu());
  EXPECT_TRUE(plan.Uses(options, std::string("proxies")));
  options.propose.proposers = std::string("none");
  options.validate.oracle = OracleKind::kVggt;
  EXPECT_FALSE(MakePlan(options, true).has_proposals) << "no weights are missed";
  options.device.device = "cuda:99";
  EXPECT_THROW(MakePlan(options, true), UsageError);
}

TEST(MakePlan, WithoutTheLibraryTakesWhatNeedsNoNetwork) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  const EnvironmentVariable library(kNetworksVariable, "/nowhere/x.so");
  for (const char* model : {"vggt", "depth-anything-v2-small", "lpips-vgg"}) {
    WriteTinyVggt(dir / "models" / model / "model.safetensors");  // any file will do
  }
  RunOptions options;
  const Plan plan = MakePlan(options, true);
  EXPECT_EQ(plan.depth.prior, DepthPrior::kStereo);
  EXPECT_EQ(plan.oracle.kind, OracleKind::kConsistency);
  EXPECT_TRUE(plan.lpips.empty());
  EventRecorder recorder;
  ReportOracleChoice(options, plan.oracle, recorder.AsListener());
  EXPECT_THAT(recorder.notes, ElementsAre(AllOf(HasSubstr("without VGGT"), HasSubstr("/nowhere/x.so"))));
}

TEST(MakePlan, LeavesLargeNetworksToAGpuUnlessTheCpuIsAskedFor) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir dir;
  const ModelsAt models(dir / "models");
  for (const char* model : {"seva", "vggt"}) WriteLargeWeights(dir / "models" / model / "model.safetensors");
  const DeviceSupport support = ProbeDevices();
  const bool on_cpu = !WhyNetworksOnCpu("auto", ChooseDevice("auto", support), support).empty();
  const auto refusal = [](const RunOptions& options) {
    return MessageOf<UsageError>([&] { MakePlan(options, true); });
  };
  RunOptions seva = With(OracleKind::kConsistency), vggt = With(OracleKind::kVggt);
  seva.propose.proposers = std::string("warp,seva");
  EXPECT_EQ(refusal(seva).starts_with("--proposers seva: Stable Virtual Camera would compute on the CPU, for days: "),
            on_cpu);
  EXPECT_EQ(refusal(vggt).starts_with("--oracle vggt: VGGT would compute on the CPU, for hours: "), on_cpu);
  EXPECT_EQ(MakePlan(With({}), true).oracle.kind, on_cpu ? OracleKind::kConsistency : OracleKind::kVggtAndConsistency);
  EventRecorder recorder;
  ReportOracleChoice(With({}), MakePlan(With({}), true).oracle, recorder.AsListener());
  ASSERT_EQ(recorder.notes.size(), 1u);
  EXPECT_EQ(recorder.notes[0].ends_with(", or accept the CPU with --device cpu"), on_cpu);
  for (RunOptions* options : {&seva, &vggt}) {
    options->device.device = "cpu";
    EXPECT_EQ(refusal(*options), "");
  }
  WriteTinyNetworks(dir / "models");
  seva.device.device = "auto";
  EXPECT_EQ(refusal(seva), "") << "small networks are quick anywhere";
}

TEST(MakePlan, RefusesNetworksWithoutTheLibrary) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  const EnvironmentVariable library(kNetworksVariable, "/nowhere/x.so");
  for (const char* model : {"vggt", "depth-anything-v2-small", "lpips-vgg"}) {
    WriteTinyVggt(dir / "models" / model / "model.safetensors");
  }
  const auto refusal = [](const RunOptions& options) {
    return MessageOf<UsageError>([&] { MakePlan(options, false); });
  };
  RunOptions oracle, depth, seva, poses, lpips;
  oracle.validate.oracle = OracleKind::kVggt;
  EXPECT_THAT(refusal(oracle), AllOf(HasSubstr("--oracle vggt needs networks"), HasSubstr("is not here")));
  depth.depth.depth_prior = DepthPrior::kFused;
  EXPECT_THAT(refusal(depth), HasSubstr("--depth-prior fused needs networks"));
  seva.propose.proposers = std::string("seva");
  EXPECT_THAT(refusal(seva), HasSubstr("--proposers seva needs networks"));
  poses.input.poses = PoseSource::kVggt;
  EXPECT_THAT(refusal(poses), HasSubstr("--poses vggt needs networks"));
  lpips.weights.lpips = LpipsUse::kRequired;
  EXPECT_THAT(refusal(lpips), HasSubstr("--lpips required needs networks"));
}

TEST(TakeSize, LeavesOutProposalsThatTheSizeDoesWithout) {
  Plan plan = MakePlan({}, true);
  ASSERT_TRUE(plan.proposes);
  RunOptions settled;
  settled.propose.proposers = std::string("none");
  TakeSize(settled, &plan);
  EXPECT_FALSE(plan.proposes);
  EXPECT_FALSE(plan.has_proposals);
}

}  // namespace
}  // namespace oraclegs

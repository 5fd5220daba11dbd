#include "oraclegs/settings/missing_networks.h"

#include "oraclegs/weights/registry.h"
#include "run/fixtures.h"
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

/// Options that use every network, as the presets do.
RunOptions Everything() {
  RunOptions options;
  options.propose.proposers = std::string("seva");
  options.validate.oracle = OracleKind::kVggt;
  options.depth.depth_prior = DepthPrior::kMonocular;
  options.weights.lpips = LpipsUse::kRequired;
  return options;
}

std::vector<std::string> Asked(const RunOptions& options, bool has_poses = true) {
  std::vector<std::string> asked;
  for (const MissingNetwork& network : MissingNetworks(options, has_poses)) asked.push_back(network.asked);
  return asked;
}

std::string Refusal(const RunOptions& options) {
  return MessageOf<InputError>([&] { WithNetworksAtHand(options, true, Silent()); });
}

TEST(MissingNetworks, OneErrorNamesAllAndTheCommandsThatBringThem) {
  EXPECT_EQ(
      Refusal(Everything()),
      "--depth-prior depth-anything needs the weights of depth-anything-v2-small, --proposers seva needs the "
      "weights of seva, sd21-vae, openclip-vith14, --oracle vggt needs the weights of vggt, --lpips required "
      "needs the weights of lpips-vgg, which are not here; get them with `oraclegs models fetch "
      "depth-anything-v2-small`, `oraclegs models fetch seva`, `oraclegs models fetch sd21-vae`, `oraclegs models "
      "fetch openclip-vith14`, `oraclegs models fetch vggt`, `oraclegs models fetch lpips-vgg`; --depth-weights, "
      "--vggt-weights, --lpips-weights if they are elsewhere; --allow-fallback does without them");
}

TEST(MissingNetworks, OnlyWhatIsNotThere) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir dir;
  const ModelsAt models(dir.path());
  WriteTinyNetworks(dir.path());
  EXPECT_THAT(Asked(Everything()), IsEmpty());
  std::filesystem::remove(dir / "sd21-vae/model.safetensors");
  EXPECT_THAT(Refusal(Everything()), AllOf(HasSubstr("--proposers seva needs the weights of sd21-vae, which"),
                                           HasSubstr("`oraclegs models fetch sd21-vae`; --allow-fallback")));
  RunOptions options = Everything();
  options.weights.vggt_weights = dir / "none";
  EXPECT_THAT(MessageOf<InputError>([&] { MissingNetworks(options, true); }), HasSubstr("there is no such file"));
}

TEST(MissingNetworks, OnlyWhatTheRunComesTo) {
  EXPECT_THAT(Asked({}), IsEmpty()) << "auto takes what there is";
  RunOptions options = Everything();
  options.weights.lpips = LpipsUse::kWhereFound;
  options.trajectory.proposals = 0;
  EXPECT_THAT(Asked(options), ElementsAre("--depth-prior depth-anything"));
  options.propose.proposal_folder = "given";
  EXPECT_THAT(Asked(options), ElementsAre("--depth-prior depth-anything", "--oracle vggt"));
  options = {};
  options.input.poses = PoseSource::kVggt;
  EXPECT_THAT(Asked(options), IsEmpty());
  EXPECT_THAT(Asked(options, false), ElementsAre("--poses vggt"));
  const EnvironmentVariable no_models("ORACLEGS_MODELS", ""), no_home("HOME", "");
  EXPECT_EQ(Asked(Everything()).size(), 4u);
}

TEST(MissingNetworks, AFallbackSaysWhatItTakes) {
  RunOptions options = Everything();
  options.weights.allow_fallback = true;
  options.input.poses = PoseSource::kVggt;
  EventRecorder recorder;
  const RunOptions changed = WithNetworksAtHand(options, false, recorder.AsListener());
  EXPECT_EQ(changed.propose.proposers, std::string("proxies"));
  EXPECT_EQ(changed.validate.oracle, OracleKind::kConsistency);
  EXPECT_EQ(changed.depth.depth_prior, DepthPrior::kStereo);
  EXPECT_EQ(changed.weights.lpips, LpipsUse::kWhereFound);
  EXPECT_EQ(changed.input.poses, PoseSource::kColmap);
  EXPECT_THAT(
      recorder.warnings,
      ElementsAre("--poses vggt: the weights of vggt are not here; --poses colmap instead",
                  "--depth-prior depth-anything: the weights of depth-anything-v2-small are not here; --depth-prior "
                  "stereo instead",
                  "--proposers seva: the weights of seva, sd21-vae, openclip-vith14 are not here; --proposers "
                  "proxies instead",
                  "--oracle vggt: the weights of vggt are not here; --oracle consistency instead",
                  "--lpips required: the weights of lpips-vgg are not here; L1 and SSIM, and no LPIPS among the "
                  "scores, instead"));
  EXPECT_THAT(Asked(changed, false), IsEmpty());
}

TEST(MissingNetworks, AFallbackKeepsTheOtherProposers) {
  RunOptions options;
  options.weights.allow_fallback = true;
  options.propose.proposers = std::string("warp,seva");
  EXPECT_EQ(WithNetworksAtHand(options, true, Silent()).propose.proposers, std::string("warp"));
}

TEST(MissingNetworks, NamesOfProposersAreInTheRegistry) {
  for (const KnownProposer& proposer : KnownProposers()) {
    for (const char* model : proposer.networks) EXPECT_EQ(WeightsNamed(model).name, model);
  }
}

TEST(MissingNetworks, AreToldBeforeAnythingIsWritten) {
  const TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  request.options.propose.proposers = std::string("seva");
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("--proposers seva needs"));
  EXPECT_FALSE(std::filesystem::exists(request.out));
  request.options.weights.allow_fallback = true;
  EXPECT_EQ(StartRun(request, Silent()).options.propose.proposers, std::string("proxies"));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/experiments/ablation_rows.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "oraclegs/baselines/methods.h"
#include "oraclegs/proposers/proposer_rows.h"
#include "oraclegs/settings/missing_networks.h"
#include "oraclegs/settings/plan.h"

namespace oraclegs {
namespace {

std::string RowList() {
  std::vector<std::string> words;
  for (const AblationRow& row : AblationRows()) words.push_back(fmt::format("{} {}", words.size() + 1, row.name));
  return fmt::format("{}", fmt::join(words, ", "));
}

size_t RowOf(const std::string& word) {
  const std::vector<AblationRow>& rows = AblationRows();
  for (size_t i = 0; i < rows.size(); ++i) {
    if (word == rows[i].name || word == std::to_string(i + 1)) return i;
  }
  throw UsageError("--rows names '{}'; there are {}", word, RowList());
}

/// Proposers of the rows before that of proxy models, which the paper does not have: the generators beside them, or
/// warped images.
Auto<std::string> PaperProposers(const ProposeOptions& asked) {
  if (!asked.Uses(kProxiesWord)) return asked.proposers;
  std::vector<std::string> generators;
  for (const ProposerRow& row : ProposerRows()) {
    if (row.sees_anything && asked.Uses(row.word)) generators.push_back(row.word);
  }
  if (generators.empty()) generators.emplace_back(kWarpWord);
  return fmt::format("{}", fmt::join(generators, ","));
}

/// The training of 3DGS-MCMC as its authors have it, over as many iterations and with as many Gaussians as all rows
/// train. Proposals and depth, which it does not have, are off; how they are used when a later row switches them on is
/// as asked for.
AutoTrainOptions McmcTraining(const AutoTrainOptions& asked) {
  AutoTrainOptions train = Published3dgs();
  train.iterations = asked.iterations, train.horizon = asked.horizon, train.max_gaussians = asked.max_gaussians;
  train.schedule = ScheduleKind::kUnion;
  train.synthetic_floor = asked.synthetic_floor, train.synthetic_peak = asked.synthetic_peak;
  train.proposal_ssim = asked.proposal_ssim, train.proposal_lpips = 0;
  train.confidence_power = asked.confidence_power, train.depth_loss = asked.depth_loss;
  return train;
}

const char* const kScenes[] = {"bicycle", "bonsai", "counter", "garden", "kitchen", "room", "stump"};

}  // namespace

const std::vector<AblationRow>& AblationRows() {
  static const std::vector<AblationRow> rows = {
      {"mcmc", "MCMC, random start",
       "3DGS-MCMC on the views alone, as its authors start it, in a cube of three times the cameras' extent, and train "
       "it: no setting of this program's until the row \"regularizers\"",
       [](const RunOptions& asked, RunOptions* o) {
         const StartOptions usual;
         o->start.init = StartKind::kRandomCube, o->start.init_scale = 0.1;
         o->start.init_opacity = usual.init_opacity;
         o->propose.proposers = std::string(kNoneWord), o->propose.proposal_folder.clear();
         o->propose.generator.clear();
         o->train = McmcTraining(asked.train), o->validate.oracle = OracleKind::kUniform;
         // An oracle that trusts all pixels alike has nothing to calibrate, and no row adds calibration.
         if (asked.validate.oracle != OracleKind::kUniform) o->validate.calibrate = false;
       }},
      {"union", "+ all proposals",
       "proposed views beside the images, drawn from one pile, all pixels trusted alike: warped by stereo's depth "
       "where proxy models are what is asked for, else by the generator that is",
       [](const RunOptions& asked, RunOptions* o) {
         o->propose.proposers = PaperProposers(asked.propose), o->propose.generator = asked.propose.generator;
         o->propose.proposal_folder = asked.propose.proposal_folder;
       }},
      {"schedule", "+ schedule", "the paper's share of proposals over the run, 0.1 + t (1-t)^3",
       [](const RunOptions&, RunOptions* o) { o->train.schedule = ScheduleKind::kPaper; }},
      {"lpips", "+ LPIPS", "the proposals' loss has a share of LPIPS, which it takes from L1",
       [](const RunOptions& asked, RunOptions* o) { o->train.proposal_lpips = asked.train.proposal_lpips; }},
      {"sfm", "+ SfM start", "Gaussians start at points triangulated from the training views",
       [](const RunOptions&, RunOptions* o) { o->start.init = StartKind::kSfm; }},
      {"depth", "+ depth", "inverse depth in the loss of the views",
       [](const RunOptions& asked, RunOptions* o) { o->train.depth_weight = asked.train.depth_weight; }},
      {"confidence", "+ confidence",
       "each proposed pixel counts by what its oracle predicts, which orders the pixels: the whole of the paper",
       [](const RunOptions& asked, RunOptions* o) { o->validate.oracle = asked.validate.oracle; }},
      {"dense", "+ dense start", "Gaussians start at stereo's dense points, at the size of their distances",
       [](const RunOptions& asked, RunOptions* o) {
         const uint64_t seed = o->start.seed;
         o->start = asked.start, o->start.seed = seed;
       }},
      {"regularizers", "+ regularizers",
       "this program's own training in place of 3DGS-MCMC's: noise on opacities, dropout for objects, learning rates "
       "that suit the number of iterations and come to rest, a cap on scales, alpha in the loss where images have it, "
       "color maps where exposures vary",
       [](const RunOptions& asked, RunOptions* o) { o->train = asked.train; }},
      {"calibration", "+ calibrated oracle",
       "what the oracle predicts is mapped to what such pixels were worth in held-out views",
       [](const RunOptions& asked, RunOptions* o) { o->validate.calibrate = asked.validate.calibrate; }},
      {"proxies", "+ proxy models",
       "the mean of proxy models in place of the warped views, in more of the iterations: everything that "
       "`reconstruct` does",
       [](const RunOptions& asked, RunOptions* o) { o->propose = asked.propose; }},
  };
  return rows;
}

RunOptions RowOptions(size_t row, const RunOptions& asked) {
  RunOptions options = asked;
  for (size_t i = 0; i <= row; ++i) AblationRows()[i].apply(asked, &options);
  return options;
}

std::vector<size_t> ChooseRows(const std::string& words) {
  std::set<size_t> chosen;
  for (size_t begin = 0; begin <= words.size() && !words.empty();) {
    const size_t end = std::min(words.find(',', begin), words.size());
    std::string word = words.substr(begin, end - begin);
    word.erase(0, std::min(word.find_first_not_of(' '), word.size()));
    word.erase(word.find_last_not_of(' ') + 1);
    chosen.insert(RowOf(word));
    begin = end + 1;
  }
  if (words.empty()) {
    for (size_t i = 0; i < AblationRows().size(); ++i) chosen.insert(i);
  }
  return {chosen.begin(), chosen.end()};
}

void RequireAblatable(const RunOptions& asked) {
  if (!HasProposals(asked) || asked.train.schedule == ScheduleKind::kNone) {
    throw UsageError(
        "--proposers none, --proposals 0 and --schedule none leave an ablation no proposals to speak of; leave them "
        "out");
  }
  if (asked.depth.depth_prior == DepthPrior::kNone) {
    throw UsageError("--depth-prior none leaves an ablation no depth to speak of; leave it out");
  }
  const Auto<StartKind>& init = asked.start.init;
  if (init == StartKind::kRandom || init == StartKind::kRandomCube) {
    throw UsageError("--init {} is what the first rows start from by themselves; leave it out, or give another",
                     Word(init.value()));
  }
}

void RequireNetworksOfRows(const RunOptions& asked) {
  MakePlan(WithNetworksAtHand(asked, true, Silent()), true, SensorDepth::kSome);  // of each scene, its run will know
}

std::vector<PublishedStep> PublishedSteps(int views) {
  if (views == 12) {
    return {{"mcmc", "14.10", 0.285, 0.560},      {"union", "16.72", 0.382, 0.596}, {"schedule", "17.32", 0.433, 0.515},
            {"lpips", "17.60", 0.446, 0.459},     {"sfm", "19.96", 0.583, 0.362},   {"depth", "20.28", 0.592, 0.354},
            {"confidence", "20.32", 0.596, 0.350}};
  }
  if (views == 24) {
    return {{"mcmc", "17.95", 0.479, 0.409},      {"union", "16.88", 0.428, 0.565},
            {"schedule", "29.85*", 0.585, 0.362}, {"lpips", "21.34", 0.598, 0.328},
            {"sfm", "22.88", 0.691, 0.284},       {"depth", "23.64", 0.717, 0.258},
            {"confidence", "23.72", 0.723, 0.244}};
  }
  return {};
}

int ViewsOfPublishedSteps(const std::string& scene, const RunOptions& options) {
  if (std::find(std::begin(kScenes), std::end(kScenes), scene) == std::end(kScenes)) return 0;
  const bool is_split_alike = options.split.test_every == 8 && options.split.train_views.empty() &&
                              options.split.test_views.empty() && options.split.view_steps == ViewSteps::kTruncate;
  const bool is_sized_alike = options.image.downscale == 4 && options.image.smaller_copies == SmallerCopies::kRequired;
  const int views = options.split.views;
  return is_split_alike && is_sized_alike && !PublishedSteps(views).empty() ? views : 0;
}

bool AreScenesOfPublishedSteps(std::vector<std::string> scenes) {
  std::sort(scenes.begin(), scenes.end());
  return std::equal(scenes.begin(), scenes.end(), std::begin(kScenes), std::end(kScenes));
}

}  // namespace oraclegs

#include "oraclegs/validate/tamper_trained_oracle.h"

#include <cmath>
#include <numeric>

#include "oraclegs/core/parallel.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/validate/tamper.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

/// Probability that a tampered pixel has less confidence than another one.
double Auroc(std::vector<std::pair<float, bool>> pixels) {
  std::sort(pixels.begin(), pixels.end());
  double tampered = 0, pairs = 0;
  for (const auto& [confidence, is_tampered] : pixels) {
    tampered += is_tampered ? 1 : 0;
    pairs += is_tampered ? 0 : tampered;
  }
  return pairs / (tampered * (static_cast<double>(pixels.size()) - tampered));
}

/// RMS difference over the channels.
float ColorDistanceOf(const float* a, const float* b) {
  float squares = 0;
  for (int c = 0; c < 3; ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(squares / 3);
}

double MeanConfidenceOf(const ConfidenceMap& map) {
  return std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
}

/// An oracle trained on views of a demo scene, and images of spare views, which a generator could have made.
class TamperTrainedOracleTest : public ProposingTest {
 protected:
  TamperTrainedOracleTest() {
    RunRequest request = Request("tamper_trained");
    request.options.propose.proposers = std::string("none");
    request.options.train.depth_weight = 0.1;
    run.emplace(StartRun(request, Silent()));
    Bring(&*run, "depth");
    const Proposers& proposers = ProposersOf(&*run);
    std::vector<Target> targets;
    std::vector<std::optional<int>> held_out;
    const std::vector<LoadedView>& views = ViewsOf(&*run).views;
    for (size_t v = 0; v < views.size(); ++v) {
      targets.push_back({views[v].name, views[v].camera});
      held_out.emplace_back(static_cast<int>(v));
    }
    held_out_views.emplace(HeldOutCandidates{views, proposers.Ask(targets, held_out)});
    spare = LoadViews(run->scene, SpareViews(*run), run->plan.image, Silent());
  }

  TamperTrainedOracle Train() {
    return TamperTrainedOracle(FeatureSource(ProposersOf(&*run).warper()), ProposersOf(&*run), *held_out_views,
                               LevelRule::kFitted, run->options.start.seed);
  }

  static Proposal Showing(const LoadedView& view, ImageF rgb) {
    return {view.name, "folder", view.camera, std::move(rgb)};
  }

  std::optional<oraclegs::Run> run;
  std::optional<HeldOutCandidates> held_out_views;
  std::vector<LoadedView> spare;
};

TEST_F(TamperTrainedOracleTest, DistrustsWhatIsTamperedWith) {
  std::vector<Proposal> proposals;
  std::vector<Tampered> tampered;
  for (size_t s = 0; s < spare.size(); ++s) {
    Rng rng(99, RandomStream::kDemoScene, s << 32);
    tampered.push_back(Tamper(spare[s].rgb, spare[(s + 3) % spare.size()].rgb, 0.3, &rng));
    proposals.push_back(Showing(spare[s], tampered.back().rgb));
  }
  const std::vector<ConfidenceMap> maps = Train().Predict(proposals);
  std::vector<std::pair<float, bool>> pixels;
  for (size_t s = 0; s < spare.size(); ++s) {
    for (size_t i = 0; i < maps[s].size(); ++i) {
      const bool moved = ColorDistanceOf(&tampered[s].rgb.data[3 * i], &spare[s].rgb.data[3 * i]) > 0.05f;
      if (tampered[s].share[i] == 0 || moved) pixels.emplace_back(maps[s][i], moved);
    }
  }
  EXPECT_GT(Auroc(pixels), 0.8) << "of images of 80 x 60 pixels, where depth is poor";
}

TEST_F(TamperTrainedOracleTest, TrustsNothingOfPicturesThatAreWrongAsAWhole) {
  const ImageF constant{80, 60, 3, std::vector<float>(size_t{80} * 60 * 3, 0.4f)};
  const LoadedView& view = spare[2];
  const std::vector<ConfidenceMap> maps =
      Train().Predict({Showing(view, view.rgb), Showing(view, constant), Showing(view, UpsideDown(view.rgb)),
                       Showing(view, Zoomed(view.rgb, 1.5)), Showing(view, spare[7].rgb)});
  EXPECT_GT(MeanConfidenceOf(maps[0]), 0.5);
  for (size_t m = 1; m < maps.size(); ++m) EXPECT_EQ(MeanConfidenceOf(maps[m]), 0) << m;
}

TEST_F(TamperTrainedOracleTest, PredictsTheSameForAnyNumberOfThreads) {
  const std::vector<Proposal> proposals = {Showing(spare[0], spare[0].rgb)};
  SetNumThreads(1);
  const std::vector<ConfidenceMap> one = Train().Predict(proposals);
  SetNumThreads(5);
  const std::vector<ConfidenceMap> five = Train().Predict(proposals);
  SetNumThreads(0);
  EXPECT_EQ(one, five);
}

TEST_F(TamperTrainedOracleTest, LearnsFromAtMostTwentyFourViews) {
  EXPECT_EQ(TamperTrainedOracle::TrainingSamples(3), 12u);
  EXPECT_EQ(TamperTrainedOracle::TrainingSamples(500), 96u);
}

TEST(LearnedViews, AreAllOfFewAndSomeOfMany) {
  EXPECT_EQ(LearnedViews(3), (std::vector<size_t>{0, 1, 2}));
  const std::vector<size_t> of_many = LearnedViews(300);
  EXPECT_EQ(of_many.size(), 24u);
  EXPECT_EQ(of_many[1] - of_many[0], 12u);
}

}  // namespace
}  // namespace oraclegs

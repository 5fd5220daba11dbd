#include "oraclegs/stages/stage_works.h"

#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "run/fixtures.h"
#include "run/proposing.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;
constexpr auto kWithFolders = std::filesystem::copy_options::recursive;

class TrainStageTest : public testing::Test {
 protected:
  ~TrainStageTest() override { RequestInterrupt(false); }

  std::string Train(const RunRequest& r) {
    auto run = StartRun(r, recorder.AsListener());
    RunStage(&run, "train");
    return ReadFile(run.workspace.point_cloud());
  }
  /// Trains until an interrupt comes, at most 99 iterations after this one: so far apart are the reports of progress.
  void TrainUntil(const RunRequest& r, int64_t iteration) {
    const Listener listener = [iteration](const Event& event) {
      const auto* step = std::get_if<StepDone>(&event);
      if (step && step->stage == "train" && step->done >= iteration) RequestInterrupt(true);
    };
    auto run = StartRun(r, listener);
    EXPECT_THROW(RunStage(&run, "train"), Interrupted);
    RequestInterrupt(false);
  }
  void ChangeAnImage() {
    const PosedScene posed = ReadPosedScene(request.scene, request.options, Silent());
    const auto photo = posed.scene.views[static_cast<size_t>(posed.split.train[0])].image_path;
    Image8 image = ReadImage(photo);
    image.data[0] ^= 0xff;
    WritePng(photo, image);
  }

  TempDir temp;
  RunRequest request = TinyRequest(MakeTinyScene(temp / "scene"), temp / "out");
  EventRecorder recorder;
};

TEST_F(TrainStageTest, TrainsOnce) {
  const std::string ply = Train(request);
  EXPECT_THAT(ply, testing::StartsWith("ply\n"));
  recorder = {};
  EXPECT_EQ(Train(request), ply);
  EXPECT_THAT(recorder.started, testing::Not(Contains("train")));
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("nothing has changed")));
}

TEST_F(TrainStageTest, ContinuesAnInterruptedRunToTheSameBits) {
  request.options.train.iterations = 250;
  RunRequest straight = request;
  straight.out = temp / "straight";
  const std::string expected = Train(straight);
  TrainUntil(request, 100);
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "point_cloud.ply"));
  EXPECT_EQ(Train(request), expected);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("continuing from iteration ")));
}

TEST_F(TrainStageTest, TakesTheCheckpointBeforeADamagedOne) {
  request.options.train.iterations = 250;
  request.options.checkpoints.checkpoint_every = 50;
  RunRequest straight = request;
  straight.out = temp / "straight";
  const std::string expected = Train(straight);
  TrainUntil(request, 100);
  const std::vector<std::filesystem::path> saved = FindCheckpoints(temp / "out" / "checkpoints");
  ASSERT_GE(saved.size(), 2u);
  std::string bytes = ReadFile(saved[0]);
  bytes[bytes.size() / 2] ^= 1;
  WriteText(saved[0], bytes);
  EXPECT_EQ(Train(request), expected);
  EXPECT_THAT(recorder.warnings, Contains(testing::AllOf(HasSubstr(saved[0].string()), HasSubstr("before it"))));
  EXPECT_THAT(recorder.notes, Contains(HasSubstr(saved[1].string())));
}

TEST_F(TrainStageTest, WeighsPhotosByCovisibilityWhichNeedsDepth) {
  request.options.method.method = "comapgs";
  request.options.depth.depth_prior = DepthPrior::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { Train(request); }),
              HasSubstr("--set method=comapgs needs depth, and --depth-prior none finds none"));
}

TEST_F(TrainStageTest, StopsWhenItsFolderIsRemoved) {
  request.options.train.iterations = 100000;
  const Listener listener = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (step && step->stage == "train") std::filesystem::remove_all(temp / "out");
  };
  auto run = StartRun(request, listener);
  EXPECT_THAT(MessageOf<RunError>([&] { RunStage(&run, "train"); }),
              HasSubstr("out: was removed or replaced while the run was working there"));
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "point_cloud.ply"));
}

TEST_F(TrainStageTest, HasNoTimingsWhenNothingIsLeftToDo) {
  request.options.checkpoints.checkpoint_every = request.options.train.iterations.value();
  const std::string ply = Train(request);
  const auto train = [&] { return nlohmann::json::parse(ReadFile(temp / "out" / "stages.json")).at("train"); };
  const auto timings = [&] { return train().at("milliseconds_per_iteration"); };
  EXPECT_GT(timings().at("total"), 0);
  EXPECT_GT(timings().at("gaussian_backward"), 0);
  EXPECT_GT(train().at("cpu_seconds"), 0);
  std::filesystem::remove(temp / "out" / "point_cloud.ply");
  EXPECT_EQ(Train(request), ply);  // from the checkpoint of the last iteration
  EXPECT_TRUE(timings().is_null());
  EXPECT_TRUE(train().at("cpu_seconds").is_null()) << "the process that trained is gone";
}

TEST_F(TrainStageTest, AFinishedRunGoesOnWithMoreIterations) {
  request.options.train.iterations = 60;
  const std::string first = Train(request);
  for (const char* copy : {"again", "killed"}) std::filesystem::copy(temp / "out", temp / copy, kWithFolders);
  request.options.train.iterations = 250;
  const std::string longer = Train(request);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("continuing from iteration 60 ")));
  EXPECT_NE(longer, first);
  EXPECT_EQ(StartRun(request, Silent()).workspace.Record("train").at("iterations"), 250);
  EXPECT_EQ(ReadCurves(temp / "out" / "train.csv").front().iteration, 1);
  EXPECT_EQ(ReadCurves(temp / "out" / "train.csv").back().iteration, 250);

  request.out = temp / "again";
  EXPECT_EQ(Train(request), longer) << "the same bits";
  request.out = temp / "killed";
  TrainUntil(request, 100);
  EXPECT_EQ(Train(request), longer) << "the same bits after an interrupt";

  request.options.train.iterations = 60;
  EXPECT_THAT(MessageOf<InputError>([&] { Train(request); }), HasSubstr("--iterations was 250, now is 60"));
}

TEST_F(TrainStageTest, AFinishedRunGoesOnWithinItsHorizonAsIfItHadNotStopped) {
  request.options.train.horizon = 90;
  request.options.train.opacity_noise = 0;
  RunRequest straight = request;
  straight.out = temp / "straight";
  straight.options.train.iterations = 90;
  Train(straight);
  request.options.train.iterations = 40;
  Train(request);
  request.options.train.iterations = 90;
  Train(request);
  // The end of the first part made no step, so that the bits differ, and little else.
  const auto loss = [&](const char* run) { return ReadCurves(temp / run / "train.csv").back().loss; };
  EXPECT_NEAR(loss("out"), loss("straight"), 0.1 * loss("straight"));
}

TEST_F(TrainStageTest, KeepsTheLastCheckpointAlone) {
  request.options.checkpoints.checkpoint_every = 10;
  Train(request);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(temp / "out" / "checkpoints")) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, testing::ElementsAre("iteration_0000030.safetensors"));
}

TEST_F(TrainStageTest, RefusesOtherOptionsThanTheInterruptedRuns) {
  request.options.train.iterations = 250;
  TrainUntil(request, 100);
  request.options.start.seed = 3;
  EXPECT_THAT(MessageOf<InputError>([&] { Train(request); }), HasSubstr("--seed was 0, now is 3"));
}

TEST_F(TrainStageTest, TrainsChangedImagesAnew) {
  request.options.train.iterations = 250;
  TrainUntil(request, 100);
  ChangeAnImage();
  Train(request);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("changed")));
}

TEST_F(TrainStageTest, RemovesResultsOfOldImages) {
  request.options.train.iterations = 250;
  Train(request);
  WriteText(temp / "out" / "metrics.json", "{}");
  ChangeAnImage();
  TrainUntil(request, 100);
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "point_cloud.ply"));
  EXPECT_FALSE(std::filesystem::exists(temp / "out" / "metrics.json"));
  auto run = OpenRun(request, Silent());
  EXPECT_THAT(MessageOf<InputError>([&] { EvaluateRun(&run); }), HasSubstr("point_cloud.ply: does not exist"));
}

using TrainOnProposalsTest = ProposingTest;

TEST_F(TrainOnProposalsTest, UsesLpipsWhereThereAreWeights) {
  SKIP_WITHOUT_NETWORKS();
  RunRequest plain = Request("plain"), with = Request("lpips");
  for (RunRequest* request : {&plain, &with}) {
    request->options.propose.proposers = std::string("warp");
    request->options.train.iterations = 12, request->options.train.synthetic_floor = 0.9;
  }
  with.options.weights.lpips_weights = WriteTinyLpips(*temp / "lpips.safetensors");
  const auto train = [&](const RunRequest& request) {
    auto run = StartRun(request, recorder.AsListener());
    RunStage(&run, "train");
    return std::pair{ReadFile(run.workspace.point_cloud()), run.workspace.Record("train")};
  };
  const auto without_network = train(plain);
  EXPECT_TRUE(without_network.second.at("lpips").is_null());
  EXPECT_THAT(recorder.notes, Not(Contains(HasSubstr("LPIPS")))) << "nobody asked for it";
  recorder = {};
  const auto with_network = train(with);
  EXPECT_EQ(with_network.second.at("lpips"), "VGG16, images in [0, 1]");
  EXPECT_THAT(recorder.notes, testing::Not(Contains(HasSubstr("without LPIPS"))));
  EXPECT_NE(with_network.first, without_network.first);
  EXPECT_EQ(train(with), with_network) << "nothing has changed";

  // Weights that come are a reason to train anew, also where a checkpoint of the last iteration stands.
  plain.options.weights = with.options.weights;
  recorder = {};
  EXPECT_EQ(train(plain).first, with_network.first);
  WriteTinyLpips(*temp / "lpips.safetensors", 8);
  EXPECT_NE(train(plain).first, with_network.first);
}

}  // namespace
}  // namespace oraclegs

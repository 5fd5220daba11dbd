#include "oraclegs/stages/stage_works.h"

#include "oraclegs/depth/depth_files.h"
#include "oraclegs/settings/device.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// One demo scene, and the depth of its training photographs in temp/out.
class DepthStageTest : public testing::Test {
 protected:
  static RunRequest Request() {
    RunRequest request = TinyRequest(temp->path() / "scene", temp->path() / "out");
    request.options.stereo.iterations = 2;
    request.options.stereo.geometric_passes = 1;
    return request;
  }
  static void SetUpTestSuite() {
    temp = new TempDir;
    MakeTinyScene(*temp / "scene", 9);
    auto run = StartRun(Request(), Silent());
    first = new Geometry(Find(&run, {}));
  }
  static void TearDownTestSuite() {
    delete first;
    delete temp;
  }
  /// The depth of a run whose stage "sfm" found these points.
  static Geometry Find(oraclegs::Run* run, std::vector<ScenePoint> points) {
    RequireDepth(run);
    GivePoints(run, std::move(points));
    return Bring(run, "depth").geometry;
  }

  Geometry Again(const RunRequest& request) {
    auto run = StartRun(request, recorder.AsListener());
    return Find(&run, {});
  }

  /// Whether stereo ran, which reports steps; reading back reports none.
  bool Searched(const RunRequest& request, Geometry* geometry) {
    auto run = StartRun(request, Silent());
    run.listener = recorder.AsListener();
    recorder.steps.clear();
    *geometry = Find(&run, {});
    return std::any_of(recorder.steps.begin(), recorder.steps.end(),
                       [](const StepDone& step) { return step.stage == "depth"; });
  }

  static void ExpectTheSame(const Geometry& a, const Geometry& b) {
    ASSERT_EQ(a.maps.size(), b.maps.size());
    for (size_t v = 0; v < a.maps.size(); ++v) {
      EXPECT_EQ(a.maps[v].name, b.maps[v].name);
      EXPECT_EQ(a.maps[v].inv_depth, b.maps[v].inv_depth);
      EXPECT_EQ(a.maps[v].normals, b.maps[v].normals);
      EXPECT_EQ(a.maps[v].confidence, b.maps[v].confidence);
    }
    ASSERT_EQ(a.points.size(), b.points.size());
    for (size_t i = 0; i < a.points.size(); ++i) ASSERT_EQ(a.points[i].xyz, b.points[i].xyz);
  }

  /// "images/002.png" -> "images_002.png"
  static std::string FileOf(const DepthMap& map) {
    std::string file = map.name;
    std::replace(file.begin(), file.end(), '/', '_');
    return file;
  }

  static inline TempDir* temp = nullptr;
  static inline Geometry* first = nullptr;
  EventRecorder recorder;
};

TEST_F(DepthStageTest, WritesAMapForEachTrainingView) {
  auto run = OpenRun(Request(), Silent());
  ASSERT_EQ(first->maps.size(), run.split.train.size());
  const fs::path dir = run.workspace.depth();
  EXPECT_TRUE(fs::exists(dir / "depth_params.json"));
  for (size_t v = 0; v < first->maps.size(); ++v) {
    const DepthMap& map = first->maps[v];
    EXPECT_EQ(map.name, run.scene.views[static_cast<size_t>(run.split.train[v])].name);
    EXPECT_EQ(map.size(), 48u * 36u);
    const std::string file = FileOf(map);
    for (const char* folder : {"", "confidence", "normals"}) {
      EXPECT_TRUE(fs::exists(dir / folder / file)) << folder << " " << file;
    }
    EXPECT_TRUE(fs::exists((dir / "preview" / file).replace_extension(".jpg"))) << file;
  }
  const nlohmann::json record = run.workspace.Record("depth");
  EXPECT_EQ(record.at("points"), first->points.size());
  EXPECT_EQ(record.at("device"), ChooseDevice(Request().options.device.device, ProbeDevices()).Name());
  EXPECT_EQ(record.at("files").size(), 4 * first->maps.size() + 2);
  EXPECT_EQ(ReadFile(run.workspace.dense_ply()).substr(0, 4), "ply\n");
}

TEST_F(DepthStageTest, ReadsBackWhenNothingHasChanged) {
  Geometry geometry;
  EXPECT_FALSE(Searched(Request(), &geometry));
  ExpectTheSame(geometry, *first);
}

TEST_F(DepthStageTest, ReportsConfidence) {
  const Geometry geometry = Again(Request());
  ASSERT_FALSE(recorder.notes.empty());
  EXPECT_THAT(recorder.notes.back(), testing::AllOf(HasSubstr("depth: confident on"), HasSubstr("dense points")));
  for (const DepthMap& map : geometry.maps) {
    const bool warned = !recorder.warnings.empty() && recorder.warnings.back().find(map.name) != std::string::npos;
    EXPECT_EQ(warned, ConfidentShare(map) < 0.02) << map.name;
  }
}

TEST_F(DepthStageTest, FindsDepthAgainAfterDamage) {
  const fs::path file = temp->path() / "out" / "depth" / "confidence" / FileOf(first->maps[1]);
  WriteText(file, ReadFile(file).substr(0, 60));
  Geometry geometry;
  EXPECT_TRUE(Searched(Request(), &geometry));
  ASSERT_FALSE(recorder.warnings.empty());
  EXPECT_THAT(recorder.warnings.front(),
              testing::AllOf(HasSubstr(file.string()), HasSubstr("; stage depth is made again")));
  ExpectTheSame(geometry, *first);
}

TEST_F(DepthStageTest, FindsDepthAgainWhenAFileIsMissing) {
  fs::remove(temp->path() / "out" / "sfm" / "dense.ply");
  Geometry geometry;
  EXPECT_TRUE(Searched(Request(), &geometry));
  ExpectTheSame(geometry, *first);
  EXPECT_TRUE(fs::exists(temp->path() / "out" / "sfm" / "dense.ply"));
}

TEST_F(DepthStageTest, FindsOtherDepthForOtherOptions) {
  RunRequest request = Request();
  request.out = temp->path() / "other";
  request.options.stereo.geometric_passes = 2;
  Geometry geometry;
  EXPECT_TRUE(Searched(request, &geometry));
  EXPECT_FALSE(Searched(request, &geometry));
  request.options.stereo.iterations = 1;
  request.overwrite = true;
  EXPECT_TRUE(Searched(request, &geometry));
}

TEST_F(DepthStageTest, ReadsBackWhatAnotherDeviceFound) {
  RunRequest request = Request();
  request.out = temp->path() / "device";
  Geometry geometry;
  EXPECT_TRUE(Searched(request, &geometry));
  request.options.device.device = "cpu";
  EXPECT_FALSE(Searched(request, &geometry));
  request.options.device.device = "cuda:99";  // no machine has it
  EXPECT_THAT(MessageOf<UsageError>([&] { Again(request); }), HasSubstr("--device cuda:99"));
}

/// Points before each training view, which a network can be aligned to.
std::vector<ScenePoint> PointsOf(const oraclegs::Run& run) {
  std::vector<ScenePoint> points;
  for (const int view : run.split.train) {
    const Camera camera = WorkingCamera(run.scene.views[static_cast<size_t>(view)], run.plan.image);
    for (int i = 0; i < 100; ++i) {
      const double z = 3 + 0.02 * (i * 37 % 100), x = i * 7 % 48 + 0.5, y = i * 11 % 36 + 0.5;
      const Eigen::Vector3d in_camera((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z);
      points.push_back({camera.cam_from_world.inverse() * in_camera, {}, {view}});
    }
  }
  return points;
}

TEST_F(DepthStageTest, FusesStereoWithANetwork) {
  SKIP_WITHOUT_NETWORKS();
  RunRequest request = Request();
  request.out = temp->path() / "fused";
  request.options.depth.depth_prior = DepthPrior::kFused;
  request.options.weights.depth_weights = WriteTinyDepthAnything(temp->path() / "tiny.safetensors");
  auto run = StartRun(request, recorder.AsListener());
  const std::vector<ScenePoint> points = PointsOf(run);
  const Geometry fused = Find(&run, points);
  const std::string key = StageKey(&run, Stages(), "depth");
  EXPECT_TRUE(std::any_of(fused.maps.begin(), fused.maps.end(), [](const DepthMap& map) { return map.monocular; }));
  const nlohmann::json record = run.workspace.Record("depth");
  EXPECT_EQ(record.at("prior"), "fused");
  EXPECT_GE(record.at("right"), 0);
  EXPECT_EQ(record.at("network"), "Depth Anything V2 of another size");
  EXPECT_THAT(recorder.notes,
              testing::Contains(HasSubstr("Depth Anything V2 of another size (fused) is right to 5 % on ")));
  const nlohmann::json params = nlohmann::json::parse(ReadFile(run.workspace.depth() / "depth_params.json"));
  EXPECT_EQ(params.size(), fused.maps.size());

  bool worked = false;
  const Listener watch = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    worked = worked || (step && step->stage == "depth");
  };
  run.listener = watch;
  run.results->keys.clear();
  ExpectTheSame(Find(&run, points), fused);
  EXPECT_FALSE(worked) << "read back";
  EXPECT_EQ(run.workspace.Record("depth"), record);

  WriteTinyDepthAnything(temp->path() / "tiny.safetensors", 6);
  run.files = {};
  Find(&run, points);
  EXPECT_NE(StageKey(&run, Stages(), "depth"), key);
  EXPECT_TRUE(worked) << "other weights are another depth";
}

TEST_F(DepthStageTest, RunsANetworkAlone) {
  SKIP_WITHOUT_NETWORKS();
  RunRequest request = Request();
  request.out = temp->path() / "alone";
  request.options.depth.depth_prior = DepthPrior::kMonocular;
  request.options.weights.depth_weights = WriteTinyDepthAnything(temp->path() / "alone.safetensors");
  auto run = StartRun(request, recorder.AsListener());
  int steps = 0;
  run.listener = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    steps += step && step->stage == "depth" ? 1 : 0;
  };
  const Geometry alone = Find(&run, PointsOf(run));
  EXPECT_EQ(static_cast<size_t>(steps), alone.maps.size()) << "one prediction for each view, no search";
  size_t known = 0;
  for (const DepthMap& map : alone.maps) {
    EXPECT_TRUE(map.monocular);
    known +=
        static_cast<size_t>(std::count_if(map.inv_depth.begin(), map.inv_depth.end(), [](float w) { return w > 0; }));
  }
  EXPECT_GT(known, 0u);
  EXPECT_FALSE(alone.points.empty()) << "a dense start can be made of it";
  EXPECT_EQ(run.workspace.Record("depth").at("prior"), "depth-anything");
}

TEST_F(DepthStageTest, SaysNothingOfANetworkThatNobodyAskedFor) {
  RunRequest request = Request();
  request.out = temp->path() / "stereo";
  request.options.depth.depth_prior = DepthPrior::kStereo;
  ExpectTheSame(Again(request), *first);
  Again(Request());
  EXPECT_THAT(recorder.notes, testing::Not(testing::Contains(HasSubstr("models fetch"))));
}

TEST_F(DepthStageTest, TakesDepthOfTheUsersOwn) {
  RunRequest request = Request();
  request.out = temp->path() / "of_a_folder";
  request.options.depth.depth_folder = temp->path() / "out" / "depth";
  const Geometry taken = Again(request);
  EXPECT_THAT(recorder.notes, testing::Contains(HasSubstr("depth is that of ")));
  ASSERT_EQ(taken.maps.size(), first->maps.size());
  for (size_t v = 0; v < taken.maps.size(); ++v) {
    for (size_t i = 0; i < taken.maps[v].size(); ++i) {
      EXPECT_NEAR(taken.maps[v].inv_depth[i], first->maps[v].inv_depth[i], 1e-3f);
      EXPECT_NEAR(taken.maps[v].confidence[i], first->maps[v].confidence[i], 0.01f);
    }
  }
}

TEST_F(DepthStageTest, RefusesWrongWeights) {
  SKIP_WITHOUT_NETWORKS();
  RunRequest request = Request();
  request.out = temp->path() / "refused";
  request.options.depth.depth_prior = DepthPrior::kFused;
  EXPECT_THAT(MessageOf<InputError>([&] { Again(request); }), HasSubstr("--depth-prior fused needs the weights"));
  request.options.weights.depth_weights = WriteTinyLpips(temp->path() / "lpips.safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { Again(request); }), HasSubstr("is no Depth Anything V2"));
  request.options.depth.depth_prior = DepthPrior::kNone;
  request.overwrite = true;
  EXPECT_THAT(MessageOf<UsageError>([&] { Again(request); }), HasSubstr("--depth-prior none leaves no depth to find"));
}

TEST_F(DepthStageTest, NamesViewsOfOnePlace) {
  RunRequest request = Request();
  request.out = temp->path() / "one_place";
  auto run = StartRun(request, recorder.AsListener());
  for (SceneView& view : run.scene.views) view.cam_from_world = run.scene.views[0].cam_from_world;
  const Geometry geometry = Find(&run, {});
  EXPECT_TRUE(geometry.points.empty());
  ASSERT_EQ(recorder.warnings.size(), 2u);
  for (const DepthMap& map : geometry.maps) {
    EXPECT_THAT(recorder.warnings[0], testing::AllOf(HasSubstr("from the same point"), HasSubstr(map.name)));
    EXPECT_THAT(recorder.warnings[1], testing::AllOf(HasSubstr("hardly any depth"), HasSubstr(map.name)));
  }
}

}  // namespace
}  // namespace oraclegs

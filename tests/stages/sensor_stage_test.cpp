#include "oraclegs/stages/stage_works.h"

#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/loaded_view.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kWide = 160, kHigh = 120;

/// Stage "depth" with the sensor of a demo scene; the sparse points are true ones, of depth/NNN.png.
class SensorStageTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    DemoSceneOptions options{6, kWide, kHigh, 1};
    options.kind = DemoKind::kWalls;
    options.sensor = true;
    made = new TempDir;
    WriteDemoScene(*made / "scene", options, Silent());
  }
  static void TearDownTestSuite() { delete made; }
  SensorStageTest() { fs::copy(*made / "scene", temp / "scene", fs::copy_options::recursive); }

  oraclegs::Run Start(Auto<DepthPrior> prior = {}) {
    RunRequest request = TinyRequest(temp / "scene", temp / fmt::format("out{}", ++runs));
    request.options.start.init = StartKind::kDense;
    request.options.depth.depth_prior = prior;
    request.options.stereo.iterations = 1;
    request.options.stereo.geometric_passes = 1;
    return StartRun(request, recorder.AsListener());
  }
  std::vector<uint16_t> TrueDepth(const std::string& name) const {
    return ReadPng16(temp / "scene/depth" / fs::path(name).filename()).values;
  }
  /// Points of the true depth, each seen by one view.
  std::vector<ScenePoint> TruePoints(const oraclegs::Run& run) const {
    std::vector<ScenePoint> points;
    for (const int v : run.split.train) {
      const SceneView& view = run.scene.views[static_cast<size_t>(v)];
      const std::vector<uint16_t> depth = TrueDepth(view.name);
      const Camera camera = WorkingCamera(view, run.plan.image);
      for (int y = 4; y < kHigh - 4; y += 7) {
        for (int x = 4; x < kWide - 4; x += 7) {
          const double z = depth[static_cast<size_t>(y * kWide + x)] * 1e-3 / WrittenFromRun(run.frame).scale;
          const Eigen::Vector3d ray((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
          points.push_back({camera.cam_from_world.inverse() * Eigen::Vector3d(z * ray), {}, {v}});
        }
      }
    }
    return points;
  }
  const Geometry& Find(oraclegs::Run* run) {
    GivePoints(run, TruePoints(*run));
    return Bring(run, "depth").geometry;
  }
  /// Share of all pixels whose depth is confident and right to 2 %.
  double ShareRight(const oraclegs::Run& run, const Geometry& geometry) const {
    double right = 0, all = 0;
    for (const DepthMap& map : geometry.maps) {
      const std::vector<uint16_t> truth = TrueDepth(map.name);
      for (size_t i = 0; i < map.size(); ++i, ++all) {
        const double z = truth[i] * 1e-3 / WrittenFromRun(run.frame).scale;
        right += map.confidence[i] >= kConfident && std::abs(z * map.inv_depth[i] - 1) < 0.02 ? 1 : 0;
      }
    }
    return right / all;
  }
  /// Multiplies the sensor's depth of one photo.
  void Scale(int number, double factor) const {
    const fs::path file = temp / "scene/sensor" / fmt::format("{:03}.png", number);
    Image16 image = ReadPng16(file);
    for (uint16_t& value : image.values) value = static_cast<uint16_t>(std::min(value * factor, 65534.));
    WritePng16(file, image.width, image.height, image.values);
  }

  static inline TempDir* made = nullptr;
  TempDir temp;
  EventRecorder recorder;
  int runs = 0;
};

TEST_F(SensorStageTest, KnowsWhatStereoCannot) {
  oraclegs::Run with = Start();
  const double sensor = ShareRight(with, Find(&with));
  EXPECT_THAT(recorder.notes,
              Contains(AllOf(HasSubstr("depth of a sensor for 4 of 4 photos; scale "), HasSubstr("% of the pixels"))));
  EXPECT_THAT(recorder.warnings, IsEmpty());
  const nlohmann::json record = with.workspace.Record("depth");
  EXPECT_EQ(record.at("prior"), "sensor");
  EXPECT_NEAR(record.at("sensor").at("scale").get<double>(), 1, 0.01);
  EXPECT_GT(record.at("sensor").at("right").get<double>(), 0.8);
  oraclegs::Run without = Start(DepthPrior::kStereo);
  EXPECT_GT(sensor, ShareRight(without, Find(&without)) + 0.2);
  EXPECT_FALSE(without.workspace.Record("depth").contains("sensor"));
}

TEST_F(SensorStageTest, ScalesWhatIsInAnotherUnit) {
  for (int i = 0; i < 6; ++i) Scale(i, 2.5);
  oraclegs::Run run = Start();
  const Geometry& geometry = Find(&run);
  EXPECT_NEAR(run.workspace.Record("depth").at("sensor").at("scale").get<double>(), 0.4, 0.01);
  EXPECT_GT(ShareRight(run, geometry), 0.4);
}

TEST_F(SensorStageTest, LeavesOutWhatDoesNotFit) {
  Scale(1, 1.3);
  Scale(2, 0);
  oraclegs::Run run = Start();
  ASSERT_EQ(run.split.train, (std::vector<int>{1, 2, 4, 5}));
  Find(&run);
  EXPECT_THAT(recorder.warnings, Contains(AllOf(HasSubstr("001.png has another scale"), HasSubstr("stereo"))));
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("002.png is all unknown")));
  EXPECT_EQ(run.workspace.Record("depth").at("sensor").at("views"), 2);
}

TEST_F(SensorStageTest, DoesNotUseASensorOfAnotherScene) {
  for (const int i : {1, 2, 4, 5}) Scale(i, 0.5 * i);
  oraclegs::Run run = Start();
  Find(&run);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("the sensor's depth is not used")));
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("depth of a sensor is used for none of 4 photos")));
}

TEST_F(SensorStageTest, ServesHalfOfThePhotos) {
  for (const int i : {0, 1, 2}) fs::remove(temp / "scene/sensor" / fmt::format("{:03}.png", i));
  oraclegs::Run run = Start();
  EXPECT_THAT(recorder.warnings, Contains(AllOf(HasSubstr("3 files"), HasSubstr("sensor/000.png"))));
  Find(&run);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("depth of a sensor for 2 of 4 photos")));
}

TEST_F(SensorStageTest, AChangedFileIsReadAgain) {
  oraclegs::Run run = Start();
  const std::string key = StageKey(&run, *run.stages, "depth");
  Scale(1, 0.9);
  oraclegs::Run other = Start();
  EXPECT_NE(StageKey(&other, *other.stages, "depth"), key);
}

TEST_F(SensorStageTest, RefusesBadFilesBeforeTheWorkspace) {
  const fs::path file = temp / "scene/sensor/004.png";
  WritePng16(file, 10, 10, std::vector<uint16_t>(100, 1000));
  EXPECT_THAT(MessageOf<InputError>([&] { Start(); }), AllOf(HasSubstr("004.png: is 10 x 10"), HasSubstr("stereo")));
  EXPECT_FALSE(fs::exists(temp / "out1"));
  Start(DepthPrior::kStereo);  // which does without
  EXPECT_THAT(recorder.warnings, Not(Contains(HasSubstr("004.png"))));
}

}  // namespace
}  // namespace oraclegs

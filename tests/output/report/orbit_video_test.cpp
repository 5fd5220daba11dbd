#include "oraclegs/output/report/orbit_video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/run/start.h"
#include "run/fake_program.h"
#include "run/trained.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

class OrbitVideoTest : public TrainedTest {
 protected:
  void SetUp() override {
    model = LoadModel(*temp / "out" / "point_cloud.ply", request->options, kCpu);
    const Camera camera{49, 35, 40, 40, 24.5, 17.5, Eigen::Isometry3d::Identity()};
    cameras = {camera, camera};
    cameras[1].cam_from_world.translation().x() = 0.1;
  }
  std::vector<std::string> Files(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    return names;
  }

  Model model;
  std::vector<Camera> cameras;
};

// Keeps what it is fed in the file that it is to write.
constexpr const char* kKeepInput = "for last; do :; done; cat > \"$last\"";

TEST_F(OrbitVideoTest, FeedsTheEncoderWithEvenFrames) {
  const FakeProgram ffmpeg("ffmpeg", kKeepInput);
  const fs::path video = *temp / "film" / "video.mp4";
  ASSERT_TRUE(WriteOrbitVideo(model, cameras, video, {.frames = 3}, Silent()));
  const size_t pixels = ReadFile(video).size() / 3 / 3;
  EXPECT_TRUE(pixels == 48 * 34 || pixels == 50 * 36 || pixels == 48 * 36 || pixels == 50 * 34) << pixels;
  EXPECT_THAT(Files(*temp / "film"), testing::ElementsAre("video.mp4"));
  ASSERT_TRUE(WriteOrbitVideo(model, cameras, video, {.frames = 2, .max_side = 24}, Silent()));
  EXPECT_EQ(ReadFile(video).size(), 2u * 3 * 24 * 18);
}

TEST_F(OrbitVideoTest, FailureIsAWarningAndLeavesNothing) {
  const FakeProgram ffmpeg("ffmpeg", "exit 1");
  EXPECT_FALSE(WriteOrbitVideo(model, cameras, *temp / "none" / "video.mp4", {.frames = 3}, recorder.AsListener()));
  EXPECT_THAT(recorder.warnings, testing::ElementsAre(testing::HasSubstr("ffmpeg failed (exit code 1)")));
  EXPECT_THAT(Files(*temp / "none"), testing::IsEmpty());
  WriteText(*temp / "file", "");
  EXPECT_FALSE(WriteOrbitVideo(model, cameras, *temp / "file" / "video.mp4", {.frames = 3}, recorder.AsListener()));
  EXPECT_EQ(recorder.warnings.size(), 2u);
}

TEST_F(OrbitVideoTest, NothingIsWrittenWithoutFrames) {
  EXPECT_FALSE(WriteOrbitVideo(model, cameras, *temp / "no" / "video.mp4", {.frames = 0}, Silent()));
  EXPECT_FALSE(WriteOrbitVideo(model, {}, *temp / "no" / "video.mp4", {.frames = 3}, Silent()));
  EXPECT_FALSE(fs::exists(*temp / "no"));
  WriteText(*temp / "left" / "video.mp4.tmp", "of a run that was killed");
  EXPECT_FALSE(WriteOrbitVideo(model, cameras, *temp / "left" / "video.mp4", {.frames = 0}, Silent()));
  EXPECT_THAT(Files(*temp / "left"), testing::IsEmpty());
}

TEST_F(OrbitVideoTest, StopsWhenInterrupted) {
  const FakeProgram ffmpeg("ffmpeg", kKeepInput);
  RequestInterrupt(true);
  EXPECT_THROW(WriteOrbitVideo(model, cameras, *temp / "stop" / "video.mp4", {.frames = 3}, Silent()), Interrupted);
  RequestInterrupt(false);
  EXPECT_THAT(Files(*temp / "stop"), testing::IsEmpty());
}

TEST_F(OrbitVideoTest, OfARunLiesInItsWorkspace) {
  const FakeProgram ffmpeg("ffmpeg", kKeepInput);
  const oraclegs::Run run = OpenRun(*request, Silent());
  EXPECT_EQ(WriteOrbitVideo(run, model, {.frames = 2}), *temp / "out" / "renders" / "orbit" / "video.mp4");
  EXPECT_EQ(WriteOrbitVideo(run, model, {.frames = 0}), "");
}

}  // namespace
}  // namespace oraclegs

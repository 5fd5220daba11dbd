#include "oraclegs/networks/seva/plan.h"

#include "networks/seva/chunks_fixture.h"

namespace oraclegs::seva {
namespace {

TEST(SevaPlan, PassSizesMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<int64_t> rows = file.Values<int64_t>("prior_stats.rows");
  const auto columns = static_cast<size_t>(file.Get("prior_stats.rows").shape.at(1));
  const std::vector<Chunking> strategies = {Chunking::kNearestGt, Chunking::kGt, Chunking::kInterp,
                                            Chunking::kInterpGt};
  for (size_t r = 0; r < rows.size(); r += columns) {
    PassRequest request{rows[r + 2], rows[r + 3], rows[r], rows[r + 1], static_cast<double>(rows[r + 5]) / 100};
    const PassSizes sizes = SizePasses(request, strategies.at(static_cast<size_t>(rows[r + 4])));
    EXPECT_EQ(sizes.anchors, rows[r + 6]) << r / columns;
    EXPECT_EQ(sizes.first_frames, rows[r + 7]) << r / columns;
    EXPECT_EQ(sizes.second_frames, rows[r + 8]) << r / columns;
  }
}

/// Cameras on an arc that look at the origin.
std::vector<View> Arc(int count, double first_angle) {
  std::vector<View> views(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisd turn(first_angle + 0.3 * i, Eigen::Vector3d::UnitY());
    View& view = views[static_cast<size_t>(i)];
    view.world_from_camera.linear() = turn.toRotationMatrix();
    view.world_from_camera.translation() = turn * Eigen::Vector3d(0, 0, -3);
  }
  return views;
}

/// Expects that a frame is an input only after it was made, every target is made once, and all jobs have the same
/// number of frames.
void ExpectSound(const Plan& plan, size_t targets) {
  std::vector<int> anchors(plan.anchors.size()), made(targets);
  const auto count_of = [&](const Frame& frame) -> int& {
    auto& list = frame.source == FrameSource::kAnchor ? anchors : made;
    return list.at(static_cast<size_t>(frame.index));
  };
  for (const Job& job : plan.jobs) {
    EXPECT_TRUE(std::any_of(job.frames.begin(), job.frames.end(), [](const Frame& f) { return f.given; }));
    for (const Frame& frame : job.frames) {
      const bool input = frame.source == FrameSource::kInput;
      EXPECT_TRUE(frame.given || !input);
      if (frame.given && !input) {
        EXPECT_EQ(count_of(frame), 1);
      }
    }
    for (const Frame& frame : job.frames) {
      if (!frame.given && !frame.copy) ++count_of(frame);
    }
  }
  EXPECT_EQ(made, std::vector<int>(targets, 1));
  EXPECT_EQ(anchors, std::vector<int>(anchors.size(), 1));
}

TEST(SevaPlan, EveryChoiceOfOptionsMakesEveryTargetOnce) {
  for (const int passes : {1, 2}) {
    for (const auto& [chunking, word] : EnumWords<Chunking>::kWords) {
      if (passes == 1 && (chunking == Chunking::kInterp || chunking == Chunking::kInterpGt)) continue;
      for (const int inputs : {1, 3, 10}) {
        SevaOptions options;
        options.frames = 21;
        options.passes = passes;
        options.chunking = chunking;
        const Plan plan = MakePlan(Arc(inputs, 0.1), Arc(30, 0.17), options);
        SCOPED_TRACE(std::string(word) + " " + std::to_string(passes) + " " + std::to_string(inputs));
        ExpectSound(plan, 30);
        EXPECT_EQ(plan.anchors.empty(), passes == 1);
      }
    }
  }
}

TEST(SevaPlan, NoTargetsMeanNoWork) { EXPECT_TRUE(MakePlan(Arc(3, 0), {}, {}).jobs.empty()); }

TEST(SevaPlan, SaysWhichOptionsDoNotFit) {
  SevaOptions options;
  options.passes = 1;
  options.chunking = Chunking::kInterp;
  try {
    MakePlan(Arc(3, 0), Arc(5, 0), options);
    FAIL() << "planned";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "--seva-chunking interp needs frames made in a first pass; set --seva-passes 2");
  }
  options = {};
  options.frames = 9;
  options.chunking = Chunking::kInterpGt;
  try {
    MakePlan(Arc(7, 0), Arc(5, 0), options);
    FAIL() << "planned";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "7 photos leave --seva-chunking interp-gt no room in chunks of 9 frames; raise --seva-frames");
  }
  EXPECT_THROW(MakePlan({}, Arc(5, 0), {}), ShapeError);
  options = {};
  options.steps = 0;
  EXPECT_THROW(MakePlan(Arc(3, 0), Arc(5, 0), options), UsageError);
}

}  // namespace
}  // namespace oraclegs::seva

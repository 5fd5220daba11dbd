// The GPU's search against the CPU's: the same random numbers and decisions, another order of sums.

#include "oraclegs/depth/plane_search.h"

#include <gmock/gmock.h>

#include <utility>

#include "depth/surfaces.h"
#include "oraclegs/depth/stereo.h"
#include "support/cuda_device.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

constexpr int kSearchWidth = 51, kSearchHeight = 37;  // no whole number of tiles
// Pixels whose two best planes cost the same but for rounding choose differently, and hand their choice on.
constexpr double kAgreeing = 0.98;
constexpr float kSamePlane = 1e-3f, kSameCost = 2e-3f;

class CudaPlaneSearchTest : public CudaTest {
 protected:
  static StereoScene Scene(int views = 3) {
    return SceneOf(TakeAll(kSteep, Arc(views, 8, kSearchWidth, kSearchHeight)), kSteepRange);
  }

  static std::vector<PlaneMap> Start(const StereoScene& scene) {
    std::vector<PlaneMap> maps;
    for (size_t v = 0; v < scene.views.size(); ++v) maps.push_back(RandomPlanes(scene, v, {}));
    return maps;
  }

  static std::vector<PlaneMap> Search(PlaneSearch* search, const StereoScene& scene, const std::vector<PlaneMap>& start,
                                      const std::vector<SearchPass>& passes) {
    search->BeginLevel(scene, start);
    for (const SearchPass& pass : passes) {
      search->BeginPass(pass);
      for (size_t v = 0; v < start.size(); ++v) search->Improve(v);
    }
    return search->EndLevel();
  }
  static std::vector<PlaneMap> OnGpu(const StereoScene& scene, const std::vector<PlaneMap>& start,
                                     const std::vector<SearchPass>& passes) {
    return Search(MakeCudaPlaneSearch(0).get(), scene, start, passes);
  }
  static std::vector<PlaneMap> OnCpu(const StereoScene& scene, const std::vector<PlaneMap>& start,
                                     const std::vector<SearchPass>& passes) {
    return Search(MakePlaneSearch(kCpu).get(), scene, start, passes);
  }

  /// Fraction of the pixels with equal plane and cost.
  static double Agreement(const PlaneMap& a, const PlaneMap& b) {
    size_t same = 0;
    for (size_t i = 0; i < a.planes.size(); ++i) {
      const float tolerance = kSamePlane * b.planes[i].inv_depth;
      same += std::abs(a.planes[i].inv_depth - b.planes[i].inv_depth) <= tolerance &&
                      std::abs(a.planes[i].dx - b.planes[i].dx) <= tolerance &&
                      std::abs(a.planes[i].dy - b.planes[i].dy) <= tolerance &&
                      std::abs(a.costs[i] - b.costs[i]) <= kSameCost
                  ? 1
                  : 0;
    }
    return static_cast<double>(same) / static_cast<double>(a.planes.size());
  }
};

TEST_F(CudaPlaneSearchTest, MatchesCpuAfterOneIteration) {
  for (const auto& [in_color, local] : {std::pair{false, false}, {true, false}, {false, true}}) {
    StereoScene scene = Scene();
    const std::vector<LoadedView> views = TakeAll(kSteep, Arc(3, 8, kSearchWidth, kSearchHeight));
    for (size_t v = 0; in_color && v < 3; ++v) scene.views[v].image = Pack(views[v].rgb);
    const std::vector<PlaneMap> start = Start(scene), gpu = OnGpu(scene, start, {{1, 0, false, local}}),
                                cpu = OnCpu(scene, start, {{1, 0, false, local}});
    for (size_t v = 0; v < 3; ++v) {
      EXPECT_EQ(gpu[v].width, kSearchWidth);
      EXPECT_EQ(gpu[v].height, kSearchHeight);
      EXPECT_GT(Agreement(gpu[v], cpu[v]), kAgreeing) << in_color << " " << local << " " << v;
      EXPECT_LT(Agreement(gpu[v], start[v]), 0.2) << "something was done";
    }
  }
}

TEST_F(CudaPlaneSearchTest, ReachesAccuracyOfCpu) {
  const StereoScene scene = Scene();
  const std::vector<PlaneMap> start = Start(scene);
  const std::vector<SearchPass> passes = {{4, 0, false}, {2, 1, true}};
  const std::vector<PlaneMap> gpu = OnGpu(scene, start, passes), cpu = OnCpu(scene, start, passes);
  for (size_t v = 0; v < 3; ++v) {
    const PlaneMap truth = TrueMap(scene.views[v].camera, kSteep);
    EXPECT_GT(ShareRight(gpu[v], truth, 0.02f), 0.85) << v;
    EXPECT_NEAR(ShareRight(gpu[v], truth, 0.02f), ShareRight(cpu[v], truth, 0.02f), 0.02) << v;
    EXPECT_NEAR(ShareRight(gpu[v], truth, 0.005f), ShareRight(cpu[v], truth, 0.005f), 0.04) << v;
  }
}

TEST_F(CudaPlaneSearchTest, GivesSameBitsAgain) {
  const StereoScene scene = Scene();
  const std::vector<PlaneMap> start = Start(scene), one = OnGpu(scene, start, {{1, 0, false}, {1, 1, true}}),
                              two = OnGpu(scene, start, {{1, 0, false}, {1, 1, true}});
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_EQ(one[v].costs, two[v].costs);
    for (size_t i = 0; i < one[v].planes.size(); ++i) EXPECT_EQ(one[v].planes[i].dx, two[v].planes[i].dx);
  }
}

TEST_F(CudaPlaneSearchTest, UsesMapsOfPreviousPass) {
  const StereoScene scene = Scene();
  std::vector<PlaneMap> start = Start(scene);
  for (const size_t v : {0u, 2u}) start[v] = TrueMap(scene.views[v].camera, kSteep);
  const std::vector<PlaneMap> gpu = OnGpu(scene, start, {{1, 0, true}}), cpu = OnCpu(scene, start, {{1, 0, true}}),
                              without = OnGpu(scene, start, {{1, 0, false}});
  for (size_t v = 0; v < 3; ++v) EXPECT_GT(Agreement(gpu[v], cpu[v]), kAgreeing) << v;
  const PlaneMap truth = TrueMap(scene.views[1].camera, kSteep);
  EXPECT_GT(ShareRight(gpu[1], truth, 0.01f), ShareRight(without[1], truth, 0.01f));
}

TEST_F(CudaPlaneSearchTest, IgnoresUnusablePixels) {
  StereoScene scene = Scene();
  std::vector<uint8_t>& usable = scene.views[1].usable;
  usable.assign(kSearchWidth * kSearchHeight, 1);
  for (int y = 0; y < kSearchHeight; ++y) {
    for (int x = 0; x < 20; ++x) usable[static_cast<size_t>(y * kSearchWidth + x)] = 0;
  }
  const std::vector<PlaneMap> start = Start(scene);
  const std::vector<PlaneMap> gpu = OnGpu(scene, start, {{1, 0, false}}), cpu = OnCpu(scene, start, {{1, 0, false}});
  for (size_t i = 0; i < usable.size(); ++i) {
    if (usable[i] != 0) continue;
    EXPECT_EQ(gpu[1].planes[i].inv_depth, 0);
    EXPECT_EQ(gpu[1].costs[i], kWorstCost);
  }
  for (size_t v = 0; v < 3; ++v) EXPECT_GT(Agreement(gpu[v], cpu[v]), kAgreeing) << v;
  std::vector<uint32_t>& words = scene.views[1].image.channels[0];
  for (size_t i = 0; i < words.size(); ++i) words[i] = usable[i] != 0 ? words[i] : 99;
  scene.views[0].neighbors = scene.views[2].neighbors = {};
  EXPECT_EQ(OnGpu(scene, start, {{1, 0, false}})[1].costs, gpu[1].costs) << "whatever they show";
}

TEST_F(CudaPlaneSearchTest, StaysWithinSilhouettes) {
  TexturedPlane square = kSteep;
  square.half_side = 0.7;
  // The third camera looks along the square and rules most depths out.
  std::vector<Camera> cameras = Arc(2, 8, 96, 72);
  cameras.push_back(CameraAt({3.5, 0, 0.5}, {0, 0, 0.3}, 96, 72));
  const std::vector<LoadedView> views = TakeAll(square, cameras);
  const Silhouettes silhouettes(views);
  ASSERT_FALSE(silhouettes.empty());
  StereoScene scene;
  for (size_t v = 0; v < 3; ++v) {  // images half as large as the silhouettes; beside them all planes are as good
    const ImageF small = ResizeArea(Luma(views[v].rgb), 48, 36);
    std::vector<uint8_t> usable;
    for (size_t i = 0; i < 48 * 36; ++i) usable.push_back(silhouettes.Object(v)[i / 48 * 2 * 96 + i % 48 * 2]);
    scene.views.push_back({Resized(cameras[v], 48, 36), Pack(small), usable, kSteepRange, {v == 0 ? 1 : 0}});
  }
  scene.silhouettes = &silhouettes;
  scene.silhouette_scale = 2;
  const std::vector<PlaneMap> start = Start(scene);
  const std::vector<PlaneMap> gpu = OnGpu(scene, start, {{2, 0, false}}), cpu = OnCpu(scene, start, {{2, 0, false}});
  for (size_t v = 0; v < 3; ++v) EXPECT_GT(Agreement(gpu[v], cpu[v]), kAgreeing) << v;
  int compared = 0;
  for (size_t v = 0; v < 3; ++v) {
    for (size_t other = 0; other < 3; ++other) {
      if (other == v) continue;
      const PixelMap there = MapBetween(scene.views[v].camera, scene.views[other].camera);
      for (int i = 0; i < 48 * 36; ++i) {
        if (!(gpu[v].costs[static_cast<size_t>(i)] < kWorstCost)) continue;
        const float u = static_cast<float>(i % 48) + 0.5f, w = static_cast<float>(i / 48) + 0.5f;
        const Eigen::Vector3f q = there(u, w, gpu[v].planes[static_cast<size_t>(i)].inv_depth);
        EXPECT_TRUE(!(q.z() > 0) || silhouettes.MayContain(other, 2 * q.x() / q.z(), 2 * q.y() / q.z()))
            << v << " " << i;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 300);
}

TEST_F(CudaPlaneSearchTest, ChangesNothingWithoutSources) {
  for (const int views : {1, 2}) {
    StereoScene scene = Scene(views);
    for (StereoView& view : scene.views) view.neighbors.clear();
    const std::vector<PlaneMap> start = Start(scene), gpu = OnGpu(scene, start, {{2, 0, false}, {1, 1, true}});
    ASSERT_EQ(gpu.size(), start.size());
    for (size_t v = 0; v < gpu.size(); ++v) EXPECT_EQ(Agreement(gpu[v], start[v]), 1);
  }
  const StereoScene nothing;
  EXPECT_TRUE(OnGpu(nothing, {}, {{1, 0, true}}).empty());
}

TEST_F(CudaPlaneSearchTest, AcceptsSeveralLevels) {
  const auto search = MakeCudaPlaneSearch(0);
  for (const int width : {24, 40, 16}) {
    const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(2, 8, width, 20)), kSteepRange);
    const std::vector<PlaneMap> start = Start(scene);
    const std::vector<PlaneMap> gpu = Search(search.get(), scene, start, {{1, 0, false}});
    const std::vector<PlaneMap> cpu = OnCpu(scene, start, {{1, 0, false}});
    for (size_t v = 0; v < 2; ++v) EXPECT_GT(Agreement(gpu[v], cpu[v]), kAgreeing) << width << " " << v;
  }
}

TEST_F(CudaPlaneSearchTest, FindsDepthOfCpu) {
  const std::vector<LoadedView> views = TakeAll(kSteep, Arc(3, 8, 64, 48));
  StereoOptions options;
  options.iterations = 3;
  options.geometric_passes = 1;
  const std::vector<DepthMap> gpu = EstimateDepth(views, {}, options, MakeCudaPlaneSearch(0).get(), Silent()),
                              cpu = EstimateDepth(views, {}, options, MakePlaneSearch(kCpu).get(), Silent());
  ASSERT_EQ(gpu.size(), 3u);
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_GT(ConfidentShare(gpu[v]), 0.6) << v;
    EXPECT_NEAR(ConfidentShare(gpu[v]), ConfidentShare(cpu[v]), 0.03) << v;
  }
}

TEST_F(CudaPlaneSearchTest, RefusesWrongShapesAndMissingGpu) {
  const auto search = MakeCudaPlaneSearch(0);
  StereoScene scene = Scene(2);
  std::vector<PlaneMap> start = Start(scene);
  EXPECT_THROW(search->BeginLevel(scene, {start[0]}), ShapeError);
  start[1].costs.pop_back();
  EXPECT_THROW(search->BeginLevel(scene, start), ShapeError);
  start = Start(scene);
  scene.views[1].image.channels.resize(2, scene.views[1].image.channels[0]);
  EXPECT_THROW(search->BeginLevel(scene, start), ShapeError);
  EXPECT_THROW(MakeCudaPlaneSearch(1000), UsageError);
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST_F(CudaPlaneSearchTest, AllocatesNothingInPass) {
  const StereoScene scene = Scene();
  const auto search = MakeCudaPlaneSearch(0);
  search->BeginLevel(scene, Start(scene));
  const emulated_cuda::Counts before = emulated_cuda::CountCalls();
  search->BeginPass({2, 0, true});
  for (size_t v = 0; v < 3; ++v) search->Improve(v);
  const emulated_cuda::Counts after = emulated_cuda::CountCalls();
  EXPECT_EQ(after.allocations, before.allocations);
  EXPECT_EQ(after.waits - before.waits, 3);
}

TEST_F(CudaPlaneSearchTest, ReportsOutOfMemoryAndRecovers) {
  const StereoScene scene = Scene();
  const std::vector<PlaneMap> start = Start(scene);
  const auto search = MakeCudaPlaneSearch(0);
  const DeviceMemory memory = MemoryOfDevice();
  emulated_cuda::SetMemory(static_cast<size_t>(memory.total - memory.free) + 4 * 3 * kSearchWidth * kSearchHeight);
  std::string what;
  try {
    search->BeginLevel(scene, start);
  } catch (const OutOfMemory& error) {
    what = error.what();
  }
  emulated_cuda::SetMemory(size_t{1} << 40);
  EXPECT_THAT(what, testing::AllOf(testing::HasSubstr("for stereo's planes"), testing::HasSubstr("--downscale")));
  EXPECT_GT(Agreement(Search(search.get(), scene, start, {{1, 0, false}})[0], OnCpu(scene, start, {{1, 0, false}})[0]),
            kAgreeing);
}
#endif

}  // namespace
}  // namespace oraclegs::cuda

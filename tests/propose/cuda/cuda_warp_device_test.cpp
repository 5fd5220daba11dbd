#include "oraclegs/propose/warp_device.h"

#include <gmock/gmock.h>

#include <thread>

#include "depth/surfaces.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/propose/warp.h"
#include "support/cuda_device.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs::cuda {
namespace {

constexpr int kWarpWidth = 32, kWarpHeight = 24;
constexpr double kFlipped = kEmulatedCuda ? 0 : 0.02;  // of the pixels: where rounding decides, one device may differ

/// A square before a wall; neither reaches the images' edges, and their depth has holes.
class CudaWarpTest : public CudaTest {
 protected:
  CudaWarpTest() {
    near.half_side = 0.5, near.point = {0, 0, -1.5};
    far.half_side = 2.2, far.point = {0, 0, 1.5};
    Show(Arc(4, 8, kWarpWidth, kWarpHeight));
  }

  void Show(const std::vector<Camera>& cameras) {
    views.clear(), maps.clear();
    for (const Camera& camera : cameras) {
      views.push_back(far.Take(camera, "p"));
      maps.push_back(TrueDepth(views.back(), far, 0.9f));
      const LoadedView front = near.Take(camera, "p");
      for (size_t i = 0; i < maps.back().size(); ++i) {
        const size_t x = i % static_cast<size_t>(camera.width), y = i / static_cast<size_t>(camera.width);
        const double depth = near.DepthAt(camera, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
        if (depth > 0) {
          std::copy_n(&front.rgb.data[3 * i], 3, &views.back().rgb.data[3 * i]);
          maps.back().inv_depth[i] = static_cast<float>(1 / depth);
        }
        Disturb(&maps.back(), i);
      }
    }
  }
  void Disturb(DepthMap* map, size_t i) {
    map->confidence[i] *= static_cast<float>(rng.Uniform());
    if (rng.Uniform() < 0.3) map->inv_depth[i] *= static_cast<float>(rng.Uniform(0.9, 1.1));
    if (rng.Uniform() < 0.1) map->inv_depth[i] = map->confidence[i] = 0;
  }

  WarpSources Sources() const { return {views, maps}; }

  static size_t Differing(const std::vector<float>& a, const std::vector<float>& b, float tolerance) {
    size_t n = a.size() == b.size() ? 0 : a.size() + b.size();
    for (size_t i = 0; n <= a.size() && i < a.size(); ++i) {
      n += !(std::abs(a[i] - b[i]) <= tolerance * std::max(1.f, std::abs(b[i])));
    }
    return n;
  }
  static std::vector<float> Numbers(const std::vector<PixelEvidence>& evidence) {
    std::vector<float> numbers;
    for (const PixelEvidence& e : evidence) {
      numbers.insert(numbers.end(), {e.support, e.views, e.angle, e.spread, e.confidence, e.conflicts, e.occluded,
                                     e.ring, e.resolution, e.background});
    }
    return numbers;
  }

  static WarpedView Warped(const WarpSources& sources, const Camera& camera, std::optional<int> held_out = std::nullopt,
                           int64_t listed = kListedSamples) {
    return Warper(sources, MakeCudaWarpDevice(sources, 0, listed)).Warp(camera, held_out);
  }
  static void ExpectTheCpus(const WarpedView& actual, const WarpSources& sources, const Camera& camera,
                            std::optional<int> held_out = std::nullopt) {
    const WarpedView expected = Warper(sources).Warp(camera, held_out);
    const auto flips = static_cast<size_t>(kFlipped * static_cast<double>(expected.inv_depth.size()));
    EXPECT_LE(Differing(actual.inv_depth, expected.inv_depth, 1e-5f), flips);
    EXPECT_LE(Differing(actual.rgb.data, expected.rgb.data, 1e-4f), 6 * flips);  // holes beside one differ, too
    EXPECT_LE(Differing(Numbers(actual.evidence), Numbers(expected.evidence), 1e-3f), 10 * flips);
    size_t others = 0;
    for (size_t i = 0; i < expected.provenance.size(); ++i) others += actual.provenance[i] != expected.provenance[i];
    EXPECT_LE(others, flips);
  }

  TexturedPlane near, far;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  Rng rng{3, RandomStream::kInitialPoints};
  const Camera between = CameraAt({0.3, 0, -4}, {0, 0, 0}, kWarpWidth, kWarpHeight);
  const Camera aside = CameraAt({2.6, 0, -3}, {0, 0, 0}, 28, 20);
};

TEST_F(CudaWarpTest, MatchesCpu) {
  for (const Camera& camera : {between, aside}) ExpectTheCpus(Warped(Sources(), camera), Sources(), camera);
}

TEST_F(CudaWarpTest, HoldsViewOut) {
  ExpectTheCpus(Warped(Sources(), views[1].camera, 1), Sources(), views[1].camera, 1);
}

TEST_F(CudaWarpTest, MatchesCpuNearAndFar) {
  const Camera close = CameraAt({0.1, 0, -2.2}, {0, 0, 0}, kWarpWidth, kWarpHeight);  // a depth falls on many pixels
  const Camera distant = CameraAt({0, 1, -30}, {0, 0, 0}, 16, 12);                    // many depths fall on one
  for (const Camera& camera : {close, distant}) ExpectTheCpus(Warped(Sources(), camera), Sources(), camera);
}

TEST_F(CudaWarpTest, MatchesCpuWithMasksAndGains) {
  for (LoadedView& source_view : views) {
    source_view.mask.resize(size_t{kWarpWidth} * kWarpHeight);
    for (uint8_t& counts : source_view.mask) counts = rng.Uniform() < 0.8;
  }
  views[2].mask.clear();
  WarpSources sources = Sources();
  sources.gains = {{0.9f, 1, 1.1f}, {1, 1, 1}, {0.5f, 0.6f, 0.7f}, {1.2f, 1.2f, 1.3f}};
  ExpectTheCpus(Warped(sources, between), sources, between);
}

TEST_F(CudaWarpTest, MatchesCpuBesideObject) {
  TexturedPlane square;
  square.half_side = 0.7;
  views = TakeAll(square, Arc(4, 14, kWarpWidth, kWarpHeight));
  maps.clear();
  for (const LoadedView& source_view : views) maps.push_back(TrueDepth(source_view, square, 0.9f));
  const Silhouettes silhouettes(views);
  ASSERT_FALSE(silhouettes.empty());
  const WarpSources sources{views, maps, {}, &silhouettes, {1, 1, 1}};
  const WarpedView view = Warped(sources, between);
  EXPECT_EQ(view.evidence[0].background, 1.f);
  EXPECT_EQ(view.evidence[kWarpHeight / 2 * kWarpWidth + kWarpWidth / 2].background, 0.f);
  ExpectTheCpus(view, sources, between);
}

TEST_F(CudaWarpTest, ShowsBackgroundWithoutDepth) {
  const Camera away = CameraAt({0, 0, -4}, {0, 0, -9}, 24, 16);
  WarpSources sources = Sources();
  sources.background = {0.25f, 0.5f, 0.75f};
  const WarpedView view = Warped(sources, away);
  EXPECT_EQ(view.inv_depth, std::vector<float>(24 * 16, 0.f));
  ExpectTheCpus(view, sources, away);
}

TEST_F(CudaWarpTest, AcceptsOneAndNoView) {
  Show({views[0].camera});
  ExpectTheCpus(Warped(Sources(), between), Sources(), between);
  ExpectTheCpus(Warped(Sources(), views[0].camera, 0), Sources(), views[0].camera, 0);
  maps.clear();  // a run without depth
  ExpectTheCpus(Warped(Sources(), between), Sources(), between);
}

TEST_F(CudaWarpTest, AcceptsManyViewsOfTwoSizes) {
  std::vector<Camera> cameras = Arc(40, 1, 8, 6);
  cameras.push_back(views[0].camera);
  Show(cameras);
  ExpectTheCpus(Warped(Sources(), aside), Sources(), aside);
}

TEST_F(CudaWarpTest, GivesSameBitsForAnyBands) {
  const WarpedView whole = Warped(Sources(), aside);
  for (const int64_t listed : {1, 37, 1000}) {
    const WarpedView banded = Warped(Sources(), aside, std::nullopt, listed);
    EXPECT_EQ(banded.inv_depth, whole.inv_depth) << listed;
    EXPECT_EQ(banded.rgb.data, whole.rgb.data) << listed;
    EXPECT_EQ(Numbers(banded.evidence), Numbers(whole.evidence)) << listed;
  }
}

TEST_F(CudaWarpTest, IsThreadSafe) {
  const WarpSources sources = Sources();
  const Warper warper(sources, MakeCudaWarpDevice(sources, 0));
  std::vector<WarpedView> views(4);
  std::vector<std::thread> threads;
  for (size_t t = 0; t < views.size(); ++t) {
    threads.emplace_back([&, t] { views[t] = warper.Warp(t % 2 == 0 ? between : aside); });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(views[0].rgb.data, warper.Warp(between).rgb.data);
  EXPECT_EQ(views[3].rgb.data, warper.Warp(aside).rgb.data);
  EXPECT_EQ(views[2].rgb.data, views[0].rgb.data);
  EXPECT_EQ(views[1].rgb.data, views[3].rgb.data);
}

TEST_F(CudaWarpTest, RefusesMissingGpu) { EXPECT_THROW(MakeCudaWarpDevice(Sources(), 99), UsageError); }

#if defined(ORACLEGS_EMULATED_CUDA)
TEST_F(CudaWarpTest, ReportsOutOfMemory) {
  const auto says = [](const char* what) { return testing::ThrowsMessage<OutOfMemory>(testing::HasSubstr(what)); };
  const Warper warper(Sources(), MakeCudaWarpDevice(Sources(), 0));
  const DeviceMemory memory = MemoryOfDevice();
  emulated_cuda::SetMemory(static_cast<size_t>(memory.total - memory.free) + 1000);
  EXPECT_THAT([&] { Warped(Sources(), between); }, says("for the images that are warped"));
  const Camera large = CameraAt({0.3, 0, -4}, {0, 0, 0}, 2 * kWarpWidth, 2 * kWarpHeight);
  EXPECT_THAT([&] { warper.Warp(large); }, says("for the depths that fall on a new view's pixels"));
  ExpectTheCpus(warper.Warp(between), Sources(), between);  // and goes on: there is memory for such views
  emulated_cuda::SetMemory(size_t{1} << 40);
  ExpectTheCpus(warper.Warp(large), Sources(), large);
}
#endif

}  // namespace
}  // namespace oraclegs::cuda

#include "oraclegs/depth/pose_offsets.h"

#include <gtest/gtest.h>

#include "depth/disturbed.h"
#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxOffsetPixels = 300;

class PoseOffsetsTest : public testing::Test {
 protected:
  PoseOffsetsTest() { Take(Arc(4, 8, 160, 120)); }
  ~PoseOffsetsTest() override { SetNumThreads(threads_); }

  void Take(const std::vector<Camera>& at) {
    cameras = at;
    views = TakeAll(kSlanted, cameras);
    maps.clear();
    for (const LoadedView& view : views) maps.push_back(TrueDepth(view, kSlanted, 1));
  }

  /// Median distance between where patches are found and where the true cameras and depths put them.
  static double MedianError(const std::vector<Camera>& truth, const std::vector<OffsetPixel>& pixels,
                            const std::vector<PatchOffset>& offsets) {
    std::vector<double> errors;
    for (const PatchOffset& offset : offsets) {
      const OffsetPixel& pixel = pixels[static_cast<size_t>(offset.pixel)];
      const auto seen = Reproject(truth[static_cast<size_t>(pixel.view)], truth[static_cast<size_t>(offset.source)],
                                  {pixel.u, pixel.v, pixel.inv_depth});
      errors.push_back((offset.expected + offset.offset - seen->at).norm());
    }
    return Median(&errors);
  }

  std::vector<Camera> cameras;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;

 private:
  int threads_ = NumThreads();
};

TEST_F(PoseOffsetsTest, AreSmallForTruePoses) {
  const OffsetMeter meter(views, maps);
  const std::vector<OffsetPixel> pixels = meter.Choose(kMaxOffsetPixels);
  EXPECT_EQ(pixels.size(), 4 * kMaxOffsetPixels);
  const std::vector<PatchOffset> offsets = meter.Measure(cameras, pixels);
  EXPECT_GT(offsets.size(), 2 * pixels.size());
  EXPECT_LT(MedianError(cameras, pixels, offsets), 0.05);
  const AcrossResidual residual = ResidualAcross(pixels, offsets, cameras);
  EXPECT_LT(residual.all, 0.04);
  for (const double of_view : residual.views) EXPECT_LT(of_view, 0.05);
}

TEST_F(PoseOffsetsTest, FindPatchesPixelsAway) {
  const OffsetMeter meter(views, maps);
  const std::vector<OffsetPixel> pixels = meter.Choose(kMaxOffsetPixels);
  const std::vector<Camera> wrong = Disturbed(cameras, 0.8, 0.02, 3);
  const std::vector<PatchOffset> offsets = meter.Measure(wrong, pixels);
  EXPECT_GT(offsets.size(), pixels.size());
  EXPECT_LT(MedianError(cameras, pixels, offsets), 0.1);
  EXPECT_GT(ResidualAcross(pixels, offsets, cameras).all, 0.5);
}

TEST_F(PoseOffsetsTest, AreDepthAlongTheEpipolarLine) {
  const OffsetMeter meter(views, maps);
  std::vector<OffsetPixel> pixels = meter.Choose(kMaxOffsetPixels);
  for (OffsetPixel& pixel : pixels) pixel.inv_depth *= 1.02;
  const std::vector<PatchOffset> offsets = meter.Measure(cameras, pixels);
  std::vector<double> lengths;
  for (const PatchOffset& offset : offsets) lengths.push_back(offset.offset.norm());
  EXPECT_GT(Median(&lengths), 0.3);
  EXPECT_LT(ResidualAcross(pixels, offsets, cameras).all, 0.05);
}

TEST_F(PoseOffsetsTest, DoNotDependOnExposure) {
  for (float& value : views[1].rgb.data) value = 0.1f + 0.5f * value;
  const OffsetMeter meter(views, maps);
  const std::vector<OffsetPixel> pixels = meter.Choose(kMaxOffsetPixels);
  const std::vector<PatchOffset> offsets = meter.Measure(cameras, pixels);
  EXPECT_LT(ResidualAcross(pixels, offsets, cameras).views[1], 0.06);
}

TEST_F(PoseOffsetsTest, NeedTextureInTwoDirections) {
  for (LoadedView& view : views) {
    for (int y = 0; y < view.rgb.height; ++y) {
      for (int i = 0; i < 3 * view.rgb.width; ++i) view.rgb.row(y)[i] = view.rgb.row(0)[i];  // stripes
    }
  }
  EXPECT_TRUE(OffsetMeter(views, maps).Choose(kMaxOffsetPixels).empty());
}

TEST_F(PoseOffsetsTest, NeedConfidentDepthOnASurface) {
  for (float& confidence : maps[0].confidence) confidence = 0.4f;
  for (size_t i = 0; i < maps[1].size(); ++i) maps[1].inv_depth[i] *= i % 2 == 0 ? 1.f : 1.2f;
  for (const OffsetPixel& pixel : OffsetMeter(views, maps).Choose(kMaxOffsetPixels)) EXPECT_GE(pixel.view, 2);
}

TEST_F(PoseOffsetsTest, LeaveOutWhatTheSourceViewDoesNotShow) {
  const OffsetMeter all(views, maps);
  const std::vector<OffsetPixel> pixels = all.Choose(kMaxOffsetPixels);
  for (float& inv_depth : maps[1].inv_depth) inv_depth *= 2;  // something nearer
  const OffsetMeter meter(views, maps);
  for (const PatchOffset& offset : meter.Measure(cameras, pixels)) {
    EXPECT_NE(offset.source, 1);
    EXPECT_NE(pixels[static_cast<size_t>(offset.pixel)].view, 1);
  }
}

TEST_F(PoseOffsetsTest, AreNoneBetweenViewsFromOnePlace) {
  Take({cameras[0], cameras[0]});
  const OffsetMeter meter(views, maps);
  EXPECT_TRUE(meter.Choose(kMaxOffsetPixels).empty());
  EXPECT_EQ(ResidualAcross({}, {}, cameras).all, 0);
  EXPECT_EQ(ResidualAcross({}, {}, cameras).views, std::vector<double>({0, 0}));
  EXPECT_EQ(ResidualAcross({}, {}, cameras).cells, 0u);
}

TEST_F(PoseOffsetsTest, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<PatchOffset> offsets[2];
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    const OffsetMeter meter(views, maps);
    offsets[threads / 2] = meter.Measure(Disturbed(cameras, 0.3, 0.01, 1), meter.Choose(kMaxOffsetPixels));
  }
  ASSERT_EQ(offsets[0].size(), offsets[1].size());
  for (size_t k = 0; k < offsets[0].size(); ++k) {
    EXPECT_EQ(offsets[0][k].pixel, offsets[1][k].pixel);
    EXPECT_EQ(offsets[0][k].offset, offsets[1][k].offset);
    EXPECT_EQ(offsets[0][k].across, offsets[1][k].across);
  }
}

}  // namespace
}  // namespace oraclegs

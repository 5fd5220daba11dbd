#include "oraclegs/networks/seva/cameras.h"

#include "networks/seva/sampling_fixture.h"

namespace oraclegs::seva {
namespace {

Tensor PosesOf(const std::vector<View>& views) {
  const Tensor out = torch::empty({static_cast<int64_t>(views.size()), 4, 4}, torch::kDouble);
  double* next = out.data_ptr<double>();
  for (const View& view : views) {
    for (int i = 0; i < 16; ++i) *next++ = view.world_from_camera.matrix()(i / 4, i % 4);
  }
  return out;
}

class SevaCameraNorm : public testing::TestWithParam<const char*> {};

TEST_P(SevaCameraNorm, MatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const std::string name = GetParam();
  const std::vector<View> all = GoldenViews(file, name + ".all_c2w");
  const std::vector<View> chunk = GoldenViews(file, name + ".curr_c2w", name + ".curr_K");
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : all) centers.push_back(view.center());
  const SceneMiddle middle = FindSceneMiddle(centers);
  const std::vector<double> median = file.Values<double>(name + ".lower_median");
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(middle.median[axis], median[static_cast<size_t>(axis)], 1e-4);
  const double quantile = file.Values<double>(name + ".quantile97").at(0);
  EXPECT_NEAR(middle.quantile, quantile, 1e-4 * quantile);
  EXPECT_EQ(middle.valid, GoldenMask(file, name + ".valid"));
  const std::vector<View> views = NormalizedViews(chunk, all);
  ExpectRatio(PosesOf(views), GoldenTensor(file, name + ".out_c2w"), 1e-4, "poses");
  const Tensor expected = GoldenTensor(file, name + ".out_plucker");
  ExpectRatio(PlueckerMaps(views, expected.size(2), expected.size(3)), expected, 1e-4, "rays");
}

INSTANTIATE_TEST_SUITE_P(Scenes, SevaCameraNorm, testing::Values("camnorm", "camnorm_zero"));

TEST(SevaCameras, RaysMatchTheOfficialOnes) {
  const SafetensorsFile file = SamplingFixture();
  std::vector<View> views = GoldenViews(file, "plucker.w2c", "plucker.K_normalized");
  for (View& view : views) view.world_from_camera = view.world_from_camera.inverse();
  const std::vector<int64_t> size = file.Values<int64_t>("plucker.size_hw");
  ExpectRatio(PlueckerMaps(views, size.at(0), size.at(1)), GoldenTensor(file, "plucker.out"), 1e-4, "rays");
}

TEST(SevaCameras, TheFirstCameraHasNoMoments) {
  const std::vector<View> views = GoldenViews(SamplingFixture(), "plucker.w2c", "plucker.K_normalized");
  const Tensor rays = PlueckerMaps(views, 4, 5);
  EXPECT_LE(rays[0].slice(0, 3).abs().max().item<double>(), 1e-6);
  EXPECT_LE(MaxAbsError(rays.slice(1, 0, 3).norm(2, 1), torch::ones({static_cast<int64_t>(views.size()), 4, 5})), 1e-6);
}

TEST(SevaCameras, RefusesEmptyLists) {
  EXPECT_THROW(FindSceneMiddle({}), ShapeError);
  EXPECT_THROW(NormalizedViews({}, {View{}}), ShapeError);
  EXPECT_THROW(PlueckerMaps({}, 4, 4), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva

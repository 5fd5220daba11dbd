#include "oraclegs/networks/lpips/lpips.h"

#include "networks/golden_tensors.h"
#include "networks/network_files.h"
#include "oraclegs/networks/common/tensor.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

constexpr int64_t kCache = int64_t{1} << 30;

class PerceptualNetworkTest : public testing::Test {
 protected:
  void SetUp() override { torch::manual_seed(11); }

  std::unique_ptr<PerceptualNetwork> Make(int64_t cache_bytes = kCache) const {
    return MakePerceptualNetwork(LoadRecognizedLpips({file}), cache_bytes);
  }
  static Buffer<float> Random(int64_t height, int64_t width) { return BufferOf(torch::rand({height, width, 3})); }

  TempDir temp;
  std::filesystem::path file = MakeTinyLpips(temp / "lpips.safetensors");
  const Buffer<float> render = Random(30, 40), target = Random(30, 40);
};

TEST_F(PerceptualNetworkTest, LossIsTheScoreOfImagesAsTheyAreWithItsGradient) {
  const Lpips lpips = LoadRecognizedLpips({file});
  Tensor expected = torch::zeros({30, 40, 3});
  const LpipsTarget prepared = PrepareTarget(lpips, TensorOf(target), LpipsRange::kZeroOne);
  const double value = Distance(lpips, TensorOf(render), prepared, &expected).value;
  const auto network = Make();
  Buffer<float> grad = Buffer<float>::Full({30, 40, 3}, 1), none;
  EXPECT_EQ(network->Loss(render, target, 0.25, &grad), value);
  EXPECT_LT(MaxAbsError(TensorOf(grad), 1 + 0.25 * expected), 1e-7) << "adds to what is there";
  EXPECT_EQ(network->Loss(render, target, 1, nullptr), value);
  EXPECT_EQ(network->Loss(render, target, 1, &none), value);
  EXPECT_EQ(network->Score(render, target, LpipsRange::kZeroOne), value);
}

TEST_F(PerceptualNetworkTest, ScoresBothRanges) {
  const Lpips lpips = LoadRecognizedLpips({file});
  for (const LpipsRange range : {LpipsRange::kZeroOne, LpipsRange::kMinusOneOne}) {
    EXPECT_EQ(Make()->Score(render, target, range),
              Distance(lpips, TensorOf(render), PrepareTarget(lpips, TensorOf(target), range)).value);
  }
}

TEST_F(PerceptualNetworkTest, KeptFeaturesChangeNothing) {
  const Buffer<float> other = Random(24, 30), small = Random(24, 30);
  const auto kept = Make(), anew = Make(0);
  for (int round = 0; round < 2; ++round) {
    Buffer<float> a = Buffer<float>::Zeros(render.shape()), b = Buffer<float>::Zeros(render.shape());
    EXPECT_EQ(kept->Loss(render, target, 1, &a), anew->Loss(render, target, 1, &b));
    EXPECT_TRUE(std::equal(a.span().begin(), a.span().end(), b.data()));
    EXPECT_EQ(kept->Loss(small, other, 1, nullptr), anew->Loss(small, other, 1, nullptr));
  }
  // Beyond the cache's size, too, and where a target was kept and another comes in another size to the same place.
  const auto little = Make(30 * 40 * 4 * 10);
  EXPECT_EQ(little->Loss(render, target, 1, nullptr), anew->Loss(render, target, 1, nullptr));
  EXPECT_EQ(little->Loss(small, other, 1, nullptr), anew->Loss(small, other, 1, nullptr));
  const Buffer<float> part = target.Rows(0, 20);
  EXPECT_EQ(kept->Loss(render.Rows(0, 20), part, 1, nullptr), anew->Loss(render.Rows(0, 20), part, 1, nullptr));
}

TEST_F(PerceptualNetworkTest, SaysWhichNetworkItIs) {
  EXPECT_EQ(Make()->name(), "VGG16");
  EXPECT_EQ(Make()->smallest_side(), 16);
  const auto alex = MakeTinyLpips(temp / "alex.safetensors", 7, FeatureNetwork::kAlexNet);
  EXPECT_EQ(MakePerceptualNetwork(LoadRecognizedLpips({alex}), 0)->name(), "AlexNet");
}

}  // namespace
}  // namespace oraclegs

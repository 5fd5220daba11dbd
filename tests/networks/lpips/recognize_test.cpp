#include <gmock/gmock.h>

#include "networks/network_files.h"
#include "oraclegs/networks/lpips/lpips.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(RecognizeLpips, KnowsNetworkAndWidths) {
  const TempDir dir;
  for (const FeatureNetwork network : {FeatureNetwork::kVgg16, FeatureNetwork::kAlexNet}) {
    const auto path = MakeTinyLpips(dir / "lpips.safetensors", 7, network);
    const FeatureStackConfig config = RecognizeLpips({path});
    EXPECT_EQ(config.network, network);
    EXPECT_EQ(config.channels, (std::array<int64_t, 5>{4, 6, 8, 10, 12}));
    const Lpips lpips = LoadRecognizedLpips({path});
    torch::manual_seed(3);
    const Tensor a = torch::rand({40, 50, 3}), b = torch::rand({40, 50, 3});
    EXPECT_GT(Distance(lpips, a, PrepareTarget(lpips, b, LpipsRange::kZeroOne)).value, 0);
  }
}

TEST(RecognizeLpips, FeaturesAndLinearWeightsMayStandInTwoFiles) {
  const TempDir dir;
  const auto whole = MakeTinyLpips(dir / "lpips.safetensors");
  const SafetensorsFile file = SafetensorsFile::Open(whole);
  std::map<std::string, TensorEntry> features, linear;
  for (const auto& [name, entry] : file.tensors()) (name.starts_with("lin") ? linear : features)[name] = entry;
  WriteFileAtomically(dir / "a.safetensors", SerializeSafetensors(features, {}));
  WriteFileAtomically(dir / "b.safetensors", SerializeSafetensors(linear, {}));
  EXPECT_NO_THROW(LoadRecognizedLpips({dir / "a.safetensors", dir / "b.safetensors"}));
  EXPECT_THAT([&] { LoadRecognizedLpips({dir / "a.safetensors"}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("a.safetensors: is no LPIPS"),
                                              HasSubstr("no lin0.model.1.weight with 4 dimensions"))));
}

TEST(RecognizeLpips, SaysWhatIsWrongWithAnotherFile) {
  const TempDir dir;
  KeptParameters parameters(1);
  parameters.Get("features.0.weight", {4, 3, 7, 7});
  const auto path = parameters.Write(dir / "other.safetensors");
  EXPECT_THAT([&] { RecognizeLpips({path}); },
              ThrowsMessage<InputError>(HasSubstr("its first convolution is 7 pixels wide")));
  KeptParameters wider(1);
  LoadLpips(wider, {FeatureNetwork::kVgg16, {4, 6, 8, 10, 12}});
  wider.Get("lin3.model.1.weight", {1, 11, 1, 1});
  wider.Write(path);
  EXPECT_THAT(
      [&] { LoadRecognizedLpips({path}); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("does not hold LPIPS with VGG16; of another shape"),
                                      HasSubstr("features.17.weight is [10, 8, 3, 3], expected [11, 8, 3, 3]"))));
}

}  // namespace
}  // namespace oraclegs

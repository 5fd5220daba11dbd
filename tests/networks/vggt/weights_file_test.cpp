#include "oraclegs/networks/vggt/weights_file.h"

#include "networks/vggt/fixture.h"
#include "support/temp_dir.h"

namespace oraclegs::vggt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(ReadWeightsFile, SizesAreThoseOfTheMetadata) {
  const WeightsFile file = ReadWeightsFile(GoldenVggtPath());
  EXPECT_EQ(file.name, "VGGT-1B");
  EXPECT_EQ(file.network.aggregator.width(), 64);
  EXPECT_EQ(file.network.aggregator.depth, 4);
  EXPECT_EQ(file.network.aggregator.backbone.depth, 3);
  EXPECT_EQ(file.network.aggregator.backbone.position_grid, 5);
  EXPECT_EQ(file.network.camera.depth, 2);
  EXPECT_EQ(file.network.dense.channels, (std::array<int64_t, 4>{16, 32, 48, 64}));
  EXPECT_EQ(file.side, 70);
  EXPECT_EQ(file.oracle_layers, (std::vector<int64_t>{0, 2}));
  EXPECT_EQ(file.oracle_weights, (std::vector<double>{0.25, 0.75}));
}

TEST(ReadWeightsFile, WithoutSizesItIsThePublishedNetwork) {
  const TempDir dir;
  const WeightsFile file = ReadWeightsFile(WriteTinyVggt(dir / "a.st", [](TinyVggtParts* parts) {
    parts->tensors.erase(std::next(parts->tensors.begin()), parts->tensors.end());
    parts->metadata = {{"model", "VGGT-1B-\nCommercial"}};
  }));
  EXPECT_EQ(file.name, "VGGT-1B-?Commercial");
  EXPECT_EQ(file.network.aggregator.width(), 1024);
  EXPECT_EQ(file.side, 518);
  EXPECT_EQ(file.oracle_layers, (std::vector<int64_t>{0, 22}));
}

TEST(ReadWeightsFile, TheWholeFileLoads) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "a.st");
  const Vggt vggt = LoadVggt({path}, {true, true}, {}, ReadWeightsFile(path).network);
  EXPECT_EQ(vggt.aggregator.global_blocks.size(), 4u);
}

TEST(ReadWeightsFile, TensorsThatDoNotFitAreListedInOneError) {
  const TempDir dir;
  const auto path = WriteTinyVggt(dir / "a.st", [](TinyVggtParts* parts) {
    parts->tensors["aggregator.stray"] = parts->tensors.at("aggregator.camera_token");
    parts->tensors["aggregator.camera_token"] = parts->tensors.at("aggregator.register_token");
    parts->tensors.erase("aggregator.frame_blocks.1.norm1.weight");
  });
  EXPECT_THAT([&] { LoadVggt({path}, {}, {}, ReadWeightsFile(path).network); },
              ThrowsMessage<InputError>(AllOf(StartsWith(path.string()),
                                              HasSubstr("missing 1: aggregator.frame_blocks.1.norm1.weight"),
                                              HasSubstr("not part of it 1: aggregator.stray"),
                                              HasSubstr("of another shape 1: aggregator.camera_token is"))));
}

TEST(ReadWeightsFile, SizesThatCannotBeAreRefused) {
  struct Wrong {
    const char *key, *value, *says;
  };
  const TempDir dir;
  for (const Wrong& wrong :
       {Wrong{"depth", "four", "'depth' of its metadata are no numbers"}, Wrong{"depth", "4.5", "is no size"},
        Wrong{"depth", "0", "is no size"}, Wrong{"depth", "1e9", "is no size"}, Wrong{"depth", "[4, 4]", "is not one"},
        Wrong{"rope_freq", "[1, 2]", "is not one number"}, Wrong{"dpt_layers", "[0, 1]", "are not four numbers"},
        Wrong{"num_heads", "3", "does not divide"}, Wrong{"dino_num_heads", "3", "does not divide"},
        Wrong{"camera_num_heads", "5", "does not divide"}, Wrong{"img_size", "7", "is smaller than a patch"},
        Wrong{"dpt_features", "30", "is no multiple of 8"}, Wrong{"dpt_layers", "[0, 1, 2, 4]", "is not there"},
        Wrong{"dpt_out_channels", "[16, 32, 48, 62]", "are no multiples of 4"},
        Wrong{"oracle_layers", "[0, 4]", "is not there"}, Wrong{"oracle_weights", "[1]", "are not one share"},
        Wrong{"oracle_weights", "[0.5, 0.6]", "are not one share"},
        Wrong{"oracle_weights", "[nan, 1]", "no numbers"}}) {
    const auto path =
        WriteTinyVggt(dir / "a.st", [&](TinyVggtParts* parts) { parts->metadata[wrong.key] = wrong.value; });
    EXPECT_THAT([&] { ReadWeightsFile(path); },
                ThrowsMessage<InputError>(AllOf(StartsWith(path.string()), HasSubstr(wrong.says), HasSubstr("again"))))
        << wrong.key << " = " << wrong.value;
  }
  const auto path = WriteTinyVggt(dir / "a.st", [](TinyVggtParts* parts) { parts->metadata.erase("dpt_features"); });
  EXPECT_THAT([&] { ReadWeightsFile(path); }, ThrowsMessage<InputError>(HasSubstr("has no 'dpt_features'")));
}

}  // namespace
}  // namespace oraclegs::vggt

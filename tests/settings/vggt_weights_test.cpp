#include "oraclegs/settings/vggt_weights.h"

#include <cstring>

#include "run/weights.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(VggtWeights, AreWhereTheyWereFetchedOrNamed) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  EXPECT_FALSE(FindVggtWeights("").has_value());
  WriteTinyVggt(dir / "models" / "vggt" / "model.safetensors");
  const auto found = FindVggtWeights("");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->path, dir / "models" / "vggt" / "model.safetensors");
  EXPECT_EQ(found->name, "VGGT-1B");
  EXPECT_EQ(found->layers, 4);
  EXPECT_FALSE(found->commercial);
  WriteTinyVggt(dir / "models" / "vggt-commercial" / "model.safetensors");
  EXPECT_TRUE(FindVggtWeights("")->commercial);
  EXPECT_EQ(FindVggtWeights("")->name, "VGGT-1B-Commercial");
  EXPECT_FALSE(FindVggtWeights(WriteTinyVggt(dir / "named.safetensors"))->commercial);
}

TEST(VggtWeights, AFileMayBeMarkedCommercial) {
  const TempDir dir;
  const auto path =
      WriteTinyVggt(dir / "a.safetensors", [](TinyVggtParts* parts) { parts->metadata["model"] = "vggt-commercial"; });
  EXPECT_TRUE(FindVggtWeights(path)->commercial);
}

TEST(VggtWeights, AreToldApartByTheirContent) {
  const TempDir dir;
  const auto a = FindVggtWeights(WriteTinyVggt(dir / "a.safetensors"));
  EXPECT_EQ(FindVggtWeights(WriteTinyVggt(dir / "b.safetensors"))->fingerprint, a->fingerprint);
  static const std::vector<char> zeros(1 << 20, '\0');
  const auto other = WriteTinyVggt(dir / "c.safetensors", [](TinyVggtParts* parts) {
    TensorEntry& entry = parts->tensors.at("aggregator.camera_token");
    entry.bytes = std::string_view(zeros.data(), entry.bytes.size());
  });
  EXPECT_NE(FindVggtWeights(other)->fingerprint, a->fingerprint);
}

TEST(VggtWeights, MissingOnesAreToldWithWhatBringsThem) {
  const TempDir dir;
  const ModelsAt models(dir / "models");
  EXPECT_THAT(MessageOf<InputError>([&] { RequireVggtWeights("", "--oracle vggt"); }),
              AllOf(StartsWith((dir / "models" / "vggt" / "model.safetensors").string()),
                    HasSubstr("--oracle vggt needs the weights of VGGT"), HasSubstr("`oraclegs models fetch vggt`"),
                    HasSubstr("--vggt-weights")));
  EXPECT_THAT(MessageOf<InputError>([&] { FindVggtWeights(dir / "none.safetensors"); }),
              AllOf(HasSubstr("none.safetensors: there is no such file"), HasSubstr("--vggt-weights")));
  WriteText(dir / "bad.safetensors", "no safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { FindVggtWeights(dir / "bad.safetensors"); }), HasSubstr("bad.safetensors"));
}

TEST(VggtWeights, LieInTheCacheOfTheHomeFolderByDefault) {
  const TempDir dir;
  const ModelsAt nowhere("");
  const EnvironmentVariable home("HOME", dir.path().string());
  WriteTinyVggt(dir / ".cache" / "oraclegs" / "vggt" / "model.safetensors");
  EXPECT_TRUE(FindVggtWeights("").has_value());
}

}  // namespace
}  // namespace oraclegs

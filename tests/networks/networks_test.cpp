#include "oraclegs/networks/networks.h"

#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class DepthNetworkNameTest : public testing::Test {
 protected:
  std::string NameOf(std::vector<int64_t> positions) {
    int64_t numbers = 1;
    for (const int64_t size : positions) numbers *= size;
    const std::string bytes(static_cast<size_t>(4 * numbers), '\0');
    WriteFileAtomically(dir / "weights.safetensors",
                        SerializeSafetensors({{"pretrained.pos_embed", {"F32", std::move(positions), bytes}}}, {}));
    return DepthNetworkName(dir / "weights.safetensors");
  }
  TempDir dir;
};

TEST_F(DepthNetworkNameTest, FollowsTheWidth) {
  EXPECT_EQ(NameOf({1, 5, 384}), "Depth Anything V2 small");
  EXPECT_EQ(NameOf({1, 5, 768}), "Depth Anything V2 base");
  EXPECT_EQ(NameOf({1, 5, 1024}), "Depth Anything V2 large");
  EXPECT_EQ(NameOf({1, 5, 64}), "Depth Anything V2 of another size");
}

TEST_F(DepthNetworkNameTest, RefusesOtherFiles) {
  EXPECT_THAT(MessageOf<InputError>([&] {
                NameOf({5, 384});
              }),
              AllOf(HasSubstr("is no Depth Anything V2"), HasSubstr("no pretrained.pos_embed with 3 dimensions")));
}

}  // namespace
}  // namespace oraclegs

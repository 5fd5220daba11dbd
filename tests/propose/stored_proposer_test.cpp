#include "oraclegs/propose/stored_proposer.h"

#include "oraclegs/image/codecs.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Target StoredTarget(const std::string& name, int width) {
  Target target{name, {}};
  target.camera.width = width, target.camera.height = 3;
  return target;
}

TEST(StoredProposer, AnswersWithTheFilesOfItsSource) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36, 255)});
  const StoredProposer proposer(dir.path(), "seva");
  const auto proposal = proposer.Propose(StoredTarget("view", 4), std::nullopt);
  ASSERT_TRUE(proposal);
  EXPECT_EQ(proposal->source, "seva");
  EXPECT_EQ(proposal->rgb.data, std::vector<float>(36, 1.f));
  EXPECT_FALSE(proposer.Propose(StoredTarget("other", 4), std::nullopt));
  EXPECT_FALSE(StoredProposer(dir.path(), "command").Propose(StoredTarget("view", 4), std::nullopt));
}

TEST(StoredProposer, CannotHoldAViewOut) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36)});
  EXPECT_FALSE(StoredProposer(dir.path(), "seva").Propose(StoredTarget("view", 4), 2));
}

TEST(StoredProposer, RefusesAnImageOfAnotherSize) {
  const TempDir dir;
  WritePng(dir / "seva" / "view.png", Image8{4, 3, 3, std::vector<uint8_t>(36)});
  EXPECT_THAT(
      MessageOf<InputError>([&] { StoredProposer(dir.path(), "seva").Propose(StoredTarget("view", 5), std::nullopt); }),
      testing::HasSubstr("is 4 x 3 with 3 channels, not 5 x 3"));
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/workspace/non_commercial.h"

#include "run/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(NonCommercial, StagesNoteTheirNetworksOnce) {
  nlohmann::json record = {{"key", "a"}};
  NoteNetwork({"f", "VGGT-1B-Commercial", "0", true}, &record);
  EXPECT_FALSE(record.contains("non_commercial"));
  NoteNetwork({"f", "VGGT-1B", "0", false}, &record);
  NoteNonCommercial("SEVA", &record);
  NoteNonCommercial("SEVA", &record);
  EXPECT_EQ(record.at("non_commercial"), nlohmann::json({"VGGT-1B", "SEVA"}));
}

TEST(NonCommercial, PartsAreThoseOfAllStages) {
  const TempDir temp;
  const WorkspacePaths paths(temp.path());
  EXPECT_THAT(NonCommercialParts(paths), IsEmpty());
  WriteText(paths.stages(), R"({"register": {"non_commercial": ["VGGT-1B"]}, "train": {"seconds": 1}, "odd": 3,
                                "validate": {"non_commercial": ["VGGT-1B"]}, "bad": {"non_commercial": "x"},
                                "propose": {"non_commercial": ["SEVA", 5]}})");
  EXPECT_THAT(NonCommercialParts(paths), ElementsAre("SEVA", "VGGT-1B"));
}

TEST(NonCommercial, CommentsSayItAndAreUnderstood) {
  const std::vector<std::string> comments = LicenseComments({"SEVA", "VGGT-1B"});
  EXPECT_THAT(comments,
              ElementsAre("not for commercial use: made with SEVA", "not for commercial use: made with VGGT-1B"));
  EXPECT_THAT(PartsInComments({"Created by somebody", comments[0], comments[1]}), ElementsAre("SEVA", "VGGT-1B"));
  EXPECT_THAT(LicenseComments({}), IsEmpty());
}

}  // namespace
}  // namespace oraclegs

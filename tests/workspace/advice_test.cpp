#include "oraclegs/workspace/advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class PhotoAdviceTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((temp / name).parent_path());
    WriteFileAtomically(temp / name, text);
  }

  TempDir temp;
};

TEST_F(PhotoAdviceTest, TakesRegistrationBeforeSupport) {
  Write("sfm/registration.json",
        R"({"views": [{"name": "a.jpg", "advice": null}, {"name": "b.jpg", "advice": "take it again"}]})");
  Write("report/run.json",
        R"({"registration": {"advice": [{"text": "between a.jpg and c.jpg", "view": 3}, {"text": "left of a.jpg"}]}})");
  EXPECT_THAT(PhotoAdvice(temp.path(), 2), ElementsAre("b.jpg: take it again", "between a.jpg and c.jpg"));
}

TEST_F(PhotoAdviceTest, IsSilentWithoutFiles) { EXPECT_THAT(PhotoAdvice(temp.path(), 3), IsEmpty()); }

TEST_F(PhotoAdviceTest, IgnoresDamage) {
  Write("sfm/registration.json", R"({"views": [1, {"advice": 7}, {"name": 3, "advice": "move"}]})");
  Write("report/run.json", "{");
  EXPECT_THAT(PhotoAdvice(temp.path(), 3), ElementsAre(": move"));
  Write("report/run.json", R"({"registration": null})");
  EXPECT_THAT(PhotoAdvice(temp.path(), 3), ElementsAre(": move"));
}

TEST_F(PhotoAdviceTest, RepeatsDoubtsOfPoses) {
  EXPECT_THAT(StoredPoseDoubts(temp.path()), IsEmpty());
  Write("sfm/registration.json", R"({"warnings": ["a.jpg is left out", "the poses are doubtful: all is flat", 7]})");
  EXPECT_THAT(StoredPoseDoubts(temp.path()), ElementsAre("the poses are doubtful: all is flat"));
}

}  // namespace
}  // namespace oraclegs

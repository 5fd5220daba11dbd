#include "oraclegs/workspace/saved_run.h"

#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

SavedRun SavedWith(const RunOptions& options, const nlohmann::json& size = {}) {
  return {"/scene", {}, RunOptionsToJson(options), size, 0};
}

TEST(AsksForMoreIterations, ComparesAllElse) {
  RunOptions options, now;
  options.train.iterations = 100, now.train.iterations = 200;
  EXPECT_TRUE(AsksForMoreIterations(SavedWith(options), now));
  EXPECT_FALSE(AsksForMoreIterations(SavedWith(now), options));
  EXPECT_FALSE(AsksForMoreIterations(SavedWith(now), now));
  now.machine.threads = 3;
  EXPECT_TRUE(AsksForMoreIterations(SavedWith(options), now)) << "shapes no result";
  now.start.seed = 1;
  EXPECT_FALSE(AsksForMoreIterations(SavedWith(options), now));
}

TEST(AsksForMoreIterations, TakesWhatAutomaticBecame) {
  RunOptions now;
  now.train.iterations = 200;
  EXPECT_EQ(IterationsOf(SavedWith({}, {{"iterations", 100}})), 100);
  EXPECT_TRUE(AsksForMoreIterations(SavedWith({}, {{"iterations", 100}}), now));
  EXPECT_FALSE(AsksForMoreIterations(SavedWith({}, {{"iterations", 300}}), now));
  EXPECT_FALSE(AsksForMoreIterations(SavedWith({}), now)) << "it does not say";
  EXPECT_FALSE(AsksForMoreIterations(SavedWith({}, {{"iterations", 100}}), {}));
}

TEST(AsksForHigherQuality, ComparesAllElse) {
  RunOptions draft, normal;
  draft.quality.quality = Quality::kDraft;
  EXPECT_TRUE(AsksForHigherQuality(SavedWith(draft), normal));
  EXPECT_FALSE(AsksForHigherQuality(SavedWith(normal), draft));
  EXPECT_FALSE(AsksForHigherQuality(SavedWith(draft), draft));
  normal.start.seed = 1;
  EXPECT_FALSE(AsksForHigherQuality(SavedWith(draft), normal));
}

TEST(ReadRunJson, NamesADamagedFile) {
  TempDir temp;
  WriteText(temp / "stages.json", "{");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadRunJson(temp / "stages.json"); }),
              HasSubstr("stages.json: is damaged, it is not valid JSON"));
}

TEST(ReadSavedRun, RefusesWhatIsNestedTooDeep) {
  TempDir temp;
  WriteText(temp / "options.json", R"({"program": "oraclegs", "format": 1, "scene": "s", "options": {"a": )" +
                                       std::string(1000000, '[') + std::string(1000000, ']') + "}}");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadSavedRun(temp.path()); }), HasSubstr("it is not valid JSON"));
}

}  // namespace
}  // namespace oraclegs

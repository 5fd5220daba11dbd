#include "oraclegs/experiments/series.h"

#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const SeriesFiles kFiles = {"survey", "survey.json", {"survey.json", "rows"}};

TEST(RequireSeriesFolder, TakesWhatIsNewOrItsOwn) {
  const TempDir temp;
  EXPECT_NO_THROW(RequireSeriesFolder(temp / "new", kFiles));
  WriteText(temp / "survey.json", "{\"program\": \"oraclegs\"}");
  WriteText(temp / "rows" / "x", "");
  WriteText(temp / ".oraclegs-lock", "");
  EXPECT_NO_THROW(RequireSeriesFolder(temp.path(), kFiles));
}

TEST(RequireSeriesFolder, RefusesWhatIsOfSomebodyElse) {
  const TempDir temp;
  WriteText(temp / "survey.json", "{\"program\": \"other\"}");
  EXPECT_THAT(MessageOf<InputError>([&] { RequireSeriesFolder(temp.path(), kFiles); }),
              AllOf(HasSubstr("survey.json"), HasSubstr("not written by oraclegs")));
  WriteText(temp / "thesis.tex", "x");
  EXPECT_THAT(MessageOf<InputError>([&] { RequireSeriesFolder(temp.path(), kFiles); }),
              HasSubstr("holds no survey of oraclegs"));
}

TEST(SeriesListener, PassesNotesOfTheFirstRunAndEachWarningOnce) {
  EventRecorder recorder;
  const Listener listener = recorder.AsListener();
  SeriesListener events(listener);
  for (const char* run : {"a: ", "b: "}) {
    const Listener of_run = events.ForRun(run);
    of_run(StageStarted{"train"});
    of_run(Note{run});
    of_run(Warning{"the same"});
    of_run(StepDone{"train", 1, 2, "iterations", ""});
  }
  EXPECT_THAT(recorder.started, ElementsAre("a: train", "b: train"));
  EXPECT_THAT(recorder.notes, ElementsAre("a: "));
  EXPECT_THAT(recorder.warnings, ElementsAre("the same"));
  EXPECT_EQ(recorder.steps[1].stage, "b: train");
}

}  // namespace
}  // namespace oraclegs

// The files that a run keeps for the next one, each as the whole of the bytes.

#include <nlohmann/json.hpp>

#include "fuzz/fuzz.h"
#include "oraclegs/output/live/curves.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/settings/named_options.h"
#include "oraclegs/settings/run_size.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/train_inputs.h"
#include "oraclegs/workspace/advice.h"
#include "oraclegs/workspace/frame_file.h"
#include "oraclegs/workspace/non_commercial.h"
#include "oraclegs/workspace/saved_run.h"
#include "oraclegs/workspace/stage_records.h"

ORACLEGS_FUZZ_TARGET(workspace) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  const auto& dir = folder.path();
  for (const char* name : {"options.json", "stages.json", "frame.json", "metrics.json", "sfm/registration.json",
                           "report/run.json", "train.csv"}) {
    folder.Put(name, bytes);
  }
  fuzz::Try([&] {
    const SavedRun saved = ReadSavedRun(dir);
    RunOptions options;
    DescribeDifference(saved.options, options, saved.size);
    options.train.iterations = 1 << 30;
    AsksForMoreIterations(saved, options);
    SetRunOptions(saved.options, UnknownOption::kIgnored, &options);
    CheckRunOptions(WithSavedSize(options, saved.size));
  });
  fuzz::Try([&] {
    const nlohmann::json records = ReadStageRecords(dir);
    StageTable(Stages(), nlohmann::json::object(), records);
    StageTable(Stages(), records, records);
    NonCommercialParts(WorkspacePaths(dir));
  });
  fuzz::Try([&] { ReadFrame(dir / "frame.json"); });
  fuzz::Try([&] { ReadMetrics(dir); });
  fuzz::Try([&] { ReadExposures(dir / "metrics.json", {"a"}); });
  fuzz::Try([&] { PhotoAdvice(dir, 5); });
  fuzz::Try([&] { CurvesToJson(ReadCurves(dir / "train.csv")); });
}

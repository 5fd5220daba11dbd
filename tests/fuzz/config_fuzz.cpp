// --config: TOML or JSON of options, and the saved options of a run.

#include <nlohmann/json.hpp>

#include "config_file.h"
#include "fuzz/fuzz.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/settings/named_options.h"

ORACLEGS_FUZZ_TARGET(config) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  const auto file = folder.Put("config", bytes);
  RunOptions options;
  OptionTable table = TableOf(&options);
  fuzz::Try([&] { ApplyConfigFile(file, "reconstruct", &table); });
  const nlohmann::json saved = ParseJsonOrDiscard(bytes);
  if (!saved.is_object()) return;
  RunOptions of_run;
  OptionTable table_of_run = TableOf(&of_run);
  fuzz::Try([&] { ApplySavedOptions(saved, file, &table_of_run); });
}

// --config: TOML or JSON of options, and the saved options of a run.

#include <nlohmann/json.hpp>

#include "config_file.h"
#include "fuzz/fuzz.h"
#include "option_binder.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/pipeline/settings/options.h"

ORACLEGS_FUZZ_TARGET(config) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  CLI::App command("reconstruct", "reconstruct");
  RunOptions options;
  RunOptions::ForEachGroup(options, [&](const char* name, auto& group) {
    std::remove_reference_t<decltype(group)>::Visit(group, OptionBinder(&command, name));
  });
  const auto file = folder.Put("config", bytes);
  fuzz::Try([&] { ApplyConfigFile(file, {&command}); });
  const nlohmann::json saved = ParseJsonOrDiscard(bytes);
  if (saved.is_object()) fuzz::Try([&] { ApplySavedOptions(saved, file, {&command}); });
}

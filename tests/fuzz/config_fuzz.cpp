// --config: TOML or JSON of options, and the saved options of a run.

#include <nlohmann/json.hpp>

#include "config_file.h"
#include "fuzz/fuzz.h"
#include "option_binder.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/settings/options.h"

namespace {

/// A command with all options of a run.
struct ConfiguredCommand {
  ConfiguredCommand() {
    oraclegs::RunOptions::ForEachGroup(options, [&](const char* name, auto& group) {
      std::remove_reference_t<decltype(group)>::Visit(group, oraclegs::OptionBinder(&command, name));
    });
  }

  CLI::App command{"reconstruct", "reconstruct"};
  oraclegs::RunOptions options;
};

}  // namespace

ORACLEGS_FUZZ_TARGET(config) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  static ConfiguredCommand made;
  const auto file = folder.Put("config", bytes);
  made.command.clear();
  fuzz::Try([&] { ApplyConfigFile(file, {&made.command}); });
  const nlohmann::json saved = ParseJsonOrDiscard(bytes);
  if (!saved.is_object()) return;
  made.command.clear();
  fuzz::Try([&] { ApplySavedOptions(saved, file, {&made.command}); });
}

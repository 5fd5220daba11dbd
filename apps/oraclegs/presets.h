#pragma once
// Named settings. Those of the folder presets/ of the sources are part of the program; $ORACLEGS_PRESETS may name a
// folder with more, which win over these.

#include <string>
#include <vector>

namespace oraclegs {

struct Preset {
  std::string name;
  std::string source;  ///< for messages: a file, or "preset NAME"
  std::string text;    ///< TOML
};

/// In the order of their names.
std::vector<std::string> PresetNames();

/// Throws UsageError, which lists those that exist, when there is none of this name.
Preset ReadPreset(const std::string& name);

/// Warning of a preset whose number of views another one, --views, replaces: its other settings stay. Names the preset
/// of that number where there is one.
std::string ForOtherViews(const std::string& preset, const std::string& its_views, int views);

}  // namespace oraclegs

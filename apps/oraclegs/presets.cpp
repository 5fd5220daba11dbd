#include "presets.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"

namespace oraclegs {

// Made by cmake/EmbedText.cmake.
std::string_view EmbeddedPreset(std::string_view stem);
std::vector<std::string_view> EmbeddedPresetNames();

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxPresetBytes = 1 << 20;

std::set<fs::path> OwnPresets() {
  std::set<fs::path> files;
  const char* folder = std::getenv("ORACLEGS_PRESETS");
  if (!folder) return files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  }
  return files;
}

}  // namespace

std::vector<std::string> PresetNames() {
  std::set<std::string> names;
  for (const fs::path& file : OwnPresets()) names.insert(file.stem().string());
  for (const std::string_view name : EmbeddedPresetNames()) names.emplace(name);
  return {names.begin(), names.end()};
}

Preset ReadPreset(const std::string& name) {
  for (const fs::path& file : OwnPresets()) {
    if (file.stem() == name) return {name, file.string(), ReadFile(file, kMaxPresetBytes)};
  }
  const std::string_view text = EmbeddedPreset(name);
  if (!text.empty()) return {name, "preset " + name, std::string(text)};
  const std::vector<std::string> names = PresetNames();
  throw UsageError("--preset {} does not exist; there are: {}{}", name, fmt::join(names, ", "),
                   DidYouMean(name, names));
}

std::string ForOtherViews(const std::string& preset, const std::string& its_views, int views) {
  std::string text =
      fmt::format("--preset {} is made for {} views; with --views {} its other settings stay as they are", preset,
                  its_views, views);
  if (!preset.ends_with("-" + its_views)) return text;
  const std::string other = preset.substr(0, preset.size() - its_views.size()) + std::to_string(views);
  const std::vector<std::string> names = PresetNames();
  if (std::find(names.begin(), names.end(), other) != names.end()) {
    text += fmt::format(", --iterations among them; --preset {} has those for {}", other, views);
  }
  return text;
}

}  // namespace oraclegs

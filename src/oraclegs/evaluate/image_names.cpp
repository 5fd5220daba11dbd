#include "oraclegs/evaluate/image_names.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace oraclegs {
namespace {

constexpr std::string_view kTruth = "_gt";

std::string Flat(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

std::string PlainName(const std::string& view) {
  return Flat(std::filesystem::path(view).replace_extension().generic_string());
}

/// Name of a view with its extension: "left/0001.jpg" becomes "left_0001_jpg".
std::string NameWithExtension(const std::string& view) {
  const std::string extension = std::filesystem::path(view).extension().string();
  return extension.empty() ? PlainName(view) : PlainName(view) + "_" + extension.substr(1);
}

std::string TruthOf(const std::string& name) { return name + std::string(kTruth); }

/// Whether the file names of one view's images are free.
bool IsFree(const std::set<std::string>& taken, const std::string& name) {
  return taken.count(name) == 0 && taken.count(TruthOf(name)) == 0;
}

void Take(const std::string& name, std::set<std::string>* taken) { taken->insert({name, TruthOf(name)}); }

}  // namespace

std::vector<std::string> ImageNames(const std::vector<std::string>& views) {
  std::map<std::string, int> wanted;  // how many views want to write a file of this name
  for (const std::string& view : views) {
    ++wanted[PlainName(view)];
    ++wanted[TruthOf(PlainName(view))];
  }
  const auto is_alone = [&](const std::string& name) { return wanted[name] == 1 && wanted[TruthOf(name)] == 1; };
  std::set<std::string> taken;
  for (const std::string& view : views) {
    if (is_alone(PlainName(view))) Take(PlainName(view), &taken);
  }
  std::vector<std::string> names;
  std::map<std::string, int> numbers;  // the next of each name: looking from the start each time would take its square
  for (const std::string& view : views) {
    names.push_back(PlainName(view));
    if (is_alone(names.back())) continue;
    const std::string longer = NameWithExtension(view);
    names.back() = longer;
    int& number = numbers.try_emplace(longer, 2).first->second;
    while (!IsFree(taken, names.back())) names.back() = longer + "_" + std::to_string(number++);
    Take(names.back(), &taken);
  }
  return names;
}

}  // namespace oraclegs

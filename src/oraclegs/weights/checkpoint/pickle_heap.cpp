#include "oraclegs/weights/checkpoint/pickle_heap.h"

#include <algorithm>
#include <array>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/checkpoint/torch_names.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxNameBytes = 500;
constexpr uint64_t kMaxItems = 4'000'000;  // of all tuples, lists and dicts: a copy of one is made with one instruction

}  // namespace

PickleValue PickleHeap::Add(PickleKind kind, std::vector<PickleValue> values) {
  added_ += values.size();
  if (added_ > kMaxItems) {
    throw InputError("{}: its pickle has more than {} values; save its state dict alone", file, kMaxItems);
  }
  items.push_back(std::move(values));
  return {kind, nullptr, static_cast<int64_t>(items.size() - 1)};
}

PickleValue PickleHeap::AddGlobal(std::string_view module, std::string_view name) {
  if (module.size() > kMaxNameBytes || name.size() > kMaxNameBytes) {
    throw InputError("{}: its pickle has a name of {} bytes; get the file again", file,
                     std::max(module.size(), name.size()));
  }
  PickleGlobal global = KnownGlobal(std::string(module) + ' ' + std::string(name));
  if (RunsPrograms(module, name)) {
    throw InputError(
        "{}: its pickle asks for '{}', which is no part of a checkpoint and runs programs in other readers; refused, "
        "get the file from its authors",
        file, Printable(global.name));
  }
  const auto [it, added] = global_of_name.emplace(global.name, globals.size());
  if (added) globals.push_back(std::move(global));
  return {PickleKind::kGlobal, nullptr, static_cast<int64_t>(it->second)};
}

const PickleValue* PickleHeap::Find(const PickleValue& dict, std::string_view key) const {
  if (dict.kind != PickleKind::kDict) return nullptr;
  const std::vector<PickleValue>& pairs = ItemsOf(dict);
  for (size_t i = pairs.size(); i >= 2; i -= 2) {
    if (pairs[i - 2].kind == PickleKind::kText && pairs[i - 2].text() == key) return &pairs[i - 1];
  }
  return nullptr;
}

std::string PickleHeap::Describe(const PickleValue& value) const {
  static constexpr std::array<const char*, 13> kWords = {
      "nothing", "a truth value", "a number",  "a number", "a text",   "a tuple", "a list",
      "a dict",  "a name",        "an object", "numbers",  "a tensor", "a mark"};
  std::string words = kWords[static_cast<size_t>(value.kind)];
  if (value.kind == PickleKind::kObject) words += " of " + Printable(globals[objects[value.index()].type].name);
  return words;
}

}  // namespace oraclegs

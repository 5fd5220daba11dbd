#include "oraclegs/weights/checkpoint/state_dict.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

// Where training programs put the state dict, the likeliest first, and what they put before its names.
constexpr std::string_view kWrappers[] = {"state_dict", "model_state_dict", "model",    "net",        "network",
                                          "params",     "weights",          "module",   "params_ema", "ema",
                                          "model_ema",  "ema_state_dict",   "ema_model"};
constexpr std::string_view kPrefixes[] = {"module.", "_orig_mod.", "model."};
constexpr int kMaxWrappers = 4;          // around each other
constexpr int kMaxDepth = 64;            // of modules within modules
constexpr size_t kMaxSteps = 5'000'000;  // a module may be part of two others, and so on
constexpr size_t kMaxTensorNameBytes = 1000;
constexpr size_t kMaxKeysShown = 10;

class Finder {
 public:
  explicit Finder(const PickleHeap& heap) : heap_(heap) {}

  /// True when the value, or what lies below its usual keys, holds tensors, which are then in state().
  bool Find(const PickleValue& value, int depth = 0) {
    if (value.kind == PickleKind::kObject) {
      CollectModule(value, "", 0);
      return !state_.empty();
    }
    if (value.kind != PickleKind::kDict || depth > kMaxWrappers || !seen_.insert(value.index()).second) return false;
    for (const std::string_view wrapper : kWrappers) {
      const PickleValue* inner = heap_.Find(value, wrapper);
      if (inner && Find(*inner, depth + 1)) return true;
    }
    CollectTensors(value, "");
    return !state_.empty();
  }

  StateDict state() && { return std::move(state_); }

 private:
  void Spend(size_t steps) {
    steps_ += steps;
    if (steps_ > kMaxSteps) {
      throw InputError("{}: its modules are too many or contain each other; save its state dict alone", heap_.file);
    }
  }

  /// Calls use(key, value) for each item of a dict whose key is a text.
  template <class Use>
  void ForEachItem(const PickleValue& dict, const Use& use) {
    if (dict.kind != PickleKind::kDict) return;
    const std::vector<PickleValue>& items = heap_.ItemsOf(dict);
    Spend(items.size());
    for (size_t i = 0; i + 1 < items.size(); i += 2) {
      if (items[i].kind == PickleKind::kText) use(items[i].text(), items[i + 1]);
    }
  }

  void AddTensor(const std::string& prefix, std::string_view name, const PickleValue& value) {
    if (value.kind != PickleKind::kTensor) return;
    std::string full = prefix + std::string(name);
    if (full.size() > kMaxTensorNameBytes) {
      throw InputError("{}: a tensor has a name of {} bytes; get the file again", heap_.file, full.size());
    }
    StoredTensor tensor = StoredTensorOf(heap_.tensors[value.index()], full, heap_);
    state_.insert_or_assign(std::move(full), std::move(tensor));
  }

  void CollectTensors(const PickleValue& dict, const std::string& prefix) {
    ForEachItem(dict, [&](std::string_view name, const PickleValue& item) { AddTensor(prefix, name, item); });
  }

  /// torch.nn.Module keeps its tensors and parts in three dicts; in TorchScript they are its attributes.
  void CollectModule(const PickleValue& module, const std::string& prefix, int depth) {
    if (module.kind != PickleKind::kObject) return;
    if (depth > kMaxDepth || prefix.size() > kMaxTensorNameBytes) Spend(kMaxSteps);
    Spend(1);
    const PickleValue& attributes = heap_.objects[module.index()].state;
    if (attributes.kind != PickleKind::kDict) return;
    Spend(3 * heap_.ItemsOf(attributes).size());
    const PickleValue* parameters = heap_.Find(attributes, "_parameters");
    const PickleValue* buffers = heap_.Find(attributes, "_buffers");
    const PickleValue* modules = heap_.Find(attributes, "_modules");
    const auto part = [&](std::string_view name, const PickleValue& item) {
      CollectModule(item, prefix + std::string(name) + '.', depth + 1);
    };
    if (!parameters && !buffers && !modules) {
      CollectTensors(attributes, prefix);
      ForEachItem(attributes, part);
      return;
    }
    for (const PickleValue* dict : {parameters, buffers}) {
      if (dict) CollectTensors(*dict, prefix);
    }
    if (modules) ForEachItem(*modules, part);
  }

  const PickleHeap& heap_;
  StateDict state_;
  std::set<size_t> seen_;  // dicts
  size_t steps_ = 0;
};

/// The keys of a dict, or what it is instead.
std::string Held(const PickleValue& root, const PickleHeap& heap) {
  if (root.kind != PickleKind::kDict) return heap.Describe(root);
  std::set<std::string> keys;
  const std::vector<PickleValue>& items = heap.ItemsOf(root);
  for (size_t i = 0; i + 1 < items.size(); i += 2) {
    if (items[i].kind == PickleKind::kText) keys.insert(Printable(items[i].text(), 40));
    if (keys.size() > kMaxKeysShown) keys.erase(std::prev(keys.end()));
  }
  return keys.empty() ? "a dict without names" : fmt::format("{}", fmt::join(keys, ", "));
}

}  // namespace

StateDict FindStateDict(const PickleValue& root, const std::string& key, const PickleHeap& heap) {
  const PickleValue* at = &root;
  if (!key.empty()) {
    at = heap.Find(root, key);
    if (!at) throw InputError("{}: holds nothing under --key {}, but: {}", heap.file, key, Held(root, heap));
  }
  Finder finder(heap);
  if (!finder.Find(*at)) {
    throw InputError("{}: holds no state dict, but: {}; choose one with --key", heap.file, Held(*at, heap));
  }
  return std::move(finder).state();
}

StateDict WithoutWrapperNames(StateDict state) {
  for (const std::string_view prefix : kPrefixes) {
    const auto begins = [&](const auto& item) { return item.first.starts_with(prefix); };
    if (state.empty() || !std::all_of(state.begin(), state.end(), begins)) continue;
    StateDict shorter;
    for (auto& [name, tensor] : state) shorter.emplace(name.substr(prefix.size()), std::move(tensor));
    state = std::move(shorter);
  }
  return state;
}

}  // namespace oraclegs

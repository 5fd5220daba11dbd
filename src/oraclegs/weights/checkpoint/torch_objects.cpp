#include "oraclegs/weights/checkpoint/pickle_heap.h"

#include <cstring>
#include <optional>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxDimensions = 16;
constexpr int64_t kMaxCount =
    int64_t{1} << 48;  // of elements: sums of products of these are checked where they are made
constexpr int kMaxNestedCalls = 8;

using Values = std::vector<PickleValue>;

bool IsCount(const PickleValue& value) {
  return value.kind == PickleKind::kInteger && value.number >= 0 && value.number <= kMaxCount;
}

const PickleGlobal* GlobalOf(const PickleValue& value, const PickleHeap& heap) {
  return value.kind == PickleKind::kGlobal ? &heap.globals[value.index()] : nullptr;
}

/// The counts of a tuple or list; nothing when it holds anything else.
std::optional<std::vector<int64_t>> Counts(const PickleValue& value, const PickleHeap& heap) {
  if (value.kind != PickleKind::kTuple && value.kind != PickleKind::kList) return std::nullopt;
  std::vector<int64_t> counts;
  for (const PickleValue& item : heap.ItemsOf(value)) {
    if (!IsCount(item) || counts.size() == kMaxDimensions) return std::nullopt;
    counts.push_back(item.number);
  }
  return counts;
}

/// storage, offset, shape, strides, ...
PickleTensor TensorOf(const Values& parts, const PickleHeap& heap) {
  const auto malformed = [&] { return InputError("{}: a tensor is malformed; get the file again", heap.file); };
  if (parts.size() < 4 || parts[0].kind != PickleKind::kStorage || !IsCount(parts[1])) throw malformed();
  const auto shape = Counts(parts[2], heap), strides = Counts(parts[3], heap);
  if (!shape || !strides || shape->size() != strides->size()) throw malformed();
  PickleTensor tensor;
  tensor.slice = parts[0].index();
  tensor.element = heap.storages[heap.slices[tensor.slice].storage].element;
  tensor.offset = parts[1].number;
  tensor.shape = *shape;
  tensor.strides = *strides;
  return tensor;
}

PickleValue AddTensor(PickleTensor tensor, PickleHeap* heap) {
  heap->tensors.push_back(std::move(tensor));
  return {PickleKind::kTensor, nullptr, static_cast<int64_t>(heap->tensors.size() - 1)};
}

PickleValue TypedTensor(const Values& arguments, PickleHeap* heap) {
  PickleTensor tensor = TensorOf(arguments, *heap);
  const PickleGlobal* type = arguments.size() > 6 ? GlobalOf(arguments[6], *heap) : nullptr;
  if (!type || type->role != PickleRole::kElementType) {
    throw InputError("{}: a tensor has a type that is not known; load and save the file with another PyTorch",
                     heap->file);
  }
  tensor.element = type->element;
  return AddTensor(std::move(tensor), heap);
}

/// A dict of a list of pairs, as OrderedDict is given them, or of a dict. `arguments` may lie in the heap.
PickleValue DictOf(const Values& arguments, PickleHeap* heap) {
  Values pairs;
  if (!arguments.empty() && arguments[0].kind == PickleKind::kDict) pairs = heap->ItemsOf(arguments[0]);
  if (!arguments.empty() && arguments[0].kind == PickleKind::kList) {
    for (const PickleValue& item : heap->ItemsOf(arguments[0])) {
      const bool is_pair = item.kind == PickleKind::kTuple || item.kind == PickleKind::kList;
      if (!is_pair || heap->ItemsOf(item).size() != 2) {
        throw InputError("{}: a dict of its pickle is malformed; get the file again", heap->file);
      }
      const Values& pair = heap->ItemsOf(item);
      pairs.insert(pairs.end(), pair.begin(), pair.end());
    }
  }
  return heap->Add(PickleKind::kDict, std::move(pairs));
}

PickleValue NewObject(size_t type, PickleHeap* heap) {
  heap->objects.push_back({type, {}});
  return {PickleKind::kObject, nullptr, static_cast<int64_t>(heap->objects.size() - 1)};
}

PickleValue Reduce(const PickleValue& function, const PickleValue& arguments, int depth, PickleHeap* heap) {
  const PickleGlobal* global = GlobalOf(function, *heap);
  if (!global || arguments.kind != PickleKind::kTuple || depth > kMaxNestedCalls) {
    throw InputError("{}: its pickle calls what cannot be called; refused, get the file again", heap->file);
  }
  const Values& given = heap->ItemsOf(arguments);
  switch (global->role) {
    case PickleRole::kRebuildTensor:
      return AddTensor(TensorOf(given, *heap), heap);
    case PickleRole::kRebuildTyped:
      return TypedTensor(given, heap);
    case PickleRole::kTensorType: {
      PickleTensor empty;
      empty.element = global->element;
      empty.shape = {0};
      empty.strides = {1};
      return AddTensor(std::move(empty), heap);
    }
    case PickleRole::kRebuildFromType:
      if (given.size() < 3) break;
      return Reduce(PickleValue(given[0]), PickleValue(given[2]), depth + 1, heap);
    case PickleRole::kFirstArgument:
      if (given.empty()) break;
      return given[0];
    case PickleRole::kDict:
      return DictOf(given, heap);
    case PickleRole::kTuple:
      if (given.empty()) break;
      return given[0];
    case PickleRole::kOther:
      return NewObject(function.index(), heap);
    case PickleRole::kStorageType:
    case PickleRole::kElementType:
      throw InputError("{}: its pickle calls what cannot be called; refused, get the file again", heap->file);
  }
  throw InputError("{}: its pickle calls {} without what it needs; get the file again", heap->file, global->name);
}

}  // namespace

PickleValue ReduceInCheckpoint(const PickleValue& function, const PickleValue& arguments, PickleHeap* heap) {
  // An object that is called makes another one, of which even less is known.
  if (function.kind == PickleKind::kObject) return NewObject(heap->objects[function.index()].type, heap);
  return Reduce(function, arguments, 0, heap);
}

void BuildInCheckpoint(const PickleValue& value, const PickleValue& state, PickleHeap* heap) {
  if (value.kind == PickleKind::kObject) {
    heap->objects[value.index()].state = state;
  } else if (value.kind == PickleKind::kTensor && heap->tensors[value.index()].slice == PickleTensor::kNoSlice &&
             state.kind == PickleKind::kTuple) {
    heap->tensors[value.index()] = TensorOf(heap->ItemsOf(state), *heap);
  }
  // All else are attributes, such as the version numbers of modules.
}

PickleValue StorageInCheckpoint(const PickleValue& id, PickleHeap* heap) {
  const Values none;
  const Values& parts = id.kind == PickleKind::kTuple ? heap->ItemsOf(id) : none;
  const std::string_view word = !parts.empty() && parts[0].kind == PickleKind::kText ? parts[0].text() : "";
  if (word == "module" && parts.size() >= 2 && parts[1].kind == PickleKind::kGlobal) return parts[1];
  if (word != "storage" || (parts.size() != 5 && parts.size() != 6)) {
    throw InputError("{}: its pickle refers to something that is no storage; refused, get the file again", heap->file);
  }
  const PickleGlobal* type = GlobalOf(parts[1], *heap);
  if (!type || type->role != PickleRole::kStorageType || parts[2].kind != PickleKind::kText || !IsCount(parts[4])) {
    throw InputError("{}: a storage is malformed; get the file again", heap->file);
  }
  const std::string key(parts[2].text());
  const auto [it, added] = heap->storage_of_key.emplace(key, heap->storages.size());
  if (added) heap->storages.push_back({key, type->element, parts[4].number, {}});
  const PickleStorage& storage = heap->storages[it->second];
  if (storage.numel != parts[4].number || std::strcmp(storage.element.name, type->element.name) != 0) {
    throw InputError("{}: storage '{}' is said to be two different things; get the file again", heap->file,
                     Printable(key, 40));
  }
  PickleStorageSlice slice{it->second, 0, storage.numel};
  if (parts.size() == 6 && parts[5].kind != PickleKind::kNone) {
    const Values& view = parts[5].kind == PickleKind::kTuple ? heap->ItemsOf(parts[5]) : none;
    if (view.size() != 3 || !IsCount(view[1]) || !IsCount(view[2]) || view[1].number > storage.numel ||
        view[2].number > storage.numel - view[1].number) {
      throw InputError("{}: a part of storage '{}' lies outside it; get the file again", heap->file,
                       Printable(key, 40));
    }
    slice.offset = view[1].number;
    slice.numel = view[2].number;
  }
  heap->slices.push_back(slice);
  return {PickleKind::kStorage, nullptr, static_cast<int64_t>(heap->slices.size() - 1)};
}

}  // namespace oraclegs

#pragma once
// The values that the pickle of a checkpoint makes, as plain data. Nothing of them is ever called. Values refer to each
// other by index, so that no depth of nesting and no circle costs more than the pickle is long.

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/weights/checkpoint/pickle_value.h"

namespace oraclegs {

/// The row of numbers under one key of a file.
struct PickleStorage {
  std::string key;
  ElementType element;
  int64_t numel = 0;
  std::string_view bytes;  ///< in the file: known when the pickle was read
};

/// Storages are named as a whole or in part.
struct PickleStorageSlice {
  size_t storage = 0;
  int64_t offset = 0, numel = 0;  ///< elements
};

/// Sizes are not negative; whether it lies within its storage is not known yet.
struct PickleTensor {
  static constexpr size_t kNoSlice = ~size_t{0};
  size_t slice = kNoSlice;  ///< index of a PickleStorageSlice
  ElementType element;
  int64_t offset = 0;  ///< elements, as the strides
  std::vector<int64_t> shape, strides;
};

struct PickleObject {
  size_t type = 0;    ///< global
  PickleValue state;  ///< kNone where it has none
};

class PickleHeap {
 public:
  std::string file;  ///< for errors
  std::deque<std::vector<PickleValue>> items;
  std::deque<PickleGlobal> globals;
  std::deque<PickleObject> objects;
  std::deque<PickleStorage> storages;
  std::deque<PickleStorageSlice> slices;
  std::deque<PickleTensor> tensors;
  std::map<std::string, size_t, std::less<>> global_of_name, storage_of_key, slice_of_view;

  /// Throws InputError when all of them together are more than any checkpoint has.
  PickleValue Add(PickleKind kind, std::vector<PickleValue> values);
  /// Throws InputError for a name that is longer than any of a checkpoint.
  PickleValue AddGlobal(std::string_view module, std::string_view name);

  const std::vector<PickleValue>& ItemsOf(const PickleValue& value) const { return items[value.index()]; }
  /// The last value under a key of a dict; nullptr where it has none and where `dict` is none.
  const PickleValue* Find(const PickleValue& dict, std::string_view key) const;
  /// "list", "an object of pathlib PosixPath", for errors.
  std::string Describe(const PickleValue& value) const;

 private:
  uint64_t added_ = 0;
};

/// The meaning of a name such as "torch._utils _rebuild_tensor_v2"; kOther for names that are not PyTorch's.
PickleGlobal KnownGlobal(const std::string& name);

/// True for names by which a pickle takes hold of the machine when Python reads it. This reader calls nothing, so they
/// are harmless here; but whoever has such a file should know.
bool RunsPrograms(std::string_view module, std::string_view name);

// The values that the calls in a checkpoint's pickle would make: tensors, parameters, dicts, and objects of which
// nothing is known. The functions throw InputError with the file's name for calls that cannot be.

/// REDUCE and NEWOBJ: `function` applied to a tuple.
PickleValue ReduceInCheckpoint(const PickleValue& function, const PickleValue& arguments, PickleHeap* heap);

/// BUILD: gives a value its state.
void BuildInCheckpoint(const PickleValue& value, const PickleValue& state, PickleHeap* heap);

/// BINPERSID: ("storage", type, key, location, numel), and sixth, before PyTorch 1.6, the part of it that is meant:
/// (key, offset, numel). Storages of one key are one.
PickleValue StorageInCheckpoint(const PickleValue& id, PickleHeap* heap);

// Runs the instructions of a checkpoint's pickle. A pickle is a program for a small machine; this one knows the
// instructions by which PyTorch writes checkpoints and refuses every other, and what it makes is data: no name is
// looked up, nothing is called.

/// Reads one pickle from the beginning of `*bytes`, which then begins behind it. Time and memory grow with its length
/// alone. Throws InputError with heap->file for a pickle that is damaged, needs an unknown instruction, or is larger
/// than any of a checkpoint.
PickleValue ReadPickle(std::string_view* bytes, PickleHeap* heap);

}  // namespace oraclegs

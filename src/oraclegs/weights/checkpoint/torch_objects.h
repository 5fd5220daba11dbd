#pragma once
// The values that the calls in a checkpoint's pickle would make: tensors, parameters, dicts, and objects of which
// nothing is known. The functions throw InputError with the file's name for calls that cannot be.

#include "oraclegs/weights/checkpoint/pickle_heap.h"

namespace oraclegs {

/// REDUCE and NEWOBJ: `function` applied to a tuple.
PickleValue ReduceInCheckpoint(const PickleValue& function, const PickleValue& arguments, PickleHeap* heap);

/// BUILD: gives a value its state.
void BuildInCheckpoint(const PickleValue& value, const PickleValue& state, PickleHeap* heap);

/// BINPERSID: ("storage", type, key, location, numel), and sixth, before PyTorch 1.6, the part of it that is meant:
/// (key, offset, numel). Storages of one key are one.
PickleValue StorageInCheckpoint(const PickleValue& id, PickleHeap* heap);

}  // namespace oraclegs

#pragma once
// The state dict in what a checkpoint holds: training programs put it below a key, or save the network itself.

#include <map>
#include <string>

#include "oraclegs/weights/checkpoint/pickle_heap.h"
#include "oraclegs/weights/checkpoint/stored_tensor.h"

namespace oraclegs {

using StateDict = std::map<std::string, StoredTensor>;

/// The tensors of `root` by name. It is a dict of tensors, a network (torch.nn.Module or TorchScript, whose parts'
/// tensors are named "part.weight"), or a dict that holds one of them below a usual key: "state_dict", "model", "ema",
/// ... With `key`, below that one. Throws InputError with heap.file when there is none, and for a tensor that lies
/// outside its numbers.
StateDict FindStateDict(const PickleValue& root, const std::string& key, const PickleHeap& heap);

/// Drops "module.", "_orig_mod." and "model." in this order, each where all names begin so.
StateDict WithoutWrapperNames(StateDict state);

}  // namespace oraclegs

#pragma once
// The names of Python's that PyTorch writes into checkpoints, and those that betray an attack.

#include <string>
#include <string_view>

#include "oraclegs/weights/checkpoint/pickle_value.h"

namespace oraclegs {

/// The meaning of a name such as "torch._utils _rebuild_tensor_v2"; kOther for names that are not PyTorch's.
PickleGlobal KnownGlobal(const std::string& name);

/// True for names by which a pickle takes hold of the machine when Python reads it. This reader calls nothing, so they
/// are harmless here; but whoever has such a file should know.
bool RunsPrograms(std::string_view module, std::string_view name);

}  // namespace oraclegs

#pragma once
// The values that the instructions of a checkpoint's pickle move: small, and without what they refer to.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace oraclegs {

enum class PickleKind : uint8_t {
  kNone,
  kBool,
  kInteger,
  kFloat,    ///< which number is not kept
  kText,     ///< also byte strings, and the bytes of a whole number that an int64_t does not hold
  kTuple,    ///< also a frozen set
  kList,     ///< also a set
  kDict,     ///< keys and values in turn
  kGlobal,   ///< a name of Python's, such as torch._utils _rebuild_tensor_v2
  kObject,   ///< instance of a class that is no tensor: its state is kept, nothing else known
  kStorage,  ///< a row of numbers in the file
  kTensor,
  kMark,  ///< on the stack alone
};

struct PickleValue {
  PickleKind kind = PickleKind::kNone;
  const char* begin = nullptr;  ///< start of a text in the pickle
  int64_t number = 0;           ///< value of an integer; length of a text; else an index into the heap

  size_t index() const { return static_cast<size_t>(number); }
  std::string_view text() const { return {begin, static_cast<size_t>(number)}; }
};

/// The meaning of a name of Python's in a checkpoint.
enum class PickleRole : uint8_t {
  kOther,            ///< makes an object
  kStorageType,      ///< torch FloatStorage
  kElementType,      ///< torch float32
  kTensorType,       ///< torch FloatTensor, made and then given its state, as PyTorch 0.1 wrote it
  kRebuildTensor,    ///< makes a tensor of storage, offset, shape, strides
  kRebuildTyped,     ///< likewise, the type of its elements comes seventh
  kRebuildFromType,  ///< makes one of a function, a class, the function's arguments
  kFirstArgument,    ///< stands for its first argument: parameters, tagged values of TorchScript
  kDict,
  kTuple,
};

struct ElementType {
  const char* name = "";  ///< as safetensors spells it where it has the type
  int64_t bytes = 0;
};

struct PickleGlobal {
  std::string name;  ///< "torch FloatStorage"
  PickleRole role = PickleRole::kOther;
  ElementType element;  ///< type of kStorageType, kElementType and kTensorType
};

}  // namespace oraclegs

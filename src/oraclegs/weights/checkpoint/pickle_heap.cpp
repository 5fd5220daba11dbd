#include "oraclegs/weights/checkpoint/pickle_heap.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxNameBytes = 500;
constexpr uint64_t kMaxItems = 4'000'000;  // of all tuples, lists and dicts: a copy of one is made with one instruction

struct NamedElement {
  const char* storage;  ///< "Float" of FloatStorage and FloatTensor; empty where it has none
  const char* dtype;    ///< torch.float32
  ElementType element;
};

// Types that safetensors does not have are read as far as needed to know where the other numbers lie.
constexpr NamedElement kElements[] = {
    {"Double", "float64", {"F64", 8}},
    {"Float", "float32", {"F32", 4}},
    {"Half", "float16", {"F16", 2}},
    {"BFloat16", "bfloat16", {"BF16", 2}},
    {"Long", "int64", {"I64", 8}},
    {"Int", "int32", {"I32", 4}},
    {"Short", "int16", {"I16", 2}},
    {"Char", "int8", {"I8", 1}},
    {"Byte", "uint8", {"U8", 1}},
    {"Bool", "bool", {"BOOL", 1}},
    {"", "uint16", {"U16", 2}},
    {"", "uint32", {"U32", 4}},
    {"", "uint64", {"U64", 8}},
    {"", "float8_e4m3fn", {"F8_E4M3", 1}},
    {"", "float8_e5m2", {"F8_E5M2", 1}},
    {"ComplexFloat", "complex64", {"C64", 8}},
    {"ComplexDouble", "complex128", {"C128", 16}},
    {"QInt8", "qint8", {"QI8", 1}},
    {"QUInt8", "quint8", {"QU8", 1}},
    {"QInt32", "qint32", {"QI32", 4}},
};

std::map<std::string, PickleGlobal> MakeKnownGlobals() {
  std::map<std::string, PickleGlobal> known;
  const auto add = [&](const std::string& name, PickleRole role, ElementType element = {}) {
    known[name] = {name, role, element};
  };
  for (const NamedElement& named : kElements) {
    add(std::string("torch ") + named.dtype, PickleRole::kElementType, named.element);
    if (!*named.storage) continue;
    for (const std::string module : {"torch ", "torch.cuda "}) {
      add(module + named.storage + "Storage", PickleRole::kStorageType, named.element);
      add(module + named.storage + "Tensor", PickleRole::kTensorType, named.element);
    }
  }
  // Bytes; the tensors over them say what they hold.
  for (const std::string module : {"torch ", "torch.storage ", "torch.cuda "}) {
    for (const char* name : {"UntypedStorage", "_UntypedStorage", "TypedStorage", "_TypedStorage"}) {
      add(module + name, PickleRole::kStorageType, {"U8", 1});
    }
  }
  add("torch._utils _rebuild_tensor", PickleRole::kRebuildTensor);
  add("torch._utils _rebuild_tensor_v2", PickleRole::kRebuildTensor);
  add("torch._utils _rebuild_tensor_v3", PickleRole::kRebuildTyped);
  add("torch._tensor _rebuild_from_type", PickleRole::kRebuildFromType);
  add("torch._tensor _rebuild_from_type_v2", PickleRole::kRebuildFromType);
  for (const char* name :
       {"torch._utils _rebuild_parameter", "torch._utils _rebuild_parameter_with_state", "torch.nn.parameter Parameter",
        "torch.nn.parameter Buffer", "torch.autograd.variable Variable", "torch.jit._pickle restore_type_tag"}) {
    add(name, PickleRole::kFirstArgument);
  }
  for (const char* name : {"collections OrderedDict", "collections defaultdict", "collections Counter", "builtins dict",
                           "__builtin__ dict"}) {
    add(name, PickleRole::kDict);
  }
  add("torch Size", PickleRole::kTuple);
  return known;
}

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

PickleGlobal KnownGlobal(const std::string& name) {
  static const std::map<std::string, PickleGlobal> kKnown = MakeKnownGlobals();
  const auto it = kKnown.find(name);
  return it == kKnown.end() ? PickleGlobal{name, PickleRole::kOther, {}} : it->second;
}

bool RunsPrograms(std::string_view module, std::string_view name) {
  // Whole names of modules: a user's own package may be called code.models. getattr is what enumerations are made with.
  static const std::set<std::string_view> kModules = {
      "os",     "posix",  "nt",      "subprocess", "sys",        "runpy",   "shutil",    "socket",   "pty",
      "ctypes", "code",   "codeop",  "pickle",     "_pickle",    "cPickle", "importlib", "commands", "bdb",
      "pdb",    "timeit", "profile", "cProfile",   "webbrowser", "marshal", "pip"};
  static const std::set<std::string_view> kBuiltins = {"eval",  "exec", "execfile",   "compile",   "open",      "apply",
                                                       "input", "file", "__import__", "raw_input", "breakpoint"};
  static const std::set<std::string, std::less<>> kFunctions = {
      "io open",        "io FileIO",          "_io open",      "_io FileIO", "operator methodcaller",
      "types CodeType", "types FunctionType", "platform popen"};
  if (module == "builtins" || module == "__builtin__") return kBuiltins.count(name) > 0;
  return kModules.count(module) > 0 || kFunctions.count(std::string(module) + ' ' + std::string(name)) > 0;
}

}  // namespace oraclegs

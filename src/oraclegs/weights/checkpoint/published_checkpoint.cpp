#include "oraclegs/weights/checkpoint/published_checkpoint.h"

#include <string_view>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/safetensors_layout.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/checkpoint/torch_file.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

constexpr size_t kHeaderOfSafetensors = 8;  // its place

PublishedCheckpoint ReadSafetensors(const fs::path& path) {
  const auto file = std::make_shared<const SafetensorsFile>(SafetensorsFile::Open(path));
  PublishedCheckpoint checkpoint;
  checkpoint.mapped.push_back(file);
  for (const auto& [name, entry] : file->tensors()) {
    const auto width = static_cast<int64_t>(*ElementBytes(entry.dtype));
    checkpoint.tensors[name] = {entry.dtype, width, entry.shape, ContiguousStrides(entry.shape), entry.bytes};
    checkpoint.bytes += entry.bytes.size();
  }
  if (checkpoint.tensors.empty()) throw InputError("{}: holds no tensor; get the file again", path.string());
  return checkpoint;
}

PublishedCheckpoint ReadOneFile(const fs::path& path, const std::string& key) {
  const MappedFile file = MapFile(path);
  if (LooksLikeTorchFile(file.bytes)) {
    PickleHeap heap;
    heap.file = path.string();
    const PickleValue root = ReadTorchFile(file.bytes, &heap);
    return {FindStateDict(root, key, heap), file.bytes.size(), {file.owner}};
  }
  if (file.bytes.size() > kHeaderOfSafetensors && file.bytes[kHeaderOfSafetensors] == '{') return ReadSafetensors(path);
  throw InputError("{}: is neither a checkpoint of PyTorch nor a safetensors file; name the published file",
                   path.string());
}

PublishedCheckpoint ReadParts(const fs::path& index, const std::string& key) {
  PublishedCheckpoint whole;
  for (const auto& [part, names] : ReadShardIndex(index)) {
    const fs::path path = index.parent_path() / part;
    std::error_code unknown;
    if (!fs::exists(path, unknown)) {
      throw InputError("{}: the part '{}' is not beside it; get the missing part", index.string(), Printable(part));
    }
    PublishedCheckpoint read = ReadOneFile(path, key);
    for (auto& [name, tensor] : read.tensors) {
      if (!names.count(name)) {
        throw InputError("{}: holds tensor '{}', which {} does not seek there; get all parts of one version",
                         path.string(), Printable(name), index.string());
      }
      whole.tensors.emplace(name, std::move(tensor));
    }
    for (const std::string& name : names) {
      if (!read.tensors.count(name)) {
        throw InputError("{}: lacks tensor '{}', which {} seeks there; get all parts of one version", path.string(),
                         Printable(name), index.string());
      }
    }
    whole.bytes += read.bytes;
    whole.mapped.insert(whole.mapped.end(), read.mapped.begin(), read.mapped.end());
  }
  return whole;
}

}  // namespace

PublishedCheckpoint ReadPublishedCheckpoint(const fs::path& path, const std::string& key) {
  PublishedCheckpoint checkpoint = IsTorchShardIndex(path) ? ReadParts(path, key)
                                   : IsShardIndex(path)    ? ReadSafetensors(path)
                                                           : ReadOneFile(path, key);
  checkpoint.tensors = WithoutWrapperNames(std::move(checkpoint.tensors));
  return checkpoint;
}

}  // namespace oraclegs

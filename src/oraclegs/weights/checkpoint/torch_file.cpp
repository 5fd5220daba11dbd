#include "oraclegs/weights/checkpoint/torch_file.h"

#include <algorithm>
#include <set>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/weights/checkpoint/pickle_heap.h"
#include "oraclegs/weights/checkpoint/zip_directory.h"

namespace oraclegs {
namespace {

constexpr std::string_view kZipMark("PK\3\4", 4);
constexpr std::string_view kPickleName = "/data.pkl";
// The whole number 0x1950a86a20f9469cfc6c, which begins the format before PyTorch 1.6, as a pickle holds it.
constexpr std::string_view kMagic("\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19", 10);
constexpr int64_t kLegacyVersion = 1001;
constexpr uint64_t kLengthBytesOfStorage = 8;

[[noreturn]] void BigEndian(const std::string& file) {
  throw InputError("{}: was written on a big-endian machine; load and save it on another one", file);
}

/// Bytes of all elements; a count is below 2^48 and an element below 2^5 bytes.
uint64_t StorageBytes(const PickleStorage& storage) {
  return static_cast<uint64_t>(storage.numel) * static_cast<uint64_t>(storage.element.bytes);
}

/// The folder in the zip that holds the pickle, with its slash.
std::string FolderOfPickle(const ZipDirectory& zip, const std::string& file) {
  std::vector<std::string> folders;
  bool is_old_script = false;
  for (const std::string& name : zip.Names()) {
    const bool below_one_folder = std::count(name.begin(), name.end(), '/') == 1;
    is_old_script = is_old_script || (below_one_folder && name.ends_with("/model.json"));
    if (below_one_folder && name.ends_with(kPickleName)) folders.push_back(name.substr(0, name.find('/') + 1));
  }
  if (folders.size() == 1) return folders.front();
  if (is_old_script) {
    throw InputError("{}: is a TorchScript archive of a PyTorch before 1.4; load and save it with a newer one", file);
  }
  throw InputError("{}: is a zip, but no checkpoint of PyTorch (it has no data.pkl); name the checkpoint itself", file);
}

PickleValue ReadZipFile(std::string_view bytes, PickleHeap* heap) {
  const ZipDirectory zip(bytes, heap->file);
  const std::string folder = FolderOfPickle(zip, heap->file);
  if (zip.Has(folder + "byteorder") && zip.Content(folder + "byteorder") != "little") BigEndian(heap->file);
  std::string_view pickle = zip.Content(folder + "data.pkl");
  const PickleValue root = ReadPickle(&pickle, heap);
  for (PickleStorage& storage : heap->storages) {
    const std::string_view content = zip.Content(folder + "data/" + storage.key);
    if (content.size() < StorageBytes(storage)) {
      throw InputError("{}: storage '{}' is cut off; get the file again", heap->file, Printable(storage.key, 40));
    }
    storage.bytes = content.substr(0, StorageBytes(storage));
  }
  return root;
}

PickleValue ReadLegacyFile(std::string_view bytes, PickleHeap* heap) {
  PickleHeap aside;
  const auto next = [&] {
    aside = {};
    aside.file = heap->file;
    return ReadPickle(&bytes, &aside);
  };
  const PickleValue magic = next();
  if (magic.kind != PickleKind::kText || magic.text() != kMagic) {
    throw InputError("{}: is a pickle, but no checkpoint of PyTorch; name the published checkpoint", heap->file);
  }
  const PickleValue version = next();
  if (version.kind != PickleKind::kInteger || version.number != kLegacyVersion) {
    throw InputError("{}: is of an unknown version of PyTorch's old format; load and save it with a newer one",
                     heap->file);
  }
  const PickleValue system = next();
  const PickleValue* little = aside.Find(system, "little_endian");
  if (!little || little->kind != PickleKind::kBool || little->number == 0) BigEndian(heap->file);
  const PickleValue root = ReadPickle(&bytes, heap);
  const PickleValue keys = next();
  std::set<size_t> found;
  const std::vector<PickleValue> none;
  for (const PickleValue& key : keys.kind == PickleKind::kList ? aside.ItemsOf(keys) : none) {
    const auto it = key.kind == PickleKind::kText ? heap->storage_of_key.find(key.text()) : heap->storage_of_key.end();
    if (it == heap->storage_of_key.end() || !found.insert(it->second).second) {
      throw InputError("{}: its storages are not those of its tensors; get the file again", heap->file);
    }
    PickleStorage& storage = heap->storages[it->second];
    uint64_t length = 0;
    if (bytes.size() < kLengthBytesOfStorage) throw InputError("{}: is cut off; get it again", heap->file);
    for (size_t i = 0; i < kLengthBytesOfStorage; ++i) {
      length |= uint64_t{static_cast<uint8_t>(bytes[i])} << (8 * i);
    }
    bytes.remove_prefix(kLengthBytesOfStorage);
    if (length != static_cast<uint64_t>(storage.numel) || bytes.size() < StorageBytes(storage)) {
      throw InputError("{}: is cut off; get it again", heap->file);
    }
    storage.bytes = bytes.substr(0, StorageBytes(storage));
    bytes.remove_prefix(StorageBytes(storage));
  }
  if (found.size() != heap->storages.size()) {
    throw InputError("{}: its storages are not those of its tensors; get the file again", heap->file);
  }
  return root;
}

}  // namespace

bool LooksLikeTorchFile(std::string_view bytes) {
  return bytes.starts_with(kZipMark) || (!bytes.empty() && bytes.front() == '\x80');
}

PickleValue ReadTorchFile(std::string_view bytes, PickleHeap* heap) {
  return bytes.starts_with(kZipMark) ? ReadZipFile(bytes, heap) : ReadLegacyFile(bytes, heap);
}

}  // namespace oraclegs

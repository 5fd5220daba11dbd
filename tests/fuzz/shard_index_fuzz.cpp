// The index of weights in several files, and the parts that it names.

#include "fuzz/fuzz.h"
#include "oraclegs/core/safetensors.h"
#include "oraclegs/core/safetensors_layout.h"

ORACLEGS_FUZZ_TARGET(shard_index) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  static const std::string part = R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})";
  static const auto first = folder.Put("x-1.safetensors", fuzz::Little(part.size(), 8) + part + "7");
  fuzz::Try([&] { ReadShardIndex(folder.Put("x.bin.index.json", bytes)); });
  const auto index = folder.Put("x.safetensors.index.json", bytes);
  fuzz::Try([&] { ReadShardIndex(index); });
  fuzz::Try([&] { SafetensorsFile::Open(index); });
}

#include "oraclegs/networks/seva/chunk_store.h"

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors.h"

namespace oraclegs::seva {
namespace {

constexpr const char* kImages = "images";

}  // namespace

std::filesystem::path ChunkStore::PathOf(int candidate, size_t job) const {
  return dir_ / fmt::format("candidate_{}_chunk_{:03}.safetensors", candidate, job);
}

void ChunkStore::Write(int candidate, size_t job, const Tensor& images) const {
  if (dir_.empty()) return;
  const Tensor bytes = images.to(torch::kCPU, torch::kByte).contiguous();
  const auto* begin = static_cast<const char*>(bytes.data_ptr());
  const TensorEntry entry{"U8", bytes.sizes().vec(), {begin, static_cast<size_t>(bytes.numel())}};
  WriteFileAtomically(PathOf(candidate, job), SerializeSafetensors({{kImages, entry}}, {{"key", key_}}));
}

std::optional<Tensor> ChunkStore::Read(int candidate, size_t job, at::IntArrayRef shape) const {
  std::error_code ignored;
  if (dir_.empty() || !std::filesystem::exists(PathOf(candidate, job), ignored)) return std::nullopt;
  try {
    const SafetensorsFile file = SafetensorsFile::Open(PathOf(candidate, job));
    const auto key = file.metadata().find("key");
    if (key == file.metadata().end() || key->second != key_) return std::nullopt;
    const TensorEntry& entry = file.Get(kImages);
    if (entry.dtype != "U8" || at::IntArrayRef(entry.shape) != shape) return std::nullopt;
    Tensor images = torch::empty(shape, torch::kByte);
    std::copy(entry.bytes.begin(), entry.bytes.end(), static_cast<char*>(images.data_ptr()));
    return images;
  } catch (const InputError&) {
    return std::nullopt;  // a damaged file is computed again
  }
}

}  // namespace oraclegs::seva

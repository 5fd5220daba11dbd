#pragma once
// Finished chunks in files, so that a generation that was stopped continues after the last of them.

#include <filesystem>
#include <optional>
#include <string>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

class ChunkStore {
 public:
  /// Files are in dir; `key` identifies what the images depend on. An empty dir stores nothing.
  ChunkStore(std::filesystem::path dir, std::string key) : dir_(std::move(dir)), key_(std::move(key)) {}

  /// images [M, 3, H, W] uint8: the generated frames of this job. Throws RunError.
  void Write(int candidate, size_t job, const Tensor& images) const;
  /// nullopt when the file is missing, damaged, of another key or of another shape.
  std::optional<Tensor> Read(int candidate, size_t job, at::IntArrayRef shape) const;

 private:
  std::filesystem::path PathOf(int candidate, size_t job) const;

  std::filesystem::path dir_;
  std::string key_;
};

}  // namespace oraclegs::seva

#pragma once
// What tests share: the reference numbers, and a folder that is gone afterwards.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "oraclegs/core/safetensors.h"

namespace oraclegs {

/// tests/golden, or the folder named by the environment variable ORACLEGS_GOLDEN.
std::filesystem::path GoldenDir();
/// GoldenDir()/NAME.safetensors
SafetensorsFile OpenGolden(const std::string& name);

/// A fresh folder, removed with everything in it at the end of the scope.
class TempDir {
 public:
  TempDir();
  ~TempDir();
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace oraclegs

#include "bench/parser_inputs.h"

#include <unistd.h>

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct FolderOfBench {
  FolderOfBench() { fs::create_directories(path); }
  ~FolderOfBench() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  FolderOfBench(const FolderOfBench&) = delete;
  FolderOfBench& operator=(const FolderOfBench&) = delete;

  const fs::path path = fs::temp_directory_path() / ("parser_growth_" + std::to_string(getpid()));
};

}  // namespace

const fs::path& BenchFolder() {
  static const FolderOfBench folder;
  return folder.path;
}

std::string Repeated(size_t bytes, const std::function<std::string(size_t)>& piece) {
  std::string all;
  for (size_t i = 0; all.size() < bytes; ++i) all += piece(i);
  return all;
}

std::string Numbered(const char* before, size_t i, const char* after) { return before + std::to_string(i) + after; }

}  // namespace oraclegs

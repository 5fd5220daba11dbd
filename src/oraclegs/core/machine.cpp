#include "oraclegs/core/machine.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>
#include <system_error>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::string Trimmed(const std::string& text) {
  const size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t\r");
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

/// Value behind "KEY :" in the first line of a file that has it; empty where none has.
std::string ValueOf(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const size_t colon = line.find(':');
    if (colon != std::string::npos && Trimmed(line.substr(0, colon)) == key) return Trimmed(line.substr(colon + 1));
  }
  return "";
}

bool IsVersion(const std::string& word) {
  return !word.empty() && std::isdigit(static_cast<unsigned char>(word[0])) != 0 &&
         word.find('.') != std::string::npos && word.find_first_not_of("0123456789.") == std::string::npos;
}

}  // namespace

std::string ProcessorName(const fs::path& root) { return OneLine(ValueOf(root / "proc/cpuinfo", "model name")); }

uint64_t TotalMemory(const fs::path& root) {
  const std::string text = ValueOf(root / "proc/meminfo", "MemTotal");
  uint64_t kilobytes = 0;
  std::from_chars(text.data(), text.data() + text.size(), kilobytes);
  return kilobytes * 1024;
}

NvidiaGpus FindNvidiaGpus(const fs::path& root) {
  NvidiaGpus gpus;
  std::istringstream words(ValueOf(root / "proc/driver/nvidia/version", "NVRM version"));
  for (std::string word; gpus.driver.empty() && words >> word;) {
    if (IsVersion(word)) gpus.driver = word;
  }
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(root / "proc/driver/nvidia/gpus", ignored)) {
    folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    const std::string model = ValueOf(folder / "information", "Model");
    gpus.models.push_back(model.empty() ? "NVIDIA GPU" : OneLine(model));
  }
  return gpus;
}

bool HasNvidiaDriver(const fs::path& root) {
  std::error_code ignored;
  return fs::exists(root / "proc/driver/nvidia/version", ignored) ||
         fs::exists(root / "usr/lib/wsl/lib/libcuda.so.1", ignored);
}

}  // namespace oraclegs

#include "fuzz/fuzz.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace oraclegs::fuzz {

namespace fs = std::filesystem;

void Fail(const std::string& text) {
  std::fprintf(stderr, "finding: %s\n", text.c_str());
  throw Finding{text};
}

void CheckMessage(std::string_view message) {
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7F; };
  if (message.empty() || std::any_of(message.begin(), message.end(), is_control)) {
    Fail("a message with control characters: " + std::string(message));
  }
}

Folder::Folder() {
  const char* given = std::getenv("TMPDIR");  // scripts/fuzz.sh gives one, and removes it
  std::string name = (given ? fs::path(given) : fs::path("/dev/shm")) / "oraclegs-fuzz-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) {
    name = fs::temp_directory_path() / "oraclegs-fuzz-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) Fail("no folder for temporary files");
  }
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path Folder::Put(const std::string& name, std::string_view bytes) const {
  const fs::path path = path_ / name;
  int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0) {
    fs::create_directories(path.parent_path());
    file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  }
  const bool whole = write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  close(file);
  if (!whole) Fail("no room for " + path.string());
  return path;
}

std::vector<std::string_view> Parts(std::string_view bytes) {
  constexpr std::string_view kLine = "====\n";
  std::vector<std::string_view> parts;
  while (true) {
    const size_t end = bytes.find(kLine);
    parts.push_back(bytes.substr(0, end));
    if (end == std::string_view::npos) return parts;
    bytes.remove_prefix(end + kLine.size());
  }
}

std::string_view PartAt(const std::vector<std::string_view>& parts, size_t index) {
  return index < parts.size() ? parts[index] : std::string_view();
}

std::string Little(uint64_t number, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i));
  return text;
}

std::string Big(uint64_t number, int bytes) {
  std::string text = Little(number, bytes);
  std::reverse(text.begin(), text.end());
  return text;
}

std::string StoredGzip(std::string_view bytes) {
  constexpr size_t kMaxBlock = 65535;
  std::string packed("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
  for (size_t at = 0; at <= bytes.size(); at += kMaxBlock) {
    const std::string_view block = bytes.substr(at, kMaxBlock);
    packed += at + kMaxBlock > bytes.size() ? '\1' : '\0';
    packed += Little(block.size(), 2) + Little(~block.size(), 2);
    packed += block;
  }
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  return packed + Little(crc, 4) + Little(bytes.size(), 4);
}

}  // namespace oraclegs::fuzz

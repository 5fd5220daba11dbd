#pragma once
// What the targets share. A target is a function of bytes; ORACLEGS_FUZZ_TARGET(png) { ... bytes ... } makes it
// libFuzzer's, or, with ORACLEGS_FUZZ_REPLAY, one of the list that replay_main.cpp runs over the corpus.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs::fuzz {

/// A failure that no input may cause. Not a std::exception, so that no code under test catches it as its own error.
struct Finding {
  std::string text;
};

/// Throws a Finding with the text, which libFuzzer shows first.
[[noreturn]] void Fail(const std::string& text);

/// Throws a Finding for a message that is empty, or has control characters.
void CheckMessage(std::string_view message);

/// Throws a Finding unless `body` ends normally or with an input error of a fit message; RunError is allowed where
/// `Others` says so.
template <class... Others, class Body>
void Try(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    const bool expected = dynamic_cast<const InputError*>(&error) != nullptr ||
                          dynamic_cast<const UsageError*>(&error) != nullptr ||
                          (... || (dynamic_cast<const Others*>(&error) != nullptr));
    if (!expected) Fail(std::string("not the input's fault: ") + error.what());
    CheckMessage(error.what());
  }
}

/// A folder in memory for readers that want a path; removed when the process ends.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file below the folder; returns its path.
  std::filesystem::path Put(const std::string& name, std::string_view bytes) const;

 private:
  std::filesystem::path path_;
};

/// Splits the bytes at lines "====", for targets that read several files.
std::vector<std::string_view> Parts(std::string_view bytes);

/// Part `index`; empty where there is none.
std::string_view PartAt(const std::vector<std::string_view>& parts, size_t index);

/// Reads numbers and texts off the front of bytes; zeros and empty texts at the end.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : left_(bytes) {}

  bool empty() const { return left_.empty(); }
  template <class T>
  T Take() {
    T value{};
    const std::string_view bytes = Text(sizeof(T));
    bytes.copy(reinterpret_cast<char*>(&value), bytes.size());
    return value;
  }
  std::string_view Text(size_t most) {
    const std::string_view text = left_.substr(0, most);
    left_.remove_prefix(text.size());
    return text;
  }

 private:
  std::string_view left_;
};

/// A number as little-endian or big-endian bytes.
std::string Little(uint64_t number, int bytes);
std::string Big(uint64_t number, int bytes);

/// One gzip member that stores the bytes as they are, with the right checksum.
std::string StoredGzip(std::string_view bytes);

using Target = void (*)(std::string_view bytes);

#ifdef ORACLEGS_FUZZ_REPLAY
/// Adds a target to those of replay_main.cpp.
bool AddTarget(const char* name, Target target);
#define ORACLEGS_FUZZ_TARGET(name)                                                                  \
  static void name##_fuzz(std::string_view bytes);                                                  \
  static const bool name##_is_added = ::oraclegs::fuzz::AddTarget(#name, name##_fuzz); /* NOLINT */ \
  static void name##_fuzz(std::string_view bytes)
#else
#define ORACLEGS_FUZZ_TARGET(name)                                            \
  static void name##_fuzz(std::string_view bytes);                            \
  extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);    \
  extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {   \
    static const bool one_thread = (::oraclegs::SetNumThreads(1), true);      \
    if (one_thread) name##_fuzz({reinterpret_cast<const char*>(data), size}); \
    return 0;                                                                 \
  }                                                                           \
  static void name##_fuzz(std::string_view bytes)
#endif

}  // namespace oraclegs::fuzz

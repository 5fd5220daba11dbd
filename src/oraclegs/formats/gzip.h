#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace oraclegs {

/// One gzip member with all the bytes, at the best compression.
std::string Gzip(std::string_view bytes);

/// Unpacks a gzip file piece by piece: no length field of it is believed, and no more is unpacked than was asked for.
class Gunzip {
 public:
  /// `bytes` must live as long as this. Errors name `file`. Throws InputError when it does not begin as gzip does.
  Gunzip(std::string_view bytes, std::string file);
  ~Gunzip();
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;

  /// The next bytes: `count` of them, fewer only where the file ends. Throws InputError for a damaged file.
  std::string Next(uint64_t count);

 private:
  struct Stream;

  std::string file_;
  std::unique_ptr<Stream> stream_;
};

}  // namespace oraclegs

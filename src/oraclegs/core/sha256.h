#pragma once
// SHA-256 (FIPS 180-4): the checksum under which weights are published.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace oraclegs {

class Sha256 {
 public:
  Sha256& Add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits of all that was added so far.
  std::string Hex() const;

 private:
  void Block(const unsigned char* bytes);

  std::array<uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> pending_ = {};  ///< the first total_ % 64 bytes wait for the rest of their block
  uint64_t total_ = 0;                          ///< bytes
};

/// True for 64 hexadecimal digits in lower case.
bool IsSha256(std::string_view text);

}  // namespace oraclegs

#pragma once
// SPZ of version 4 as another program may write it: built by hand, with extensions.

#include <zstd.h>

#include <string>
#include <vector>

#include "oraclegs/formats/gzip.h"
#include "oraclegs/formats/spz_container.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {

template <class T>
void PutNumber(T value, std::string* to) {
  to->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// The content of a file of version 1 to 3, which gzip has packed.
inline std::string BareSpz(const std::string& spz) { return Gunzip(spz, "x").Next(1 << 30); }

/// A file of version 4 with the attributes of one of version 3.
inline std::string SpzOfVersion4(const std::string& spz, const std::string& extensions = "") {
  const std::string bare = BareSpz(spz);
  const auto n = LoadLittle<uint32_t>(bare, 8);
  const int degree = bare[12];
  const SpzLayout at(n, degree, 3);
  std::vector<uint64_t> ends = {at.alphas, at.colors, at.scales, at.rotations, at.sh};
  if (degree > 0) ends.push_back(at.end);
  std::string file = bare.substr(0, 15), table, streams;
  file[4] = 4;
  file[14] = static_cast<char>(file[14] | (extensions.empty() ? 0 : 2));
  file.push_back(static_cast<char>(ends.size()));
  PutNumber(static_cast<uint32_t>(32 + extensions.size()), &file);
  file += std::string(12, '\0') + extensions;
  uint64_t from = 0;
  for (const uint64_t end : ends) {
    std::string packed(ZSTD_compressBound(end - from), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bare.data() + kSpzHeader + from, end - from, 3));
    PutNumber(uint64_t{packed.size()}, &table);
    PutNumber(end - from, &table);
    streams += packed;
    from = end;
  }
  return file + table + streams;
}

}  // namespace oraclegs

// safetensors: a file as it is, or its header and its numbers as two parts.

#include "fuzz/fuzz.h"
#include "oraclegs/core/safetensors.h"

namespace {

template <class T>
void ReadTensor(const oraclegs::SafetensorsFile& file, const std::string& name) {
  oraclegs::fuzz::Try([&] { (void)file.Values<T>(name); });
}

}  // namespace

ORACLEGS_FUZZ_TARGET(safetensors) {
  using namespace oraclegs;
  const auto parts = fuzz::Parts(bytes);
  std::string file(bytes);
  if (bytes.starts_with('{')) {
    file = fuzz::Little(parts[0].size(), 8) + std::string(parts[0]) + std::string(fuzz::PartAt(parts, 1));
  }
  fuzz::Try([&] {
    const SafetensorsFile opened = SafetensorsFile::Parse(file, "f");
    for (const auto& [name, entry] : opened.tensors()) {
      ReadTensor<float>(opened, name);
      ReadTensor<double>(opened, name);
      ReadTensor<int32_t>(opened, name);
      ReadTensor<int64_t>(opened, name);
      ReadTensor<uint8_t>(opened, name);
    }
  });
}

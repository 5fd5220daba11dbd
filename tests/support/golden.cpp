#include "support/golden.h"

#include <cstdlib>

namespace oraclegs {

std::filesystem::path GoldenDir() {
  const char* dir = std::getenv("ORACLEGS_GOLDEN");
  return dir ? dir : ORACLEGS_GOLDEN_DIR;
}

SafetensorsFile OpenGolden(const std::string& name) {
  return SafetensorsFile::Open(GoldenDir() / (name + ".safetensors"));
}

}  // namespace oraclegs

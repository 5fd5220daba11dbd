#include "oraclegs/core/cuda_library.h"

#include "oraclegs/core/engine_source.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/loaded_library.h"

namespace oraclegs {
namespace {

using LookupFunction = void*(const char* name);

const LibraryKind& CudaKind() {
  static const LibraryKind kind{"liboraclegs_cuda.so",
                                "device code",
                                kCudaVariable,
                                "install the package oraclegs-cuda, or build with -DORACLEGS_CUDA=ON",
                                "install the package oraclegs-cuda again",
                                kCudaBuildFunction,
                                ORACLEGS_ENGINE_BUILD};
  return kind;
}

LookupFunction* LoadCuda() {
  const LibraryKind& kind = CudaKind();
  const auto file = FindLibraryOf(kind);
  if (!file) throw UsageError("a GPU needs {}, which is not here; {}", kind.file, kind.how_to_get);
  return LoadedLibrary(kind, *file).Find<LookupFunction>(kCudaLookupFunction);
}

LookupFunction* LoadedCuda() {
  static LookupFunction* const lookup = LoadCuda();
  return lookup;
}

}  // namespace

bool HasCudaLibrary() { return HasLibraryOf(CudaKind()); }

std::string WhyNoCudaLibrary() {
  try {
    LoadedCuda();
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

void* CudaSymbol(const char* name) {
  void* symbol = LoadedCuda()(name);
  if (symbol == nullptr)
    throw RunError("liboraclegs_cuda.so has no function {}; build it and the program together", name);
  return symbol;
}

}  // namespace oraclegs

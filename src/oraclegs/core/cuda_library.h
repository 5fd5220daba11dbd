#pragma once
// The library of device code, liboraclegs_cuda.so (src/oraclegs/cuda): what the floors compute on NVIDIA GPUs. It is
// loaded when a GPU is asked for, so that one program serves machines with and without one.

#include <string>

namespace oraclegs {

/// Environment variable that names the file to load, in place of the search.
inline constexpr const char* kCudaVariable = "ORACLEGS_CUDA_LIBRARY";

/// Exports of the library.
inline constexpr const char* kCudaBuildFunction = "oraclegs_cuda_build";      ///< const char* ()
inline constexpr const char* kCudaLookupFunction = "oraclegs_cuda_function";  ///< void* (const char* name)

/// True when there is a library file: the one that $ORACLEGS_CUDA_LIBRARY names, else liboraclegs_cuda.so where
/// FindLibraryFile (files.h) looks.
bool HasCudaLibrary();

/// Message of the error that CudaFunction would throw for want of a library, empty when there is one that loads.
std::string WhyNoCudaLibrary();

/// Address of a function of oraclegs::cuda; CudaFunction knows its type.
void* CudaSymbol(const char* name);

/// Function of oraclegs::cuda by its name, as `CudaFunction<decltype(cuda::FreeDevice)>("FreeDevice")`. Loads the
/// library, once a process; safe from several threads. Throws UsageError when there is none, it does not load or is of
/// another build.
template <class Function>
Function* CudaFunction(const char* name) {
  return reinterpret_cast<Function*>(CudaSymbol(name));
}

}  // namespace oraclegs

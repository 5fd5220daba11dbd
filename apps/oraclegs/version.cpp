#include "version.h"

#include <fmt/format.h>

#include <string>

#include "oraclegs/core/files.h"
#include "oraclegs/core/hwy_targets.h"
// Highway's macros of instruction sets need the line above.
#include <hwy/highway.h>

#include "oraclegs/core/config.h"
#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr double kProgramSeconds = 5;  // that another program gets to say its version

std::string NameOf(int64_t target) {
  const std::string name = hwy::TargetName(target);
  return name == "AVX3" ? "AVX-512" : name == "AVX3_DL" ? "AVX-512 of Ice Lake" : name;
}

std::string NetworksText() {
#ifdef ORACLEGS_NETWORKS
  const auto library = FindLibraryFile("liboraclegs_networks.so");
  return library ? fmt::format("{} ({})", ORACLEGS_LIBTORCH, library->string())
                 : fmt::format("{}, but liboraclegs_networks.so is not installed", ORACLEGS_LIBTORCH);
#else
  return "no: built without it";
#endif
}

std::string CudaText() {
  if (!HasCudaLibrary()) return "no: liboraclegs_cuda.so is not installed";
  const std::string why = WhyNoCudaLibrary();
  if (!why.empty()) return why;
  const int version = CudaFunction<decltype(cuda::RuntimeVersion)>("RuntimeVersion")();
  return fmt::format("{}.{}", version / 1000, version % 1000 / 10);
}

/// The word after `before` in what a program prints; nothing where there is no such program.
std::optional<std::string> VersionOf(const std::string& program, const std::string& argument,
                                     const std::string& before) {
  if (FindProgram(program).empty()) return std::nullopt;
  ProcessRequest request{{program, argument}};
  request.time_limit = std::chrono::duration<double>(kProgramSeconds);
  const std::string output = RunProcess(request).output;
  const size_t at = output.find(before);
  if (at == std::string::npos) return "found, version unknown";
  const size_t begin = at + before.size();
  return output.substr(begin, output.find_first_of(" \n", begin) - begin);
}

}  // namespace

std::string InstructionSetsText() {
  std::string in_use = "none of them", built;
  for (int bit = 62; bit >= 0; --bit) {  // a better one has a lower bit
    const int64_t target = int64_t{1} << bit;
    if ((HWY_TARGETS & target) == 0) continue;
    if ((hwy::SupportedTargets() & target) != 0) in_use = NameOf(target);
    built += fmt::format("{}{}", built.empty() ? "" : ", ", NameOf(target));
  }
  return fmt::format("{} in use ({} built), {}", in_use, built, Counted(NumThreads(), "thread"));
}

std::optional<std::string> ColmapVersion() { return VersionOf("colmap", "-h", "COLMAP "); }

std::optional<std::string> FfmpegVersion() { return VersionOf("ffmpeg", "-version", "ffmpeg version "); }

std::string ProgramText() { return fmt::format("oraclegs {} (commit {})", ORACLEGS_VERSION, CommitText()); }

std::string VersionText() {
  return fmt::format("{}\ncpu        {}\ncuda       {}\nlibtorch   {}\ncolmap     {}\nffmpeg     {}", ProgramText(),
                     InstructionSetsText(), CudaText(), NetworksText(), ColmapVersion().value_or("not found"),
                     FfmpegVersion().value_or("not found"));
}

}  // namespace oraclegs

// Training on a GPU beside what the device can do at most, and stereo. Only in builds with CUDA; needs a GPU.
//
//   build/cuda/bin/gpu_bench [--gaussians N] [--size WxH] [--dump FOLDER]
//
// Prints one table: milliseconds of each stage of an iteration and of the whole, and the time that its memory traffic
// and its arithmetic would take at the rates measured in the same run. Below it, what stereo takes for a photograph of
// the same size, and what else a run asks for before it trains, beside the same on the CPU. --dump writes the scene as
// raw float32 files and the table's numbers (ours.json) for bench/gsplat_bench.py.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/gpu_fma.h"
#include "bench/gpu_once.h"
#include "bench/gpu_stereo.h"
#include "bench/gpu_training.h"
#include "oraclegs/core/error.h"
#include "oraclegs/depth/cuda/cuda_plane_search.h"

namespace oraclegs {
namespace {

constexpr int kPasses = 30;
constexpr int kOncePasses = 5, kPhotographs = 12;
constexpr int64_t kCopied = int64_t{1} << 30;  // bytes

struct Arguments {
  GpuScene scene;
  std::string dump;
};

Arguments Parse(const std::vector<std::string>& words) {
  Arguments a;
  for (size_t i = 0; i < words.size(); i += 2) {
    const std::string& name = words[i];
    if (i + 1 == words.size()) throw UsageError("{} needs a value", name);
    const std::string& value = words[i + 1];
    if (name == "--gaussians") {
      long long count = 0;
      if (std::sscanf(value.c_str(), "%lld", &count) != 1 || count < 1) throw UsageError("--gaussians {}", value);
      a.scene.gaussians = count;
    } else if (name == "--size") {
      if (std::sscanf(value.c_str(), "%dx%d", &a.scene.width, &a.scene.height) != 2) {
        throw UsageError("--size {}: WxH", value);
      }
    } else if (name == "--dump") {
      a.dump = value;
    } else {
      throw UsageError("unknown option {}", name);
    }
  }
  return a;
}

void Dump(const std::string& folder, const GpuScene& scene) {
  std::filesystem::create_directories(folder);
  const Gaussians gaussians = GaussiansOf(scene);
  gaussians.ForEach([&](const char* name, const Buffer<float>& t) {
    std::ofstream file(folder + "/" + name + ".f32", std::ios::binary);
    file.write(static_cast<const char*>(t.data_ptr()), static_cast<std::streamsize>(t.nbytes()));
  });
  const Camera camera = CameraOf(scene);
  std::ofstream file(folder + "/camera.txt");
  file << camera.width << ' ' << camera.height << ' ' << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' '
       << camera.cy << '\n';
}

void Run(const Arguments& a) {
  cuda::UseDevice(0);
  if (!a.dump.empty()) Dump(a.dump, a.scene);
  GpuReport report;
  report.ceilings = {MeasureBandwidth(kCopied), MeasureFmaRate()};
  const int64_t before = cuda::MemoryOfDevice().free;
  GpuTraining training(a.scene, Device(torch::kCUDA, 0));
  report.times = training.Measure(kPasses);
  report.work = training.Work();
  const double n = report.work.gaussians;
  report.training_bytes = static_cast<double>(before - cuda::MemoryOfDevice().free) / n;
  report.scratch_bytes = static_cast<double>(training.scratch_bytes()) / n;
  report.stereo = MeasureStereo(a.scene.width, a.scene.height, cuda::MakeCudaPlaneSearch(0).get());
  std::fputs(GpuTable(report).c_str(), stdout);
  std::fputs(OnceText(MeasureOnce(a.scene, kPhotographs, kOncePasses)).c_str(), stdout);
  if (!a.dump.empty()) std::ofstream(a.dump + "/ours.json") << GpuReportToJson(report).dump(1) << '\n';
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) {
  try {
    oraclegs::Run(oraclegs::Parse({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gpu_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}

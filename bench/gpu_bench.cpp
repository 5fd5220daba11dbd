// Times of a GPU for training and for the stages before it. Only in builds with CUDA; needs a GPU.
//
//   build/cuda/bin/gpu_bench [--gaussians N] [--size WxH] [--scene FILE.ply --views transforms.json] [--passes N]
//                            [--parts training,stereo,neighbors,warp] [--sh-moments full|half|compact] [--dump FOLDER]
//                            [--json FILE]
//
// training prints a table: milliseconds of each stage of an iteration and of the whole, and the time that its memory
// traffic and its arithmetic would take at the rates measured in the same run. The scene is synthetic or a trained
// model (--scene), seen by the first cameras of --views at about as many pixels as --size has. The other parts print a
// line each. Every part is printed and saved (--json) as soon as it was measured, and runs when one before it failed.
// --dump writes the scene as raw float32 files for bench/gsplat_bench.py.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/gpu_fma.h"
#include "bench/gpu_once.h"
#include "bench/gpu_training.h"
#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/depth/plane_search.h"

namespace oraclegs {
namespace {

constexpr int kOncePasses = 5;
constexpr int64_t kCopied = int64_t{1} << 30;  // bytes

struct Arguments {
  int64_t gaussians = 1'000'000;
  int width = 1237, height = 822;
  std::string scene, views, dump, json;
  std::string parts = "training,stereo,neighbors,warp";
  int passes = 30;
  ShMoments sh_moments = ShMoments::kFull;
};

int64_t PositiveNumber(const std::string& name, const std::string& value) {
  long long number = 0;
  if (std::sscanf(value.c_str(), "%lld", &number) != 1 || number < 1) throw UsageError("{} {}", name, value);
  return number;
}

Arguments Parse(const std::vector<std::string>& words) {
  Arguments a;
  for (size_t i = 0; i < words.size(); i += 2) {
    const std::string& name = words[i];
    if (i + 1 == words.size()) throw UsageError("{} needs a value", name);
    const std::string& value = words[i + 1];
    if (name == "--gaussians") {
      a.gaussians = PositiveNumber(name, value);
    } else if (name == "--passes") {
      a.passes = static_cast<int>(PositiveNumber(name, value));
    } else if (name == "--size") {
      if (std::sscanf(value.c_str(), "%dx%d", &a.width, &a.height) != 2) throw UsageError("--size {}: WxH", value);
    } else if (name == "--scene") {
      a.scene = value;
    } else if (name == "--views") {
      a.views = value;
    } else if (name == "--parts") {
      a.parts = value;
    } else if (name == "--sh-moments") {
      const std::optional<ShMoments> moments = FromWord<ShMoments>(value);
      if (!moments) throw UsageError("--sh-moments {}: {}", value, AllWords<ShMoments>(", "));
      a.sh_moments = *moments;
    } else if (name == "--dump") {
      a.dump = value;
    } else if (name == "--json") {
      a.json = value;
    } else {
      throw UsageError("unknown option {}", name);
    }
  }
  if (a.scene.empty() != a.views.empty()) throw UsageError("--scene FILE.ply and --views transforms.json go together");
  return a;
}

/// Results so far, for printing and saving.
class Results {
 public:
  explicit Results(std::string path) : path_(std::move(path)) {}

  /// Prints and saves at once, since the next part may crash.
  void Add(const std::string& text, const nlohmann::json& values) {
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
    json_.update(values);
    if (!path_.empty()) WriteFileAtomically(path_, json_.dump(1) + "\n");
  }

 private:
  std::string path_;
  nlohmann::json json_ = nlohmann::json::object();
};

void Dump(const std::string& folder, const GpuScene& scene) {
  std::filesystem::create_directories(folder);
  scene.gaussians.ForEach([&](const char* name, const Buffer<float>& values) {
    std::ofstream file(folder + "/" + name + ".f32", std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.bytes()));
  });
  const Camera& camera = scene.cameras.front();
  std::ofstream file(folder + "/camera.txt");
  file << camera.width << ' ' << camera.height << ' ' << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' '
       << camera.cy << '\n';
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) file << camera.cam_from_world.matrix()(row, column) << ' ';
    file << '\n';
  }
}

void TrainingPart(const Arguments& a, Results* results) {
  const GpuScene scene = a.scene.empty() ? SyntheticScene(a.gaussians, a.width, a.height)
                                         : TrainedScene(a.scene, a.views, int64_t{a.width} * a.height);
  if (!a.dump.empty()) Dump(a.dump, scene);
  GpuReport report;
  const int64_t before = cuda::MemoryOfDevice().free;
  GpuTraining training(scene, Device{DeviceKind::kCuda, 0}, a.sh_moments);
  report.times = training.Measure(a.passes);
  report.work = training.Work();
  report.training_bytes = static_cast<double>(before - cuda::MemoryOfDevice().free) / report.work.gaussians;
  report.scratch_bytes = static_cast<double>(training.scratch_bytes()) / report.work.gaussians;
  report.ceilings = {MeasureBandwidth(kCopied), MeasureFmaRate()};
  results->Add(GpuTable(report), GpuReportToJson(report));
}

void StereoPart(const Arguments& a, Results* results) {
  const GpuStereo times = MeasureStereo(a.width, a.height, cuda::MakeCudaPlaneSearch(0).get());
  results->Add(StereoText(times), StereoToJson(times));
}

void NeighborsPart(const Arguments& a, Results* results) {
  const OnBoth times = MeasureNeighbors(a.gaussians, kOncePasses);
  results->Add(OnBothText(fmt::format("three nearest neighbors of {} points", a.gaussians), times),
               OnBothToJson("neighbors", times));
}

void WarpPart(const Arguments& a, Results* results) {
  const WarpSize size{12, a.width, a.height};
  const OnBoth times = MeasureWarp(size, kOncePasses);
  results->Add(OnBothText(fmt::format("a view warped from {} images", size.images), times),
               OnBothToJson("warp", times));
}

/// Whether every part succeeded.
bool Run(const Arguments& a) {
  struct Part {
    const char* name;
    void (*measure)(const Arguments&, Results*);
  };
  constexpr Part kParts[] = {
      {"training", TrainingPart}, {"stereo", StereoPart}, {"neighbors", NeighborsPart}, {"warp", WarpPart}};
  cuda::UseDevice(0);
  Results results(a.json);
  bool good = true;
  for (const Part& part : kParts) {
    if (("," + a.parts + ",").find(fmt::format(",{},", part.name)) == std::string::npos) continue;
    try {
      part.measure(a, &results);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "gpu_bench: %s: %s\n", part.name, error.what());
      good = false;
    }
  }
  return good;
}

}  // namespace

}  // namespace oraclegs

int main(int argc, char** argv) {
  try {
    return oraclegs::Run(oraclegs::Parse({argv + 1, argv + argc})) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gpu_bench: %s\n", error.what());
    return 1;
  }
}

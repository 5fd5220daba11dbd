// The CUDA rasteriser beside what the device can do at most. Only in builds with CUDA; needs a GPU.
//
//   build/cuda/bin/gpu_bench [--gaussians N] [--size WxH] [--dump FOLDER]
//
// Prints one table: milliseconds of each stage (median of 30 passes), and the time that its memory traffic would take
// at the bandwidth measured in the same run. --dump writes the scene as raw float32 files for bench/gsplat_bench.py.

#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "bench/median.h"
#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

struct Arguments {
  int64_t gaussians = 1'000'000;
  int width = 1237, height = 822;
  std::string dump;
};

Arguments Parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--gaussians") {
      a.gaussians = std::stoll(value);
    } else if (name == "--size") {
      if (std::sscanf(value.c_str(), "%dx%d", &a.width, &a.height) != 2) throw UsageError("--size {}: WxH", value);
    } else if (name == "--dump") {
      a.dump = value;
    } else {
      throw UsageError("unknown option {}", name);
    }
  }
  return a;
}

/// Bytes a second of copying from device memory to device memory, both ways counted.
double MeasureBandwidth() {
  const int64_t bytes = int64_t{1} << 30;
  cuda::DeviceArray<char> from("a copy"), to("a copy");
  from.ReserveExactly(bytes);
  to.ReserveExactly(bytes);
  cuda::Event begin, end;
  std::vector<double> rates;
  for (int i = 0; i < 8; ++i) {
    begin.Record(nullptr);
    cuda::Check(cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice, nullptr), "copying");
    end.Record(nullptr);
    end.Wait();
    rates.push_back(2.0 * static_cast<double>(bytes) / (end.MillisecondsSince(begin) * 1e-3));
  }
  return Median(rates);
}

void Dump(const std::string& folder, const Gaussians& gaussians, const Camera& camera) {
  gaussians.ForEach([&](const char* name, const Tensor& t) {
    std::ofstream file(folder + "/" + name + ".f32", std::ios::binary);
    file.write(static_cast<const char*>(t.data_ptr()), static_cast<std::streamsize>(t.nbytes()));
  });
  std::ofstream file(folder + "/camera.txt");
  file << camera.width << ' ' << camera.height << ' ' << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' '
       << camera.cy << '\n';
}

struct Row {
  const char* name;
  double bytes;  // that must be read and written at least
  std::vector<double> ms;
};

/// What each stage cannot do without: parameters of the Gaussians in view, a splat, pairs through two sorts, the
/// planes.
std::vector<Row> MakeRows(int64_t n, const RenderStats& stats, int64_t pixels) {
  const double visible = static_cast<double>(stats.visible), pairs = static_cast<double>(stats.tile_pairs);
  const double all = static_cast<double>(n), area = static_cast<double>(pixels);
  return {{"project", all * 44 + visible * (192 + 48), {}},
          {"bin + sort", all * (8 + 4 * 16) + pairs * (2 * 16 + 16), {}},
          {"blend", pairs * (4 + 48) + area * (20 + 24), {}},
          {"blend backward", pairs * (4 + 48 + 40) + area * (20 + 24), {}},
          {"Gaussian backward", all * (236 + 236) + pairs * 40, {}},
          {"forward", 0, {}},
          {"backward", 0, {}}};
}

void Run(const Arguments& a) {
  const torch::Device device(torch::kCUDA, 0);
  cuda::CudaRasterizer rasterizer(device);
  const Camera camera = FrontCamera(a.width, a.height);
  const Gaussians on_cpu = RandomGaussians(a.gaussians, 0.008, 1);
  if (!a.dump.empty()) Dump(a.dump, on_cpu, camera);
  const auto move = [&](const Gaussians& g) {
    Gaussians out = g;
    out.ForEach([&](const char*, Tensor& t) { t = t.to(device); });
    return out;
  };
  const Gaussians g = move(on_cpu);
  Gaussians grads = move(Gaussians::Zeros(a.gaussians));
  const RenderGrads upstream{torch::ones({a.height, a.width, 3}).to(device), {}, {}};
  const RenderOptions options;
  const auto iterate = [&] {
    rasterizer.Forward(g, camera, options, RenderPass::kTrain);
    rasterizer.Backward(g, upstream, &grads);
  };
  for (int i = 0; i < 5; ++i) iterate();
  const RenderStats stats = rasterizer.stats();
  std::vector<Row> rows = MakeRows(a.gaussians, stats, int64_t{a.width} * a.height);
  cuda::Event begin, middle, end;
  for (int i = 0; i < 30; ++i) {
    begin.Record(nullptr);
    rasterizer.Forward(g, camera, options, RenderPass::kTrain);
    middle.Record(nullptr);
    rasterizer.Backward(g, upstream, &grads);
    end.Record(nullptr);
    end.Wait();
    const RenderTimings t = rasterizer.timings();
    const double ms[] = {t.project,
                         t.bin,
                         t.blend,
                         t.blend_backward,
                         t.gaussian_backward,
                         middle.MillisecondsSince(begin),
                         end.MillisecondsSince(middle)};
    for (size_t k = 0; k < rows.size(); ++k) rows[k].ms.push_back(ms[k]);
  }
  const double bandwidth = MeasureBandwidth();
  std::printf("%lld Gaussians, %lld visible, %lld pairs, %dx%d; %.0f GB/s; %.0f bytes a Gaussian of scratch\n",
              static_cast<long long>(a.gaussians), static_cast<long long>(stats.visible),
              static_cast<long long>(stats.tile_pairs), a.width, a.height, bandwidth * 1e-9,
              static_cast<double>(rasterizer.device_bytes()) / static_cast<double>(a.gaussians));
  std::printf("%-20s %9s %9s %7s\n", "stage", "ms", "floor ms", "share");
  for (const Row& row : rows) {
    const double ms = Median(row.ms), floor = row.bytes / bandwidth * 1e3;
    if (row.bytes > 0) {
      std::printf("%-20s %9.3f %9.3f %6.0f%%\n", row.name, ms, floor, 100 * floor / ms);
    } else {
      std::printf("%-20s %9.3f\n", row.name, ms);
    }
  }
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) {
  try {
    oraclegs::Run(oraclegs::Parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gpu_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}

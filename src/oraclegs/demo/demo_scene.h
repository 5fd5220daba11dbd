#pragma once
// A small ray-traced scene with known truth: what the demo and the end-to-end tests reconstruct. Torch-free.

#include <filesystem>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"

namespace oraclegs {

struct DemoSceneOptions {
  int views = 24;    ///< photographs on an arc around the scene
  int width = 320;   ///< pixels
  int height = 240;  ///< pixels
  int samples = 4;   ///< rays per pixel side (samples x samples)

  template <class V>
  void Visit(V&& visit) {
    visit("demo-views", views, "Photographs to render", Range{2, 1000});
    visit("width", width, "Pixels", Range{16, 8192});
    visit("height", height, "Pixels", Range{16, 8192});
    visit("samples", samples, "Rays per pixel side; n x n rays per pixel", Range{1, 16});
  }
};

/// Ray-traces textured objects with soft shadows, occlusions and one glossy surface, and writes
/// dir/transforms.json, dir/images/NNN.png and dir/depth/NNN.png (16-bit millimetres of scene units x 1000, 0 = none).
/// The same bytes on every machine and for any number of threads. Throws RunError when `dir` cannot be written or
/// already holds something else.
void WriteDemoScene(const std::filesystem::path& dir, const DemoSceneOptions& options, const Listener& listener);

}  // namespace oraclegs

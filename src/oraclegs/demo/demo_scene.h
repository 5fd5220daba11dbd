#pragma once
// Small ray-traced scenes with known truth, for the demo, the end-to-end tests and benchmarks.

#include <filesystem>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/demo/demo_kinds.h"

namespace oraclegs {

struct DemoSceneOptions {
  int views = 24;    ///< images
  int width = 320;   ///< pixels
  int height = 240;  ///< pixels
  int samples = 4;   ///< rays per pixel side (samples x samples)
  DemoKind kind = DemoKind::kRoom;
  bool sensor = false;  ///< transforms.json names what a depth sensor would measure (depth_sensor.h)

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("kind", self.kind,
          "What is shown: room = textured objects in a room, from an arc, object = objects that touch before plain "
          "white, from all around, walls = the room with walls of one color each, forward = the room from places side "
          "by side, all looking the same way, thin = the room with poles, a grating and rings, 1 to 4 pixels thick at "
          "320 x 240, outdoor = the objects on open ground, houses 10 to 55 units away and a smooth sky, spheres = the "
          "room in spherical photos, half as high as wide, "
          "whatever --height says");
    visit("demo-views", self.views, "Images to render", Range{2, 1000});
    visit("width", self.width, "Pixels", Range{16, 8192});
    visit("height", self.height, "Pixels", Range{16, 8192});
    visit("sensor", self.sensor,
          "Also write what a depth sensor would measure: half the photos' size, noise of 5 mm where a unit is a meter, "
          "holes, blurred edges, and its confidence");
    visit("samples", self.samples, "Rays per pixel side; n x n rays per pixel", Range{1, 16});
  }
};

/// Ray-traces a scene of a kind, with soft shadows, occlusions and one mirror ball, and writes
/// dir/transforms.json (OpenGL axes, z up, the floor at z = 0), dir/images/NNN.png, dir/depth/NNN.png (true depth
/// along the optical axis at the pixel's center, 16 bits, in 1/1000 scene unit, 0 = none), which no file names,
/// dir/demo_scene.json (the options), and with a sensor dir/sensor/NNN.png and dir/sensor_confidence/NNN.png.
/// Writes the same bytes on every machine and for any number of threads. Throws RunError when `dir` cannot be written
/// or is neither empty nor a former demo scene; of a former one only its numbered images are replaced.
void WriteDemoScene(const std::filesystem::path& dir, const DemoSceneOptions& options, const Listener& listener);

}  // namespace oraclegs

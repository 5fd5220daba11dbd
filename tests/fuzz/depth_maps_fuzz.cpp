// Depth maps of a workspace, of the user's own or of a sensor: depth_params.json, and the PNG of 16 bits where the
// bytes have a second part.

#include "fuzz/fuzz.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/depth/given_depth.h"
#include "oraclegs/depth/sensor_depth.h"
#include "oraclegs/image/codecs.h"

namespace {

class DepthFolder : public oraclegs::fuzz::Folder {
 public:
  DepthFolder() {
    oraclegs::WritePng16(path() / "a.png", 4, 3, std::vector<uint16_t>(12, 1000));
    for (const char* name : {"confidence/a.png", "normals/a.png"}) {
      Put(name, "");
      oraclegs::WritePng(path() / name, {4, 3, 3, std::vector<uint8_t>(36, 200)});
    }
  }
};

}  // namespace

ORACLEGS_FUZZ_TARGET(depth_maps) {
  using namespace oraclegs;
  static const DepthFolder folder;
  const auto parts = fuzz::Parts(bytes);
  folder.Put("depth_params.json", parts[0]);
  if (parts.size() > 1) folder.Put("b.png", parts[1]);
  Camera camera{4, 3, 4, 4, 2, 1.5};
  const std::vector<std::string> names = {parts.size() > 1 ? "b.jpg" : "a.jpg"};
  fuzz::Try([&] { ReadDepthMaps(folder.path(), names, {camera}); });
  fuzz::Try([&] { ReadGivenDepth(folder.path(), names, {camera}, 1); });
  SceneView view;
  view.name = names[0];
  view.intrinsics = {CameraModel::kPinhole, 4, 3, {4, 4, 2, 1.5}};
  view.depth_path = folder.path() / (parts.size() > 1 ? "b.png" : "a.png");
  view.confidence_path = folder.path() / "confidence/a.png";
  fuzz::Try([&] { ReadSensorDepth(view, camera, 1); });
}

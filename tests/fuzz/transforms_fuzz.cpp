// transforms.json, or the two or three files of a Blender scene where the bytes have parts; frames 1.png and a/2.png
// exist.

#include "fuzz/fuzz.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/transforms.h"

namespace {

/// Folder with the images and masks of a scene, without its JSON.
class TransformsFolder : public oraclegs::fuzz::Folder {
 public:
  TransformsFolder() {
    const oraclegs::Image8 image{4, 3, 3, std::vector<uint8_t>(36, 128)};
    for (const char* name : {"1.png", "a/2.png", "mask.png"}) {
      Put(name, "");
      oraclegs::WritePng(path() / name, image);
    }
  }
};

}  // namespace

ORACLEGS_FUZZ_TARGET(transforms) {
  using namespace oraclegs;
  static const TransformsFolder folder;
  const auto parts = fuzz::Parts(bytes);
  SceneReadOptions options;
  const auto read = [&](const auto& reader) {
    fuzz::Try([&] {
      Scene scene = reader(folder.path(), options, Silent());
      RequireUtf8Names(scene);
      ApplyFrame(LevelFrame(scene), &scene);
    });
  };
  if (bytes.starts_with('\n')) options.images = ".";
  if (parts.size() == 1) {
    folder.Put("transforms.json", bytes);
    return read(ReadTransformsScene);
  }
  folder.Put("transforms_train.json", parts[0]);
  folder.Put("transforms_test.json", parts[1]);
  folder.Put("transforms_val.json", fuzz::PartAt(parts, 2));
  read(ReadBlenderScene);
}

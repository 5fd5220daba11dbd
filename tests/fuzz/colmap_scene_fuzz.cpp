// A whole COLMAP model: cameras.txt, images.txt and points3D.txt, parts of the bytes, and what becomes of them: a scene
// in a frame.

#include "fuzz/fuzz.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/read_colmap.h"

ORACLEGS_FUZZ_TARGET(colmap_scene) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  static const auto image = folder.Put("images/a/1.jpg", "x"), other = folder.Put("images/2.png", "x"),
                    third = folder.Put("images/3.png", "x");
  const auto parts = fuzz::Parts(bytes);
  folder.Put("cameras.txt", fuzz::PartAt(parts, 0));
  folder.Put("images.txt", fuzz::PartAt(parts, 1));
  folder.Put("points3D.txt", fuzz::PartAt(parts, 2));
  fuzz::Try([&] {
    Scene scene = ReadColmapScene(folder.path(), folder.path() / "images", Silent());
    RequireUtf8Names(scene);
    ApplyFrame(LevelFrame(scene), &scene);
  });
}

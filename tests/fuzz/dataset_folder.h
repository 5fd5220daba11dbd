#pragma once
// A folder with two images, for the readers of other programs' cameras.

#include "fuzz/fuzz.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/frame.h"

namespace oraclegs::fuzz {

class DatasetFolder : public Folder {
 public:
  DatasetFolder() {
    const Image8 image{4, 3, 3, std::vector<uint8_t>(36, 128)};
    for (const char* name : {"1.png", "2.png"}) {
      Put(name, "");
      WritePng(path() / name, image);
    }
  }

  /// Reads the folder, and brings the scene into a frame.
  template <class Reader>
  void Read(const Reader& reader) const {
    Try([&] {
      Scene scene = reader(path(), SceneReadOptions{}, Silent());
      RequireUtf8Names(scene);
      ApplyFrame(LevelFrame(scene), &scene);
    });
  }
};

}  // namespace oraclegs::fuzz

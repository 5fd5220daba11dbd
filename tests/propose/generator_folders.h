#pragma once
// A wall that some views show, and what a generator is given and answers for new poses before it.

#include <string>
#include <vector>

#include "depth/surfaces.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/generator_files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {

class GeneratorFolderTest : public testing::Test {
 protected:
  GeneratorFolderTest() {
    for (const Camera& camera : Arc(3, 8)) {
      views.push_back(wall.Take(camera, fmt::format("left/p{}.jpg", views.size())));
      maps.push_back(TrueDepth(views.back(), wall, 0.9f));
    }
    targets = {{"front", CameraAt({0.1, 0, -4}, {0, 0, 0}, 96, 72)},
               {"aside", CameraAt({0, 0, -4}, {2.5, 0, 0}, 64, 48)}};
  }

  void WriteRequest() const { WriteGeneratorRequest(paths, targets, views, Warper({views, maps})); }
  void Answer(const std::string& file, int width, int height, int channels = 3) const {
    const auto count = static_cast<size_t>(width * height * channels);
    WritePng(paths.answer() / file, {width, height, channels, std::vector<uint8_t>(count, 90)});
  }

  TempDir dir;
  CommandFolders paths{dir / "proposals" / "generator"};
  TexturedPlane wall;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  std::vector<Target> targets;
};

}  // namespace oraclegs

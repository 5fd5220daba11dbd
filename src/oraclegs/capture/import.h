#pragma once
// Folders, photos, videos and zip archives that people bring become one folder of photos.

#include <filesystem>
#include <vector>

#include "oraclegs/core/options.h"
#include "oraclegs/core/progress.h"

namespace oraclegs {

/// True for one folder: it is read where it is. Everything else is imported.
bool IsUsedInPlace(const std::vector<std::filesystem::path>& inputs);

/// Throws InputError naming the first input that is missing, empty, damaged, or neither photo, video, zip nor folder,
/// and what to do. Writes nothing.
void CheckInputs(const std::vector<std::filesystem::path>& inputs);

/// Copies, unpacks and extracts the photos of all inputs to `dir`, each file once, those of a folder, archive or video
/// in a folder of its name. `dir` appears when it is whole, and is kept when it was made from the same inputs (by path,
/// size and time of change) and `frames`, the photos of a video. Its parent must be there. Reports the stage "import".
/// Throws as CheckInputs, also for more than kMaxPhotos, and RunError when the disk is full.
void ImportPhotos(const std::vector<std::filesystem::path>& inputs, int frames, const std::filesystem::path& dir,
                  const Listener& listener);

inline constexpr int kUsualFrames = 24;  ///< taken out of a video unless --frames says otherwise

struct CaptureOptions {
  Auto<int> frames;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("frames", self.frames, "Photos to take out of a video, the sharpest of as many equal parts of it; auto = 24",
          Range{3, 500});
  }
};

}  // namespace oraclegs

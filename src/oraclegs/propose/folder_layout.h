#pragma once
// Which images a folder of proposals holds, before any is decoded.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

struct FolderRequest {
  std::vector<Camera> train;    ///< at least one; their distances say when two poses are one (SamePlace)
  std::vector<Target> test;     ///< test views, named like their images ("left/0001.jpg")
  std::vector<Target> dataset;  ///< posed views that are no test views, the same; what proposals may be named after
  int width = 0, height = 0;    ///< of the training images at working resolution
  std::array<float, 3> background{};  ///< RGB in [0, 1], behind transparent pixels
  Similarity placement{};             ///< the cameras' coordinates above from those of the folder's poses
};

/// An image that may become a proposal.
struct FolderImage {
  std::string name;                  ///< as FileName makes it
  std::string shown;                 ///< its path below the folder
  std::filesystem::path file;        ///< exists
  std::filesystem::path confidence;  ///< empty when there is none
  Camera camera;                     ///< of any size with the right shape
};

inline constexpr const char* kUnreadableImage = "they cannot be read; copy them again as PNG or JPEG";

/// Why images are skipped, and which: text -> names. The text ends in how to fix it.
using SkippedImages = std::map<std::string, std::vector<std::string>>;

struct FolderContent {
  std::filesystem::path images_dir, confidence_dir;  ///< the latter empty when there is none
  std::vector<FolderImage> images;                   ///< poses are not yet compared with the test views'
  SkippedImages skipped;
};

/// Throws InputError as ReadProposalFolder says.
FolderContent FindFolderImages(const std::filesystem::path& dir, const FolderRequest& request);

}  // namespace oraclegs

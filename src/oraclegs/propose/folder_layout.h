#pragma once
// Images of a folder of proposals, before any is decoded.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/propose/proposal.h"

namespace oraclegs {

struct FolderRequest {
  std::vector<Camera> train;    ///< at least one; their distances define when two poses are the same (SamePlace)
  std::vector<Target> test;     ///< test views, named like their images ("left/0001.jpg")
  std::vector<Target> dataset;  ///< posed views except test views, named likewise; proposals may be named after them
  int width = 0, height = 0;    ///< size of the training images at working resolution
  std::array<float, 3> background{};  ///< RGB in [0, 1], behind transparent pixels
  Similarity placement{};             ///< from the coordinates of the folder's poses to those of the cameras above
};

/// An image that may become a proposal.
struct FolderImage {
  std::string name;                  ///< from FileName
  std::string shown;                 ///< path below the folder, for messages
  std::filesystem::path file;        ///< existing file
  std::filesystem::path confidence;  ///< empty when there is none
  Camera camera;                     ///< camera of any size with the image's shape
};

inline constexpr const char* kUnreadableImage = "they cannot be read; copy them again as PNG or JPEG";

/// Skipped images by reason: text -> names. The text ends in how to fix it.
using SkippedImages = std::map<std::string, std::vector<std::string>>;

struct FolderContent {
  std::filesystem::path images_dir, confidence_dir;  ///< the latter empty when there is none
  std::vector<FolderImage> images;                   ///< poses are not yet compared with test poses
  SkippedImages skipped;
};

/// Finds the folder's images. Throws InputError as ReadProposalFolder.
FolderContent FindFolderImages(const std::filesystem::path& dir, const FolderRequest& request);

}  // namespace oraclegs

#pragma once
// Which pictures a folder of proposals holds, before any is decoded.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/folder.h"

namespace oraclegs {

/// A picture that may become a proposal.
struct FolderPicture {
  std::string name;                  ///< as FileName makes it
  std::string shown;                 ///< its path below the folder
  std::filesystem::path file;        ///< exists
  std::filesystem::path confidence;  ///< empty when there is none
  Camera camera;                     ///< of any size with the right shape
};

inline constexpr const char* kUnreadablePicture = "they cannot be read; copy them again as PNG or JPEG";

/// Why pictures were left out, and which: text -> names. The text ends in the mend.
using LeftOut = std::map<std::string, std::vector<std::string>>;

struct FolderContent {
  std::filesystem::path pictures_dir, confidence_dir;  ///< the latter empty when there is none
  std::vector<FolderPicture> pictures;                 ///< poses are not yet compared with the test views'
  LeftOut left_out;
};

/// Throws InputError as ReadProposalFolder says.
FolderContent FindFolderPictures(const std::filesystem::path& dir, const FolderRequest& request);

}  // namespace oraclegs

#pragma once
// Folders as capture apps and other programs write them: where their photos are, and poses that are not read.

#include <filesystem>
#include <optional>
#include <string>

namespace oraclegs {

/// A folder of photos with other things, as one program writes it.
struct CaptureLayout {
  std::string program;           ///< for people: "Polycam"
  std::filesystem::path photos;  ///< the folder that holds them, and nothing else
  std::string poses;             ///< what holds poses, below the layout's folder; empty = nothing that was found
  std::string fix;               ///< how to convert them; may be empty
};

/// The layout of `dir`; nullopt when it is none that is known. Looks at names alone.
std::optional<CaptureLayout> FindCaptureLayout(const std::filesystem::path& dir);

/// "cameras.xml has poses of Metashape, which are not read: ...": one sentence on a file of another program in `dir`
/// that holds poses of photos; empty when none does. Each of at most a thousand files is read up to 64 kB.
std::string DescribeUnreadPoses(const std::filesystem::path& dir);

/// DescribeUnreadPoses of a layout; empty without poses.
std::string DescribeUnreadPoses(const CaptureLayout& layout);

/// One such sentence on a COLMAP model or a transforms.json in `dir` or a folder of it, which are read where the folder
/// is the only input; empty without them.
std::string DescribeScenePoses(const std::filesystem::path& dir);

}  // namespace oraclegs

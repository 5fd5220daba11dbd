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

/// "cameras.xml has poses of Metashape, which are not read: ...": one sentence on what lies in `dir`, or in a folder of
/// it, and holds poses of photos; empty when nothing does. Each of at most a thousand files is read up to 64 kB.
std::string DescribeUnreadPoses(const std::filesystem::path& dir);

/// The same sentence for a layout; empty without poses.
std::string DescribeUnreadPoses(const CaptureLayout& layout);

}  // namespace oraclegs

#pragma once
// Photos, videos and archives that a browser sends to a project.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/app/project.h"
#include "oraclegs/web/answers.h"

namespace oraclegs {

enum class UploadKind { kPhoto, kVideo, kZip };

/// A file that was sent to a project.
struct Upload {
  std::string id;  ///< 16 hexadecimal digits
  std::filesystem::path path;
  UploadKind kind = UploadKind::kPhoto;
  uint64_t bytes = 0;
};

/// All files of a project, photos first, as people sort names.
std::vector<Upload> UploadsOf(const ProjectPaths& paths);

/// Answer to an upload that is refused.
struct UploadRefusal {
  int status = 0;
  std::string reason;
};

/// Limits of what a browser may send.
struct UploadLimits {
  uint64_t photo_bytes = uint64_t{1} << 30;   ///< of one photo
  uint64_t media_bytes = uint64_t{64} << 30;  ///< of one video or archive
  uint64_t keep_free = uint64_t{1} << 30;     ///< bytes of the disk that stay free
  size_t files = 10'000;                      ///< of one project
};

/// Writes the body of a request to a file of the project, whose name comes from `name` and whose kind from its content:
/// to a hidden name at first, so that a file that was cut off is never seen. Throws UploadRefusal, having read the rest
/// of a body of at most 64 MiB, so that the browser gets to read the reason; RunError when the folder cannot be made.
Upload ReceiveUpload(const ProjectPaths& paths, const std::string& name, const WebRequest& request,
                     const UploadLimits& limits);

/// Removes hidden files of uploads that an earlier server did not finish.
void RemoveUnfinishedUploads(const ProjectPaths& paths);

}  // namespace oraclegs

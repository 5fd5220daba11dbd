#pragma once
// The files that a scene's text names, also when another system or machine wrote it.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

struct NamedFile {
  std::filesystem::path path;  ///< empty when there is no such file
  std::string name = {};       ///< path below the folder, of a file that does not stand where the text says; else empty
};

struct NamedFilesQuery {
  std::string source;                ///< the text's file, for the note
  std::filesystem::path folder;      ///< that is searched, with the folders below it
  std::vector<std::string> written;  ///< as the text has them
  size_t min_parts = 1;              ///< folders and name, counted from the end, that must agree
  bool allow_outside = false;        ///< an absolute path may lead out of the folder
  bool may_share = false;            ///< paths that are written alike may mean one file
  /// The file at a path as written; empty when there is none. Default: folder / path.
  std::function<std::filesystem::path(const std::string& written)> at = {};
};

/// One entry for each path of the query. A path that names no file is looked for with / for each \, then, in the images
/// below the folder, by the longest end of it that exactly one of them has: in any case and Unicode form, with any
/// extension. Folders are left out of a relative path only when no path names a file as it is written. Two paths never
/// get one file in this way, unless they may share it. One note says how many were found, and how. The folder is listed
/// once.
std::vector<NamedFile> FindNamedFiles(const NamedFilesQuery& query, const Listener& listener);

/// A path with / for each \, and without the letter of a Windows drive.
std::string WithSlashes(const std::string& written);

/// True when `path` lies in the folder by its text; links are not followed.
bool LiesIn(const std::filesystem::path& folder, const std::filesystem::path& path);

}  // namespace oraclegs

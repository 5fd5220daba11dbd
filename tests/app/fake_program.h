#pragma once
// A program that stands in for this one behind the app, and a library to use it in.

#include <filesystem>
#include <string>

#include "oraclegs/app/library.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// Writes a script that appends its arguments to DIR/calls and then does `body`, a shell script in which $OUT is what
/// follows --out.
inline std::filesystem::path WriteFakeProgram(const std::filesystem::path& dir, const std::string& body) {
  const std::filesystem::path program = dir / "oraclegs";
  WriteText(program, "#!/bin/bash\necho \"$*\" >> '" + (dir / "calls").string() +
                         "'\nprevious=\nfor word; do [ \"$previous\" = --out ] && OUT=$word; previous=$word; done\n" +
                         body + "\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program;
}

/// A project with photos, which are no real ones.
inline Project MakeProject(Library* library, int photos, const std::string& name = "garden") {
  const Project project = library->Create(name);
  for (int i = 0; i < photos; ++i) {
    WriteText(project.paths.photos() / ("IMG_" + std::to_string(i) + ".jpg"), "\xff\xd8\xff\xe0 a photo");
  }
  return project;
}

}  // namespace oraclegs

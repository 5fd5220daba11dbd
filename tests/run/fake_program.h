#pragma once

#include <cstdlib>
#include <string>

#include "support/temp_dir.h"

namespace oraclegs {

/// A program of this name that is found first while the scope lasts.
class FakeProgram {
 public:
  FakeProgram(const std::string& name, const std::string& body) : old_path_(std::getenv("PATH")) {
    WriteText(dir_ / name, "#!/bin/sh\n" + body + "\n");
    std::filesystem::permissions(dir_ / name, std::filesystem::perms::owner_all);
    setenv("PATH", (dir_.path().string() + ":" + old_path_).c_str(), 1);
  }
  ~FakeProgram() { setenv("PATH", old_path_.c_str(), 1); }
  FakeProgram(const FakeProgram&) = delete;
  FakeProgram& operator=(const FakeProgram&) = delete;

 private:
  TempDir dir_;
  std::string old_path_;
};

}  // namespace oraclegs

#pragma once
// All commands, and the command line that chooses one of them.

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"

namespace oraclegs {

class Program {
 public:
  Program();

  /// Parses and runs; prints help and version. Returns 0, or 2 after a mistake on the command line; what the command
  /// throws passes through.
  int Run(int argc, char** argv);

 private:
  struct Group {
    std::string title;
    std::vector<std::unique_ptr<Command>> commands;
  };

  Catalog Describe() const;
  Command* Chosen() const;
  int Parse(int argc, char** argv);

  CLI::App app_{"OracleGS"};
  std::vector<Group> groups_;
};

/// Prints an error as one line on stderr; returns the code.
int Fail(const std::string& text, int code);

}  // namespace oraclegs

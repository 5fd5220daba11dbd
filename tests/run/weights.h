#pragma once
// Tests see the weights they wrote, not those of whoever runs them.

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "run/fixtures.h"

namespace oraclegs {

/// An environment variable within a scope; empty = not set.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    Set(value);
  }
  ~EnvironmentVariable() { Set(before_.value_or("")); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  void Set(const std::string& value) const {
    if (value.empty()) {
      unsetenv(name_);
    } else {
      setenv(name_, value.c_str(), 1);
    }
  }
  const char* name_;
  std::optional<std::string> before_;
};

/// The folder that `oraclegs models fetch` writes to.
class ModelsAt : public EnvironmentVariable {
 public:
  explicit ModelsAt(const std::filesystem::path& folder) : EnvironmentVariable("ORACLEGS_MODELS", folder.string()) {}
};

}  // namespace oraclegs

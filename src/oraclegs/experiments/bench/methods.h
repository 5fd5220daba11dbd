#pragma once
// What a benchmark compares: settings of `oraclegs reconstruct` with names.

#include <map>
#include <string>
#include <vector>

#include "oraclegs/experiments/bench/run_arguments.h"

namespace oraclegs {

/// Over a method's own.
struct SuiteSettings {
  RunArguments options;
  RunArguments usual = {};
};

struct Method {
  std::string name;      ///< for --methods and folders
  std::string label;     ///< for tables
  std::string citation;  ///< a key of docs/references.md, or "" for this program's own
  RunArguments options;  ///< make the method what it is: win over the suite's and the user's
  RunArguments usual;    ///< win over the suite's, but not over the user's
  std::string needs;     ///< what must be there for it, for people; "" = nothing
  /// By the names of suites: what its authors set otherwise on these datasets.
  std::map<std::string, SuiteSettings> of_suites = {};

  /// `options` and `usual`, with those of a suite over them where it has such.
  SuiteSettings For(const std::string& suite) const;
};

/// To add one, add a row.
const std::vector<Method>& Methods();

/// The methods that a list joined by commas names, each once, in its order. Throws UsageError that lists those there
/// are, with the nearest word.
std::vector<Method> FindMethods(const std::string& list);

}  // namespace oraclegs

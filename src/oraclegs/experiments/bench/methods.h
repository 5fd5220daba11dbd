#pragma once
// Methods that a benchmark compares: named settings of `oraclegs reconstruct`.

#include <map>
#include <string>
#include <vector>

#include "oraclegs/experiments/bench/run_arguments.h"

namespace oraclegs {

/// Settings for one suite, which win over the method's own.
struct SuiteSettings {
  RunArguments options;
  RunArguments usual = {};
};

struct Method {
  std::string name;      ///< for --methods and folders
  std::string label;     ///< for tables
  std::string citation;  ///< a key of docs/references.md, or "" for this program's own
  RunArguments options;  ///< make the method what it is; win over the suite's and the user's
  RunArguments usual;    ///< win over the suite's, but not over the user's
  std::string needs;     ///< requirements of the method, for people; "" = none
  /// Settings of its authors for these datasets, by the names of suites.
  std::map<std::string, SuiteSettings> of_suites = {};

  /// `options` and `usual`, overlaid with those for the suite.
  SuiteSettings For(const std::string& suite) const;
};

/// A new method is a new row.
const std::vector<Method>& Methods();

/// Methods in a list joined by commas, each once, in its order. Throws UsageError that lists the known methods, with
/// the nearest word.
std::vector<Method> FindMethods(const std::string& list);

}  // namespace oraclegs

#pragma once
// What a benchmark compares: settings of `oraclegs reconstruct` with names.

#include <string>
#include <vector>

#include "oraclegs/experiments/bench/run_arguments.h"

namespace oraclegs {

struct Method {
  std::string name;      ///< for --methods and folders
  std::string label;     ///< for tables
  std::string citation;  ///< a key of docs/references.md, or "" for this program's own
  RunArguments options;  ///< make the method what it is: win over the suite's and the user's
  RunArguments usual;    ///< win over the suite's, but not over the user's
  std::string needs;     ///< what must be there for it, for people; "" = nothing
};

/// To add one, add a row.
const std::vector<Method>& Methods();

/// The methods that a list joined by commas names, each once, in its order. Throws UsageError that lists those there
/// are, with the nearest word.
std::vector<Method> FindMethods(const std::string& list);

}  // namespace oraclegs

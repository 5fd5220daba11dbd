#pragma once
// Methods that a benchmark compares: settings of `oraclegs reconstruct`.

#include <string>
#include <vector>

#include "oraclegs/experiments/bench/run_arguments.h"

namespace oraclegs {

/// Settings of a method for one suite.
struct MethodSettings {
  RunArguments options;  ///< make the method what it is; win over the suite's and the user's
  RunArguments usual;    ///< win over the suite's, but not over the user's
};

struct Method {
  std::string name;      ///< for --methods and folders; that of its row in baselines/methods.h, where it is published
  std::string label;     ///< for tables
  std::string citation;  ///< a key of docs/references.md, or "" for this program's own
  /// The options of its runs; others have their defaults. Null where they are those of a preset (PaperPreset).
  RunOptions (*options)(const Method& method, const std::string& suite);
  std::string needs = "";  ///< requirements of the method, for people; "" = none

  /// True for this program's own: a preset that the user names changes these alone.
  bool is_own() const { return citation.empty(); }
  /// Options that differ from the defaults, for the suite of this name. Not for a method of a preset.
  MethodSettings For(const std::string& suite) const;
};

/// A new method is a new row.
const std::vector<Method>& Methods();

/// Methods in a list joined by commas, each once, in its order. Throws UsageError that lists the known methods, with
/// the nearest word.
std::vector<Method> FindMethods(const std::string& list);

}  // namespace oraclegs

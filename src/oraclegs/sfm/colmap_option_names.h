#pragma once
// Names of options by which this program calls COLMAP, and those of its newer versions.

#include <map>
#include <mutex>
#include <set>
#include <string>

namespace oraclegs {

/// Options that a colmap has refused by their names of version 3.8: it gets the new ones from then on. Newer versions
/// differ in which options they renamed, and none says which it is. Safe to use from several threads.
class RefusedNames {
 public:
  /// The name by which this colmap, a program's path, is to be given the option.
  std::string NameFor(const std::string& colmap, const std::string& option);

  /// True where the last line of this colmap refuses an option by its old name for the first time: it is worth asking
  /// again.
  bool Learn(const std::string& colmap, const std::string& last_line);

 private:
  std::mutex mutex_;
  std::map<std::string, std::set<std::string>> refused_;  ///< by the program's path
};

}  // namespace oraclegs

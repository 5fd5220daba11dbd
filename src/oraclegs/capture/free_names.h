#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace oraclegs {

/// Names below one folder, each given once, also where upper and lower case of ASCII letters are the same.
class FreeNames {
 public:
  /// From now on the name is not free.
  void Block(const std::filesystem::path& name);
  /// The name itself or, where it is not free, the next that is: "trip/IMG_1-2.jpg". Blocks it.
  std::filesystem::path Take(const std::filesystem::path& wanted);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> next_;  ///< number to try for a name: names that are equal a thousand times cost no more
};

}  // namespace oraclegs

#pragma once
// Where a prim of USD stands: the operations of its xformOpOrder.

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/formats/usda_text.h"

namespace oraclegs {

class UsdTransform {
 public:
  /// True for the attributes that Read takes: "xformOp:translate", "xformOpOrder".
  static bool IsPart(std::string_view name) { return name.starts_with("xformOp"); }

  /// Reads the value of such an attribute. Throws InputError.
  void Read(std::string_view type, std::string_view name, UsdaText* text);

  /// Columns, from the prim to its parent. Throws InputError naming `file`: an operation that is not known, or has no
  /// value.
  Eigen::Matrix4d Matrix(const std::string& file) const;
  /// True where the prim's place does not depend on its parent's.
  bool ResetsStack() const;

 private:
  std::map<std::string, std::vector<double>, std::less<>> numbers_;
  std::vector<std::string> order_;
};

}  // namespace oraclegs

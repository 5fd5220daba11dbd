#include "oraclegs/formats/usd_transform.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <numbers>

#include "oraclegs/core/error.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr std::string_view kOperation = "xformOp:", kInverse = "!invert!", kReset = "!resetXformStack!";

/// "rotateXYZ" of "xformOp:rotateXYZ:pivot".
std::string_view KindOf(std::string_view name) {
  if (name.starts_with(kOperation)) name.remove_prefix(kOperation.size());
  return name.substr(0, name.find(':'));
}

/// Numbers of an operation; 0 for an unknown one.
size_t NumbersOfKind(std::string_view kind) {
  if (kind == "transform") return 16;
  if (kind == "orient") return 4;
  if (kind == "translate" || kind == "scale") return 3;
  if (!kind.starts_with("rotate") || kind.size() < 7) return 0;
  std::string axes(kind.substr(6));
  if (axes.size() == 1) return axes[0] >= 'X' && axes[0] <= 'Z' ? 1 : 0;
  std::sort(axes.begin(), axes.end());
  return axes == "XYZ" ? 3 : 0;
}

Eigen::Matrix4d OperationMatrix(std::string_view kind, const std::vector<double>& numbers) {
  const double* n = numbers.data();
  if (kind == "transform") return Eigen::Map<const Eigen::Matrix4d>(n);  // USD's rows are columns here
  Eigen::Affine3d here = Eigen::Affine3d::Identity();
  if (kind == "orient") {
    here.rotate(Eigen::Quaterniond(n[0], n[1], n[2], n[3]).normalized());
  } else if (kind == "translate") {
    here.translate(Eigen::Vector3d(n[0], n[1], n[2]));
  } else if (kind == "scale") {
    here.scale(Eigen::Vector3d(n[0], n[1], n[2]));
  } else {
    // The axis that is named first is turned about first; angles stand in the order x, y, z.
    for (const char axis : kind.substr(6)) {
      const int a = axis - 'X';
      const double degrees = numbers.size() == 1 ? n[0] : n[a];
      here.prerotate(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::Unit(a)));
    }
  }
  return here.matrix();
}

}  // namespace

void UsdTransform::Read(std::string_view type, std::string_view name, UsdaText* text) {
  if (name == "xformOpOrder") {
    const std::vector<std::string_view> order = text->QuotedList();
    order_.assign(order.begin(), order.end());
    return;
  }
  const size_t count = NumbersOfKind(KindOf(name));
  if (count == 0 || type.ends_with("[]")) {
    text->SkipValue();  // where the order names it, it is refused
    return;
  }
  std::vector<double> numbers = text->Numbers<double>(count == 16 ? 4 : static_cast<int>(count));
  if (numbers.size() != count) {
    text->Fail(
        fmt::format("{} has {} numbers, expected {}", QuotedForMessage(std::string(name)), numbers.size(), count));
  }
  numbers_.insert_or_assign(std::string(name), std::move(numbers));
}

Eigen::Matrix4d UsdTransform::Matrix(const std::string& file) const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (const std::string_view named : order_) {
    if (named == kReset) continue;
    const bool inverse = named.starts_with(kInverse);
    const std::string_view name = inverse ? named.substr(kInverse.size()) : named;
    const auto found = numbers_.find(name);
    if (found == numbers_.end()) {
      throw InputError("{}: xformOpOrder names {}, which has no value or is not known; flatten the transforms first",
                       file, QuotedForMessage(std::string(name)));
    }
    const Eigen::Matrix4d here = OperationMatrix(KindOf(name), found->second);
    matrix *= inverse ? Eigen::Matrix4d(here.inverse()) : here;
  }
  return matrix;
}

bool UsdTransform::ResetsStack() const { return !order_.empty() && order_.front() == kReset; }

}  // namespace oraclegs

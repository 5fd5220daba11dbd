#include "oraclegs/scene/frame_comments.h"

#include <fmt/format.h>

#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/options.h"

namespace oraclegs {
namespace {

constexpr std::string_view kLevelComment = "up is -y, the origin is what the cameras look at";
constexpr std::string_view kOffsetComment = "offset ";
constexpr std::string_view kUnitComment = "a unit is ", kMeters = " m";

}  // namespace

std::vector<std::string> FrameComments(const SceneFrame& frame) {
  std::vector<std::string> comments;
  if (frame.is_level) comments.emplace_back(kLevelComment);
  if (frame.unit_meters) comments.push_back(fmt::format("{}{}{}", kUnitComment, *frame.unit_meters, kMeters));
  return WithOffset(std::move(comments), frame.offset);
}

std::optional<double> UnitMetersOf(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments) {
    if (!comment.starts_with(kUnitComment) || !comment.ends_with(kMeters)) continue;
    const std::string number =
        comment.substr(kUnitComment.size(), comment.size() - kUnitComment.size() - kMeters.size());
    try {
      double meters = 0;
      SetOption("unit", number, &meters);
      if (meters > 0 && std::isfinite(meters)) return meters;
    } catch (const UsageError&) {  // a comment of somebody else
    }
  }
  return std::nullopt;
}

std::vector<std::string> WithUnit(const std::vector<std::string>& comments, std::optional<double> unit_meters) {
  std::vector<std::string> kept = comments;
  std::erase_if(kept, [](const std::string& comment) { return UnitMetersOf({comment}).has_value(); });
  SceneFrame frame;
  frame.unit_meters = unit_meters;
  for (std::string& comment : FrameComments(frame)) kept.push_back(std::move(comment));
  return kept;
}

Eigen::Vector3d OffsetOf(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments) {
    if (!comment.starts_with(kOffsetComment)) continue;
    std::istringstream numbers(comment.substr(kOffsetComment.size()));
    numbers.imbue(std::locale::classic());
    Eigen::Vector3d offset;
    std::string rest;
    if (numbers >> offset.x() >> offset.y() >> offset.z() && !(numbers >> rest) && offset.allFinite()) return offset;
  }
  return Eigen::Vector3d::Zero();
}

std::vector<std::string> WithOffset(std::vector<std::string> comments, const Eigen::Vector3d& offset) {
  std::erase_if(comments, [](const std::string& comment) { return !OffsetOf({comment}).isZero(0); });
  if (!offset.isZero(0)) {
    comments.push_back(fmt::format("{}{} {} {}", kOffsetComment, offset.x(), offset.y(), offset.z()));
  }
  return comments;
}

std::vector<std::string> WithoutLevel(std::vector<std::string> comments) {
  std::erase(comments, kLevelComment);
  return comments;
}

}  // namespace oraclegs

#pragma once
// Comments in the header of a splat that describe its frame: up, length of a unit, offset.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/scene/frame.h"

namespace oraclegs {

/// Lines for the header of a splat: up, length of a unit, offset.
std::vector<std::string> FrameComments(const SceneFrame& frame);

/// The length of a unit, as FrameComments wrote it among others.
std::optional<double> UnitMetersOf(const std::vector<std::string>& comments);

/// The comments with another length of a unit, or none.
std::vector<std::string> WithUnit(const std::vector<std::string>& comments, std::optional<double> unit_meters);

/// Offset to be added to positions, as FrameComments wrote it among others; zero where no comment says so.
Eigen::Vector3d OffsetOf(const std::vector<std::string>& comments);

/// The comments with another offset; zero is not written.
std::vector<std::string> WithOffset(std::vector<std::string> comments, const Eigen::Vector3d& offset);

/// The comments of a model that was turned: it is level no more.
std::vector<std::string> WithoutLevel(std::vector<std::string> comments);

}  // namespace oraclegs

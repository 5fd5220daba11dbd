#pragma once
// The little of COLMAP's SQLite database that a run with known cameras needs.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "oraclegs/scene/lens.h"

namespace oraclegs {

struct DatabaseImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
};

/// The images table by name. Throws RunError naming the database when it cannot be read.
std::map<std::string, DatabaseImage> ReadDatabaseImages(const std::filesystem::path& database);

/// Replaces the cameras of those ids, marked as calibrated. Throws RunError naming the database.
void SetDatabaseCameras(const std::filesystem::path& database, const std::map<uint32_t, Lens>& cameras);

/// Numbers the images 1, 2, ... in the order of their names, before there are matches: colmap numbers them as its
/// threads finish, and what follows depends on the numbers. Throws RunError naming the database.
void NumberImagesByName(const std::filesystem::path& database);

}  // namespace oraclegs

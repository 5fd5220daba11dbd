#pragma once
// The reference numbers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "oraclegs/core/safetensors.h"

namespace oraclegs {

/// tests/golden, or the folder named by the environment variable ORACLEGS_GOLDEN.
std::filesystem::path GoldenDir();
/// GoldenDir()/NAME.safetensors
SafetensorsFile OpenGolden(const std::string& name);

}  // namespace oraclegs

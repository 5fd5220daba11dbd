#pragma once
// Errors that a test provokes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "oraclegs/core/error.h"

namespace oraclegs {

/// The message of the Error that `body` throws, which must be one line; "" when it throws none.
template <class Error, class Body>
std::string MessageOf(Body&& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

}  // namespace oraclegs

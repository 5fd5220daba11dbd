#include "oraclegs/core/host.h"

#include <gtest/gtest.h>
#include <sys/utsname.h>

namespace oraclegs {
namespace {

TEST(HostName, CanStandInTheNameOfAFile) {
  const std::string host = HostName();
  EXPECT_FALSE(host.empty());
  EXPECT_EQ(host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-"),
            std::string::npos);
  utsname machine{};
  ASSERT_EQ(uname(&machine), 0);
  EXPECT_EQ(host.size(), std::string(machine.nodename).size());
}

}  // namespace
}  // namespace oraclegs

#include "oraclegs/web/connection.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>

namespace oraclegs {
namespace {

class ConnectionTest : public testing::Test {
 protected:
  ConnectionTest() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0); }
  ~ConnectionTest() override { close(ends[1]); }

  std::array<int, 2> ends{};
  std::atomic<bool> stopping = false;
};

TEST_F(ConnectionTest, ReadsAndWrites) {
  Connection connection(ends[0], stopping);
  ASSERT_EQ(write(ends[1], "hello", 5), 5);
  ASSERT_TRUE(connection.WaitForRequest());
  std::array<char, 16> text{};
  EXPECT_EQ(connection.read(text.data(), 3), 3);
  EXPECT_EQ(connection.read(text.data() + 3, 10), 2);
  EXPECT_STREQ(text.data(), "hello");
  EXPECT_EQ(connection.write("you", 3), 3);
  EXPECT_EQ(read(ends[1], text.data(), 16), 3);
  shutdown(ends[1], SHUT_RDWR);
}

TEST_F(ConnectionTest, ARequestHasAtMost8Kilobytes) {
  Connection connection(ends[0], stopping);
  const std::string endless(20'000, 'x');
  ASSERT_GT(write(ends[1], endless.data(), endless.size()), 0);
  ASSERT_TRUE(connection.WaitForRequest());
  size_t total = 0;
  std::array<char, 1000> part;
  for (ssize_t n; (n = connection.read(part.data(), part.size())) > 0;) total += static_cast<size_t>(n);
  EXPECT_EQ(total, 8192u);
  shutdown(ends[1], SHUT_RDWR);
}

TEST_F(ConnectionTest, AStopEndsItsWaits) {
  Connection connection(ends[0], stopping);
  stopping = true;
  EXPECT_FALSE(connection.WaitForRequest());
}

TEST_F(ConnectionTest, AClosedEndIsNoRequest) {
  Connection connection(ends[0], stopping);
  shutdown(ends[1], SHUT_RDWR);
  char byte = 0;
  EXPECT_TRUE(!connection.WaitForRequest() || connection.read(&byte, 1) <= 0);
}

}  // namespace
}  // namespace oraclegs

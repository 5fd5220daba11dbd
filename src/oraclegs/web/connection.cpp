#include "oraclegs/web/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace oraclegs {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr size_t kMaxRequestBytes = 8 << 10;  // line and headers; there are no bodies
constexpr seconds kRequestTime(10), kIdleTime(5), kPauseOfReader(10), kAnswerTime(30);
constexpr double kMinBytesPerSecond = 20'000;  // of a client that takes longer than kAnswerTime for an answer
constexpr milliseconds kSlice(100);            // after so long a stop of the server is noticed
constexpr milliseconds kLingerTime(500);
constexpr size_t kMaxLingerBytes = 256 << 10;

}  // namespace

Connection::~Connection() {
  shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + kLingerTime;
  std::array<char, 4096> rest;
  for (size_t total = 0; total < kMaxLingerBytes && Wait(POLLIN, deadline);) {
    const ssize_t n = recv(socket_, rest.data(), rest.size(), MSG_DONTWAIT);
    if (n <= 0) break;
    total += static_cast<size_t>(n);
  }
  close(socket_);
}

bool Connection::WaitForRequest() {
  if (!Wait(POLLIN, Clock::now() + kIdleTime)) return false;
  bytes_left_ = kMaxRequestBytes;
  request_deadline_ = Clock::now() + kRequestTime;
  answer_begin_ = {};
  written_ = 0;
  return true;
}

bool Connection::Wait(short events, Clock::time_point deadline) const {
  while (!stopping_) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return false;
    pollfd wanted{socket_, events, 0};
    const int ready = poll(&wanted, 1, static_cast<int>(std::min(left, kSlice).count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool Connection::is_readable() const { return Wait(POLLIN, request_deadline_); }

bool Connection::is_writable() const { return Wait(POLLOUT, Clock::now() + kPauseOfReader); }

ssize_t Connection::read(char* to, size_t size) {
  size = std::min(size, bytes_left_);
  if (size == 0 || !is_readable()) return -1;
  const ssize_t n = recv(socket_, to, size, MSG_DONTWAIT);
  if (n > 0) bytes_left_ -= static_cast<size_t>(n);
  return n;
}

ssize_t Connection::write(const char* from, size_t size) {
  if (answer_begin_ == Clock::time_point{}) answer_begin_ = Clock::now();
  const double allowed =
      std::chrono::duration<double>(kAnswerTime).count() + static_cast<double>(written_) / kMinBytesPerSecond;
  if (std::chrono::duration<double>(Clock::now() - answer_begin_).count() > allowed || !is_writable()) return -1;
  const ssize_t n = send(socket_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (n > 0) written_ += static_cast<size_t>(n);
  return n;
}

// Unused: addresses are neither logged nor compared.
void Connection::get_remote_ip_and_port(std::string& ip, int& port) const { ip.clear(), port = 0; }
void Connection::get_local_ip_and_port(std::string& ip, int& port) const { ip.clear(), port = 0; }

}  // namespace oraclegs

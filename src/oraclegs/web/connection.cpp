#include "oraclegs/web/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr size_t kMaxRequestBytes = 8 << 10;  // line and headers
constexpr seconds kRequestTime(10), kIdleTime(5), kPauseOfReader(10), kAnswerTime(30);
constexpr seconds kBodyTime(30);
constexpr double kMinBytesPerSecond = 20'000;  // of a client that takes longer for a body or an answer
constexpr milliseconds kSlice(100);            // after so long a stop of the server is noticed
constexpr milliseconds kLingerTime(500);
constexpr size_t kMaxLingerBytes = 256 << 10;

constexpr size_t kWorkers = 48;      // a browser opens six connections a page
constexpr size_t kMaxWaiting = 100;  // connections that no worker has yet
constexpr int kMaxRequestsOfConnection = 1000;

thread_local Connection* g_current = nullptr;

/// Set, on the accepting thread, while it hands over a connection that is too many.
thread_local bool g_refuse = false;

/// Threads for connections, started on demand; where the system gives no more, connections wait for the existing ones.
/// Connections beyond the queue's limit are refused.
class ConnectionWorkers : public httplib::TaskQueue {
 public:
  /// Starts the first thread. Throws std::system_error where none can be started.
  ConnectionWorkers() {
    threads_.reserve(kWorkers);
    Start();
  }
  ~ConnectionWorkers() override { ConnectionWorkers::shutdown(); }

  void enqueue(std::function<void()> connection) override {
    if (Take(connection)) return;
    g_refuse = true;
    connection();
    g_refuse = false;
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  void Start() {
    threads_.emplace_back([this] { Work(); });
  }

  bool Take(const std::function<void()>& connection) {
    const std::lock_guard lock(mutex_);
    try {
      if (pending_ >= threads_.size() && threads_.size() < kWorkers) Start();
    } catch (const std::system_error&) {  // limits of threads or memory
    }
    if (pending_ >= threads_.size() + kMaxWaiting) return false;
    try {
      waiting_.push_back(connection);
    } catch (const std::bad_alloc&) {
      return false;
    }
    ++pending_;
    wake_.notify_one();
    return true;
  }

  void Work() {
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      const std::function<void()> connection = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      connection();
      lock.lock();
      --pending_;
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> waiting_;
  size_t pending_ = 0;  ///< waiting and served connections
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

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
  in_body_ = false;
  return true;
}

void Connection::AllowBody(uint64_t bytes) {
  bytes_left_ = bytes;
  request_deadline_ = Clock::now() + kBodyTime;
  in_body_ = true;
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
  size = static_cast<size_t>(std::min<uint64_t>(size, bytes_left_));
  if (size == 0 || !is_readable()) return -1;
  const ssize_t n = recv(socket_, to, size, MSG_DONTWAIT);
  if (n <= 0) return n;
  bytes_left_ -= static_cast<size_t>(n);
  if (in_body_) {
    const std::chrono::duration<double> earned(static_cast<double>(n) / kMinBytesPerSecond);
    request_deadline_ += std::chrono::duration_cast<Clock::duration>(earned);
  }
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

LimitedServer::LimitedServer() {
  try {
    workers_ = std::make_unique<ConnectionWorkers>();
  } catch (const std::system_error& error) {
    throw RunError("the viewer cannot start a thread: {}; end other programs, or raise `ulimit -u`",
                   SystemReason(error.code()));
  }
  new_task_queue = [this] { return workers_.release(); };
  // Replaces httplib's own choice, by which two servers can share a port.
  set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  set_tcp_nodelay(true);
  set_payload_max_length(0);
}

bool LimitedServer::process_and_close_socket(socket_t socket) {
  if (g_refuse) {
    close(socket);
    return false;
  }
  try {
    Serve(socket);
  } catch (const std::exception&) {  // no memory: this connection ends, others go on
    return false;
  }
  return true;
}

Connection* LimitedServer::Current() { return g_current; }

void LimitedServer::Serve(socket_t socket) {
  Connection connection(socket, stopping_);
  g_current = &connection;
  struct Reset {
    ~Reset() { g_current = nullptr; }
  } const reset;
  // A request with a body ends the connection; neither its rest nor anything that is not HTTP is taken for another
  // request.
  bool last = false;
  const auto before_routing = [&](httplib::Request& request) {
    request.ranges.clear();
    request.headers.erase("Range");
    request.headers.erase("Accept-Encoding");  // httplib compresses at its best, which takes longer than a slow network
    const bool plain = request.method == "GET" || request.method == "HEAD";
    last = !plain || request.has_header("Content-Length") || request.has_header("Transfer-Encoding") ||
           request.has_header("Expect");
    request.headers.erase("Expect");
    if (!last) return;
    request.headers.erase("Connection");
    request.set_header("Connection", "close");
  };
  for (int i = kMaxRequestsOfConnection; i > 0 && !last && connection.WaitForRequest(); --i) {
    bool closed = false;
    last = true;  // unless it comes as far as routing
    if (!process_request(connection, i == 1, closed, before_routing) || closed) break;
  }
}

}  // namespace oraclegs

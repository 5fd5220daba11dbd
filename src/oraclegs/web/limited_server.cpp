#include "oraclegs/web/limited_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <functional>
#include <utility>

#include "oraclegs/web/connection.h"

namespace oraclegs {
namespace {

constexpr size_t kWorkers = 48;      // a browser opens six connections a page
constexpr size_t kMaxWaiting = 100;  // connections that no worker has yet
constexpr int kMaxRequestsOfConnection = 1000;

/// Set on the thread that accepts connections while it hands one over that is too many.
thread_local bool g_refuse = false;

/// Threads for connections; what comes when too many wait is turned away.
class BoundedWorkers : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> connection) override {
    if (pending_ >= kWorkers + kMaxWaiting) {
      g_refuse = true;
      connection();
      g_refuse = false;
      return;
    }
    ++pending_;
    pool_.enqueue([this, connection = std::move(connection)] {
      connection();
      --pending_;
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::atomic<size_t> pending_ = 0;
  httplib::ThreadPool pool_{kWorkers};
};

}  // namespace

LimitedServer::LimitedServer() {
  new_task_queue = [] { return new BoundedWorkers; };
  // Not httplib's own choice, by which two servers can share a port.
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
  Connection connection(socket, stopping_);
  // What has a body is refused unread; nothing of that, nor of what is no HTTP, is taken for another request.
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
  return true;
}

}  // namespace oraclegs

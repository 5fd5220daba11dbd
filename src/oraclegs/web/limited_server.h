#pragma once
// httplib's server with limits on clients.

#include <httplib.h>

#include <atomic>
#include <memory>

namespace oraclegs {

/// Connections are ours (web/connection.h), and so many at a time. What has a body or another method than GET and HEAD
/// ends its connection, its body unread; Range, Expect and Accept-Encoding are ignored. It listens once.
class LimitedServer : public httplib::Server {
 public:
  /// Throws RunError where the system gives no thread.
  LimitedServer();
  /// Ends the connections that there are, within a moment; then stop() does not wait for clients.
  void StopConnections() { stopping_ = true; }

 private:
  bool process_and_close_socket(socket_t socket) override;
  void Serve(socket_t socket);

  std::unique_ptr<httplib::TaskQueue> workers_;  ///< until it listens
  std::atomic<bool> stopping_ = false;
};

}  // namespace oraclegs

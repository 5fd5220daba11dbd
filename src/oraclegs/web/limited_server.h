#pragma once
// httplib's server with limits on clients.

#include <httplib.h>

#include <atomic>
#include <memory>

namespace oraclegs {

/// A server of web/connection.h connections, limited in number. A request with a body or another method than GET and
/// HEAD ends its connection, the body unread; Range, Expect and Accept-Encoding are ignored. It listens once.
class LimitedServer : public httplib::Server {
 public:
  /// Starts the workers. Throws RunError where the system gives no thread.
  LimitedServer();
  /// Ends the open connections within a moment, so that stop() does not wait for clients.
  void StopConnections() { stopping_ = true; }

 private:
  bool process_and_close_socket(socket_t socket) override;
  void Serve(socket_t socket);

  std::unique_ptr<httplib::TaskQueue> workers_;  ///< null once it listens
  std::atomic<bool> stopping_ = false;
};

}  // namespace oraclegs

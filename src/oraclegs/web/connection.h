#pragma once
// The connections of the server, limited in number, and their requests in size and duration.

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace oraclegs {

/// The socket of a client as a stream of httplib, which alone limits the length of a line and the pause between two
/// bytes, not the number of lines nor the time of a request. It owns the socket.
class Connection : public httplib::Stream {
 public:
  /// Takes the socket. `stopping` ends all waits when it becomes true.
  Connection(int socket, const std::atomic<bool>& stopping) : socket_(socket), stopping_(stopping) {}
  /// Closes the socket, after reading for a moment what was still sent: otherwise the client might lose the answer.
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the next request, a few seconds; false when none comes. The request's limits begin then.
  bool WaitForRequest();
  /// Lets the request send `bytes` more, its body, in 30 seconds, or longer at 20 kB/s or more.
  void AllowBody(uint64_t bytes);

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, size_t size) override;
  ssize_t write(const char* from, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Waits until the socket is ready for `events`; false at the deadline, or when the server stops.
  bool Wait(short events, Clock::time_point deadline) const;

  int socket_;
  const std::atomic<bool>& stopping_;
  uint64_t bytes_left_ = 0;  ///< bytes that the request may still send
  bool in_body_ = false;
  Clock::time_point request_deadline_, answer_begin_;
  size_t written_ = 0;  ///< bytes written of the answer
};

/// A server of such connections, limited in number. A request with a body or another method than GET and HEAD is the
/// last one of its connection; Range, Expect and Accept-Encoding are ignored. Nothing reads a body but the handler,
/// from the connection that Current gives it. It listens once.
class LimitedServer : public httplib::Server {
 public:
  /// Starts the workers. Throws RunError where the system gives no thread.
  LimitedServer();
  /// The connection whose request this thread serves; null outside of a request.
  static Connection* Current();
  /// Ends the open connections within a moment, so that stop() does not wait for clients.
  void StopConnections() { stopping_ = true; }

 private:
  bool process_and_close_socket(socket_t socket) override;
  void Serve(socket_t socket);

  std::unique_ptr<httplib::TaskQueue> workers_;  ///< null once it listens
  std::atomic<bool> stopping_ = false;
};

}  // namespace oraclegs

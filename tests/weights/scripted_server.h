#pragma once
// A server on the loopback interface that answers each connection with the next of some prepared texts.

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

namespace oraclegs {

class ScriptedServer {
 public:
  explicit ScriptedServer(std::vector<std::string> answers) : answers_(std::move(answers)) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 8), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Serve(); });
  }
  ~ScriptedServer() { Stop(); }

  std::string Url(const std::string& path = "/file") const { return fmt::format("http://127.0.0.1:{}{}", port_, path); }
  /// Ends the server; returns the requests it got, with all headers.
  const std::vector<std::string>& Requests() {
    Stop();
    return requests_;
  }

 private:
  void Serve() {
    for (const std::string& answer : answers_) {
      const int connection = accept(listener_, nullptr, nullptr);
      if (connection < 0) return;
      std::string request;
      char buffer[4096];
      while (request.find("\r\n\r\n") == std::string::npos) {
        const ssize_t n = read(connection, buffer, sizeof buffer);
        if (n <= 0) break;
        request.append(buffer, static_cast<size_t>(n));
      }
      requests_.push_back(request);
      for (size_t sent = 0; sent < answer.size();) {
        const ssize_t n = send(connection, answer.data() + sent, answer.size() - sent, MSG_NOSIGNAL);
        if (n <= 0) break;
        sent += static_cast<size_t>(n);
      }
      shutdown(connection, SHUT_WR);
      while (read(connection, buffer, sizeof buffer) > 0) {
      }
      close(connection);
    }
  }
  void Stop() {
    if (!thread_.joinable()) return;
    shutdown(listener_, SHUT_RDWR);  // wakes a thread that still waits for a connection
    thread_.join();
    close(listener_);
  }

  std::vector<std::string> answers_, requests_;
  int listener_ = -1, port_ = 0;
  std::thread thread_;
};

/// "HTTP/1.1 200 OK", headers ("Name: value"), body.
inline std::string Answer(const std::string& status, const std::vector<std::string>& headers,
                          const std::string& body = "") {
  return fmt::format("HTTP/1.1 {}\r\nConnection: close\r\n{}{}\r\n{}", status, fmt::join(headers, "\r\n"),
                     headers.empty() ? "" : "\r\n", body);
}

/// A whole file.
inline std::string File(const std::string& body, std::vector<std::string> headers = {}) {
  headers.push_back(fmt::format("Content-Length: {}", body.size()));
  return Answer("200 OK", headers, body);
}

}  // namespace oraclegs

#pragma once
// A client that sends whatever bytes a test wants.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

#include "support/temp_dir.h"

namespace oraclegs {

/// A connection to 127.0.0.1.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~RawClient() { close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return connected_; }
  bool Send(const std::string& bytes) const {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t n = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return false;
      sent += static_cast<size_t>(n);
    }
    return true;
  }
  /// Everything received until the server closes, or the head and the body that Content-Length announces.
  std::string Receive() const {
    std::string all;
    std::array<char, 65536> part;
    while (!IsWhole(all)) {
      pollfd wanted{socket_, POLLIN, 0};
      if (poll(&wanted, 1, 20'000) <= 0) break;
      const ssize_t n = recv(socket_, part.data(), part.size(), 0);
      if (n <= 0) break;
      all.append(part.data(), static_cast<size_t>(n));
    }
    return all;
  }

 private:
  static bool IsWhole(const std::string& text) {
    const size_t end = text.find("\r\n\r\n"), length = text.find("Content-Length: ");
    if (end == std::string::npos || length == std::string::npos || length > end) return false;
    return text.size() - end - 4 >= std::stoul(text.substr(length + 16));
  }

  int socket_;
  bool connected_ = false;
};

/// One request of its own connection, with the Host a browser would send.
inline std::string Ask(int port, const std::string& target, const std::string& method = "GET",
                       const std::string& headers = "") {
  const RawClient client(port);
  client.Send(method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + headers +
              "Connection: close\r\n\r\n");
  return client.Receive();
}

inline std::string BodyOf(const std::string& answer) {
  const size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

/// A folder as a server shows it: both documents, an image that they name, and files that they do not.
inline void MakeSite(const std::filesystem::path& root) {
  WriteText(root / "report" / "run.json",
            R"({"format": 1, "title": "t", "views": [{"image": {"url": "report/images/0.jpg"}}],
                "splat": {"url": "../secret.txt"}, "hero": {"url": "options.json\u0000"}, "video": {"url": "link.mp4"}})");
  WriteText(root / "report" / "images" / "0.jpg", "an image");
  WriteText(root / "live" / "state.json",
            R"({"format": 1, "state": "finished", "splat": {"url": "live/splat.splat"}})");
  WriteText(root / "live" / "splat.splat", std::string(64, 's'));
  WriteText(root / "options.json", "private");
  WriteText(root.parent_path() / "secret.txt", "secret");
}

}  // namespace oraclegs

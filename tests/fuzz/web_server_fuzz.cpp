// Bytes of a client on the socket of the viewer's server: each answer is one of HTTP, and the server goes on.

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "fuzz/fuzz.h"
#include "oraclegs/web/connection.h"

namespace {

class EchoServer {
 public:
  EchoServer() {
    server_.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      response.status = 200;
      response.set_content(request.method + request.get_header_value("Host"), "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    port_ = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }
  ~EchoServer() {
    server_.StopConnections();
    server_.stop();
    thread_.join();
  }

  /// Everything that the server sends until it closes the connection.
  std::string Ask(std::string_view bytes) const {
    const int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    // A closed connection keeps its pair of ports for a minute: each comes from another address of this machine.
    static uint32_t count = 0;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + count++ % 60000);
    (void)!bind(client, reinterpret_cast<sockaddr*>(&address), sizeof address);
    address.sin_port = htons(static_cast<uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      const int error = errno;
      close(client);
      if (error == EINTR) return Ask(bytes);  // by the alarm that looks after the time of an input
      oraclegs::fuzz::Fail(std::string("the server is gone: ") + std::strerror(error));
    }
    (void)!send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    shutdown(client, SHUT_WR);
    std::string answer;
    char part[4096];
    for (ssize_t n = 0; (n = recv(client, part, sizeof part, 0)) > 0;) answer.append(part, static_cast<size_t>(n));
    close(client);
    return answer;
  }

 private:
  oraclegs::LimitedServer server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace

ORACLEGS_FUZZ_TARGET(web_server) {
  using namespace oraclegs;
  static const EchoServer server;
  const std::string answer = server.Ask(bytes);
  if (!answer.empty() && !answer.starts_with("HTTP/1.1 ")) fuzz::Fail("no answer of HTTP: " + answer);
}

// The answers of a server of weights, one a part: redirections, headers, sizes, ranges. The first part is what an
// earlier download left.

#include <sys/socket.h>

#include <arpa/inet.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>
#include <thread>

#include "fuzz/fuzz.h"
#include "oraclegs/weights/download.h"

namespace {

using oraclegs::fuzz::Folder;

/// Answers each connection with the next part, and closes it. It is the proxy for every address of every scheme.
class AnsweringServer {
 public:
  AnsweringServer() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    if (bind(listener_, any, size) != 0 || listen(listener_, 8) != 0 || getsockname(listener_, any, &size) != 0) {
      oraclegs::fuzz::Fail("no server");
    }
    const std::string here = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    for (const char* name : {"http_proxy", "https_proxy", "all_proxy"}) setenv(name, here.c_str(), 1);
    for (const char* name : {"no_proxy", "NO_PROXY", "HTTPS_PROXY", "ALL_PROXY"}) unsetenv(name);
    thread_ = std::thread([this] { Serve(); });
  }
  ~AnsweringServer() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }

  void Set(std::vector<std::string_view> answers) {
    const std::lock_guard<std::mutex> guard(mutex_);
    answers_.assign(answers.rbegin(), answers.rend());
  }

 private:
  void Serve() {
    for (int connection = 0; (connection = accept(listener_, nullptr, nullptr)) >= 0; close(connection)) {
      char request[4096];
      if (read(connection, request, sizeof request) <= 0) continue;
      const std::lock_guard<std::mutex> guard(mutex_);
      if (answers_.empty()) continue;
      const std::string answer = answers_.back();
      answers_.pop_back();
      (void)!send(connection, answer.data(), answer.size(), MSG_NOSIGNAL);
      shutdown(connection, SHUT_WR);
    }
  }

  int listener_;
  std::mutex mutex_;
  std::vector<std::string> answers_;  // the next one last
  std::thread thread_;
};

}  // namespace

ORACLEGS_FUZZ_TARGET(download) {
  using namespace oraclegs;
  static const Folder folder;
  static AnsweringServer server;
  std::vector<std::string_view> parts = fuzz::Parts(bytes);
  std::error_code ignored;
  std::filesystem::remove(folder.path() / "f", ignored);
  folder.Put("f.part", parts[0]);
  if (parts[0].empty()) std::filesystem::remove(folder.path() / "f.part", ignored);
  parts.erase(parts.begin());
  server.Set(parts);
  DownloadRequest request;
  request.url = "http://models.example/f?key=1";
  request.to = folder.path() / "f";
  request.bearer = "secret";
  request.stage = "fetch f";
  fuzz::Try<RunError>([&] { Download(request, Silent()); });
}

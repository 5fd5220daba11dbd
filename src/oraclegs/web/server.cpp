#include "oraclegs/web/server.h"

#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/web/assets.h"
#include "oraclegs/web/connection.h"
#include "oraclegs/web/routes.h"
#include "oraclegs/web/site.h"

namespace oraclegs {
namespace {

constexpr int kPortsToTry = 20;
constexpr size_t kChunk = 256 << 10;  // bytes of a file that are sent at once

/// Sends an open file. Returning false makes httplib end the connection.
httplib::ContentProvider ProviderOf(std::shared_ptr<FileBelow> file) {
  return [file = std::move(file)](size_t offset, size_t length, httplib::DataSink& sink) {
    std::string chunk(std::min(length, kChunk), '\0');
    const auto read = file->ReadAt(offset, chunk.data(), chunk.size());
    return read && *read > 0 && sink.write(chunk.data(), *read);
  };
}

void Send(WebAnswer answer, httplib::Response* response) {
  response->status = answer.status;
  for (const auto& [name, value] : answer.headers) response->set_header(name, value);
  if (answer.file && answer.file->size() > 0) {
    const size_t size = answer.file->size();
    response->set_content_provider(size, answer.type, ProviderOf(std::make_shared<FileBelow>(std::move(*answer.file))));
  } else if (!answer.type.empty()) {
    response->set_content(answer.body, answer.type);
  }
}

/// The size that a request says its body has; none for texts that are no number, and for more than one.
std::optional<uint64_t> ContentLength(const httplib::Request& request) {
  if (request.get_header_value_count("Content-Length") != 1 || request.has_header("Transfer-Encoding")) return {};
  const std::string text = request.get_header_value("Content-Length");
  uint64_t bytes = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bytes);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return bytes;
}

WebRequest RequestOf(const httplib::Request& from) {
  WebRequest request{.method = from.method,
                     .path = from.path,
                     .host = from.get_header_value("Host"),
                     .hosts = static_cast<int>(from.get_header_value_count("Host")),
                     .known_tag = from.get_header_value("If-None-Match"),
                     .origin = from.get_header_value("Origin"),
                     .cookie = from.get_header_value("Cookie"),
                     .query = from.params,
                     .content_length = ContentLength(from)};
  Connection* connection = LimitedServer::Current();
  if (connection != nullptr && request.content_length.value_or(0) > 0) {
    connection->AllowBody(*request.content_length);
    request.read = [connection](char* to, size_t count) { return connection->read(to, count); };
  }
  return request;
}

}  // namespace

class WebServer::Impl {
 public:
  Impl(const WebServerOptions& options, WebHandler handler) : host_(options.host) {
    port_ = Bind(options);
    const AllowedHosts hosts(host_, port_);
    // All answers are made here: patterns of httplib are regular expressions, which use stack per byte.
    server_.set_pre_routing_handler(
        [handler = std::move(handler), hosts](const httplib::Request& request, httplib::Response& response) {
          Send(handler(RequestOf(request), hosts), &response);
          return httplib::Server::HandlerResponse::Handled;
        });
    Start();
  }

  ~Impl() {
    server_.StopConnections();
    server_.stop();
    thread_.join();
  }

  int port() const { return port_; }
  const std::string& host() const { return host_; }

 private:
  void Start() {
    const auto listen = [this] {
      try {
        server_.listen_after_bind();
      } catch (const std::exception& error) {  // out of this thread it would end the process
        failure_ = error.what();
      }
      ended_ = true;
    };
    try {
      thread_ = std::thread(listen);
    } catch (const std::system_error& error) {
      throw RunError("the viewer cannot start a thread: {}; end other programs, or raise `ulimit -u`",
                     SystemReason(error.code()));
    }
    while (!server_.is_running() && !ended_) std::this_thread::yield();
    if (!ended_) return;
    thread_.join();
    throw RunError("the viewer's server cannot start: {}", failure_);
  }

  int Bind(const WebServerOptions& options) {
    if (host_.empty() || (host_.front() == '[' && (host_.size() < 3 || host_.back() != ']'))) {
      throw UsageError("--host is '{}'; give a name or an address, such as 127.0.0.1 or [::1]", host_);
    }
    const std::string name = host_.front() == '[' ? host_.substr(1, host_.size() - 2) : host_;
    const auto bind = [&](int port) {
      errno = 0;
      return server_.bind_to_port(name, port);
    };
    if (options.port) {
      if (bind(*options.port)) return *options.port;
      const int error = errno;
      if (error == EADDRINUSE)
        throw UsageError("--port {}: is in use; choose another one, or leave it out", *options.port);
      throw UsageError("--host {} --port {}: cannot be bound to: {}", host_, *options.port, Reason(error));
    }
    int error = 0;
    for (int port = kDefaultWebPort; port < kDefaultWebPort + kPortsToTry; ++port) {
      if (bind(port)) return port;
      error = errno;
      if (error != EADDRINUSE) break;
    }
    if (error == EADDRINUSE) {
      const int any = server_.bind_to_any_port(name);
      if (any > 0) return any;
    }
    throw UsageError("--host {}: cannot be bound to: {}", host_, Reason(error));
  }

  static std::string Reason(int error) {
    return error == 0 ? "there is no such name or address on this machine" : std::strerror(error);
  }

  std::string host_;
  int port_ = 0;
  LimitedServer server_;
  std::atomic<bool> ended_ = false;
  std::string failure_ = "it ended";  ///< reason, read after ended_
  std::thread thread_;
};

WebHandler ViewerOf(const std::filesystem::path& root) {
  return [site = std::make_shared<Site>(root)](const WebRequest& request, const AllowedHosts& hosts) {
    return AnswerTo(request, hosts, site.get());
  };
}

WebServer::WebServer(const WebServerOptions& options, WebHandler handler) {
  if (!WebPagesBuilt()) throw RunError("the viewer is not part of this program: {}", HowToBuildWebPages());
  impl_ = std::make_unique<Impl>(options, std::move(handler));
}

WebServer::~WebServer() = default;

int WebServer::port() const { return impl_->port(); }

std::string WebServer::url() const {
  const std::string& host = impl_->host();
  const std::string shown = IsWildcard(host) ? "127.0.0.1" : host;
  const bool bare_v6 = shown.find(':') != std::string::npos && shown.front() != '[';
  return fmt::format("http://{}:{}/", bare_v6 ? "[" + shown + "]" : shown, impl_->port());
}

}  // namespace oraclegs

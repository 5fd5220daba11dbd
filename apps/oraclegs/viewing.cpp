#include "viewing.h"

#include <chrono>
#include <thread>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/web/browser.h"
#include "oraclegs/web/routes.h"
#include "terminal.h"

namespace oraclegs {
namespace {

constexpr std::chrono::milliseconds kLook(100);

WebServerOptions ServerOptions(const ViewerOptions& options) {
  WebServerOptions server{options.host};
  if (options.port != 0) server.port = options.port;
  return server;
}

}  // namespace

Viewing::Viewing(const std::filesystem::path& root, const ViewerOptions& options, const Listener& listener)
    : server_(ServerOptions(options), ViewerOf(root)) {
  if (!IsLoopback(options.host)) {
    listener(
        Warning{fmt::format("--host {}: everyone who reaches port {} of this machine can look on, without a "
                            "password",
                            options.host, server_.port())});
  }
  const bool opened = options.browser && OpenBrowser(server_.url());
  // Also with --quiet: without the address nobody finds it.
  WriteOut(fmt::format("viewer     {}{}\n", server_.url(), opened ? "" : " (open it in a browser)"));
}

void Viewing::Wait() const {
  while (!InterruptRequested()) std::this_thread::sleep_for(kLook);
}

}  // namespace oraclegs

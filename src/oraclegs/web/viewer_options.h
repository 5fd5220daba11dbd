#pragma once

#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// Address of the viewer.
struct ViewerOptions {
  int port = 0;  ///< 0 = the usual one, or the next free one
  std::string host = "127.0.0.1";
  bool browser = true;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("port", self.port, "Port of the viewer, exactly this one; 0 = 7860, or the next one that is free",
          Range{0, 65535});
    visit("host", self.host,
          "Address the viewer is served at; any other than this machine's own, such as 0.0.0.0, lets everyone who "
          "reaches it look on");
    visit("browser", self.browser, "Open the viewer in a browser where there is one");
  }
};

}  // namespace oraclegs

#include "oraclegs/core/host.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace oraclegs {

const std::string& HostName() {
  static const std::string host = [] {
    std::array<char, 65> text{};  // the kernel's longest, and its end
    std::string name;
    if (gethostname(text.data(), text.size() - 1) == 0) name = text.data();
    const auto is_odd = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) == 0 && std::strchr("._-", c) == nullptr;
    };
    std::replace_if(name.begin(), name.end(), is_odd, '_');
    return name.empty() ? std::string("unknown") : name;
  }();
  return host;
}

}  // namespace oraclegs

#pragma once

#include <string>

#include "oraclegs/baselines/settings.h"
#include "oraclegs/core/options.h"

namespace oraclegs {

/// Published method whose densifier and parts the training has (baselines/methods.h).
struct MethodOptions {
  std::string method;  ///< "" = this program's own training

  /// Settings of the method; those of none where it is not given. Throws UsageError for a word that is none.
  BaselineSettings Settings() const;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("method", self.method,
          "Densify and regularize as this published method does; `oraclegs bench` sets it together with the other "
          "options of the method (docs/baselines.md)",
          Tier::kSetting);
  }
};

}  // namespace oraclegs

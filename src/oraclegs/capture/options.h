#pragma once
// How photos are taken out of what people bring.

#include "oraclegs/core/options.h"

namespace oraclegs {

inline constexpr int kUsualFrames = 24;  ///< taken out of a video unless --frames says otherwise

struct CaptureOptions {
  Auto<int> frames;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("frames", self.frames, "Photos to take out of a video, the sharpest of as many equal parts of it; auto = 24",
          Range{3, 500});
  }
};

}  // namespace oraclegs

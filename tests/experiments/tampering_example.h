#pragma once

#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// A report of two seeds and two shares.
inline TamperingReport TamperingExample() {
  TamperingReport r;
  r.scene = "fox", r.command = "oraclegs ablate fox", r.version = "1.2.3";
  r.train_views = 12, r.test_views = 7, r.proposals = 31, r.width = 135, r.height = 240;
  r.iterations = 2000, r.max_gaussians = 30000;
  r.seeds = {0, 1};
  const auto runs = [](TamperingTrust trust, double first, double second) {
    return std::vector<TamperingRun>{{0, trust, "runs/a", first}, {1, trust, "runs/b", second}};
  };
  const auto add = [&](int percent, std::array<double, 6> psnr, std::vector<TamperedConfidence> confidence) {
    TamperingShare share{percent, {}, std::move(confidence)};
    for (size_t t = 0; t < 3; ++t) {
      for (TamperingRun& run : runs(static_cast<TamperingTrust>(t + 1), psnr[2 * t], psnr[2 * t + 1])) {
        share.runs.push_back(run);
      }
    }
    r.shares.push_back(share);
  };
  r.none = runs(TamperingTrust::kNone, 23, 25);
  add(0, {25, 25, 24, 25, 25, 25}, {{0, 0, 0, {}, {}, {}, 0.8}, {1, 0, 0, {}, {}, {}, 0.8}});
  add(30, {20, 21, 23, 24, 24, 25}, {{0, 0.301, 12, 0.88, 0.7, 0.1, 0.5}, {1, 0.302, 14, 0.92, {}, 0.2, 0.7}});
  r.shares[1].confidence[0].auroc_of_kind[1] = 0.9, r.shares[1].confidence[1].auroc_of_kind[1] = 0.95;
  r.notes = {"A note."};
  return r;
}

}  // namespace oraclegs

#pragma once
// What a proposer is to a run: a row, of which proposers/proposer_rows.cpp has the list.

#include <string>
#include <vector>

#include "oraclegs/propose/proposers.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// A proposer with everything that stages ask of it. Functions may be null where nothing is said.
struct ProposerRow {
  std::string word;            ///< that of KnownProposers (propose/options.h)
  bool can_hold_out = false;   ///< answers at a training view without that view, which teaches the oracle its errors
  bool sees_anything = false;  ///< paints places that the photos hardly show, and needs no depth
  bool stands_in = false;      ///< asked where no other one can hold a view out
  const char* non_commercial = "";  ///< network whose license forbids commercial use, also of what it makes
  /// Size at which it generates a view of the given size; null = of any size.
  PixelSize (*own_size)(const Run& run, PixelSize view) = nullptr;
  /// Adds what proposals depend on beside the options of proposers, poses and images.
  void (*own)(const Run& run, Fingerprint* key) = nullptr;
  /// Has something paint all targets at once, before the proposers are made. `key`: that of stage "propose".
  void (*prepare)(Run* run, const std::string& key) = nullptr;
  /// The proposers; empty where the run cannot have them. `warper` outlives them.
  std::vector<AskedProposer> (*make)(const Run& run, const Warper& warper) = nullptr;
  /// Removes what an earlier run left below proposals/.
  void (*undo)(const std::filesystem::path& proposals) = nullptr;
  /// Removes what was kept below proposals/ so that an interrupted stage could go on.
  void (*finish)(const std::filesystem::path& proposals) = nullptr;
};

/// Dense points without which there is nothing to warp to a new view, and views, of which two show a surface and one is
/// held out.
inline constexpr size_t kMinPointsToPropose = 1000, kMinViewsToPropose = 3;
/// True where stereo found enough to propose from.
bool CanPropose(const TrainingViews& training, const Geometry& geometry);

/// How many views the run's own proposers make, and where. proxies_alone: as ProxiesAlonePropose.
TargetPlan TargetPlanOf(const Run& run, bool proxies_alone);

/// True where proxy models alone propose, once stage "proxies" has run. False where there were too few views or points
/// for them, and views are warped instead.
bool ProxiesAlonePropose(const Run& run);

/// True when the run asks this proposer.
bool Asks(const Run& run, const ProposerRow& row);
/// True when one of the run's proposers sees_anything.
bool AsksGenerator(const Run& run);

/// The proposers of the run's rows, made when they are first asked for; they take its proxy models.
const Proposers& ProposersOf(Run* run);

}  // namespace oraclegs

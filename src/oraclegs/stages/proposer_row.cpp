#include "oraclegs/stages/proposer_row.h"

#include <algorithm>
#include <iterator>

#include "oraclegs/settings/from_results.h"

namespace oraclegs {
namespace {

std::unique_ptr<Warper> WarperOf(Run* run) {
  const TrainingViews& training = ViewsOf(run);
  const Geometry& geometry = run->results->geometry;
  WarpSources sources{
      training.views, geometry.maps, {}, &training.silhouettes, BackgroundColor(run->plan.image.background)};
  if (geometry.HasVariedExposure()) sources.gains = geometry.gains;
  return std::make_unique<Warper>(std::move(sources), run->plan.device);
}

/// The proposers of all rows that are wanted; beside one that sees anything, those that need depth paint only where
/// there is enough of it. Where none can hold a view out, another one stands in: to teach the oracle, and to paint
/// where one that could was wanted and could not be made.
std::vector<AskedProposer> Members(Run* run, const Warper& warper) {
  const std::vector<ProposerRow>& rows = *run->proposer_rows;
  const bool has_depth = !AsksGenerator(*run) || CanPropose(ViewsOf(run), run->results->geometry);
  std::vector<std::vector<AskedProposer>> made(rows.size());
  bool taught = false, missed = false;
  for (size_t r = 0; r < rows.size(); ++r) {
    if (!Asks(*run, rows[r])) continue;
    made[r] = rows[r].make(*run, warper);
    for (AskedProposer& member : made[r]) member.paints = rows[r].sees_anything || has_depth;
    taught = taught || (rows[r].can_hold_out && !made[r].empty());
    missed = missed || (rows[r].can_hold_out && made[r].empty());
  }
  std::vector<AskedProposer> members;
  for (size_t r = 0; r < rows.size(); ++r) {
    if (!taught && rows[r].stands_in) {
      made[r] = rows[r].make(*run, warper);
      for (AskedProposer& member : made[r]) member.paints = missed && has_depth;
    }
    std::move(made[r].begin(), made[r].end(), std::back_inserter(members));
  }
  return members;
}

}  // namespace

bool CanPropose(const TrainingViews& training, const Geometry& geometry) {
  return geometry.points.size() >= kMinPointsToPropose && training.views.size() >= kMinViewsToPropose;
}

TargetPlan TargetPlanOf(const Run& run, bool proxies_alone) {
  const std::vector<Camera> train = WorkingCameras(run.scene, run.split.train, run.plan.image);
  const double openness = AsksGenerator(run) ? 1 : Openness(run.results->geometry.points, train);
  return SettleTargets(run.options.trajectory, proxies_alone, {static_cast<int>(train.size()), openness});
}

bool ProxiesAlonePropose(const Run& run) {
  return run.options.propose.ByProxiesAlone() && !run.workspace.Record("proxies").is_null();
}

bool Asks(const Run& run, const ProposerRow& row) { return run.plan.Uses(run.options, row.word); }

bool AsksGenerator(const Run& run) {
  return std::any_of(run.proposer_rows->begin(), run.proposer_rows->end(),
                     [&](const ProposerRow& row) { return row.sees_anything && Asks(run, row); });
}

const Proposers& ProposersOf(Run* run) {
  StageResults& known = *run->results;
  if (!known.proposers) {
    std::unique_ptr<Warper> warper = WarperOf(run);
    std::vector<AskedProposer> members = Members(run, *warper);
    known.proposers = std::make_shared<const Proposers>(std::move(warper), std::move(members));
  }
  return *known.proposers;
}

}  // namespace oraclegs

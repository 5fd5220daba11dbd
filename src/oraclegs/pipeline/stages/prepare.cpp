#include "oraclegs/pipeline/stages/prepare.h"

#include "oraclegs/pipeline/stages/start_points.h"
#include "oraclegs/pipeline/stages/train_inputs.h"

namespace oraclegs {

Preparation Prepare(Run* run) {
  Preparation prepared;
  prepared.sfm = RunSfm(run);
  prepared.photos = LoadViews(run->scene, run->split.train, run->options.photo, run->listener);
  if (NeedsDepth(run->options)) prepared.geometry = RunDepth(run, prepared.photos, prepared.sfm);
  prepared.decided = DecideOptions(run->options.train, prepared.photos, prepared.geometry, run->listener);
  return prepared;
}

}  // namespace oraclegs

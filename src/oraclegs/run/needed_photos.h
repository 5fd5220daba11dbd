#pragma once
// Choice of the photos that a run uses, among many without poses.

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Removes from run->scene the photos that neither train nor test, when poses are to be found for so many photos that
/// not all pairs are matched. The split is then settled in run->needed and reported to `listener`. Throws InputError as
/// SplitViews does.
void KeepNeededPhotos(Run* run, const Listener& listener);

/// Split of run->scene: run->needed for the views that it has, else that of SplitViews. Throws InputError when fewer
/// than two training views are left.
Split SplitOfRun(const Run& run);

}  // namespace oraclegs

#pragma once
// Choice of the photos that a run asks for, among many without poses.

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Leaves out of run->scene what neither trains nor tests, where poses are to be found for so many photos that not all
/// pairs are matched; the split is then settled in run->needed, and it is reported to `listener`. Throws InputError as
/// SplitViews does.
void KeepNeededPhotos(Run* run, const Listener& listener);

/// The split of run->scene: what run->needed says of the views that it has, else as SplitViews does. Throws InputError
/// when fewer than two training views are left.
Split SplitOfRun(const Run& run);

}  // namespace oraclegs

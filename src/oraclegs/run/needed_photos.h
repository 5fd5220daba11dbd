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

// Checks of photos without poses, before they are registered: photo_checks.json.

/// Warns of photos that look unfit (capture/photo_checks.h) and removes from the scene those that cannot be decoded.
/// The findings are stored in the workspace and reported again when the run is continued. Does nothing for a scene with
/// poses. Throws InputError naming a photo that cannot be decoded when fewer than three others can.
void CheckRunPhotos(Run* run);

/// Removes the photos that CheckRunPhotos removed, for a run that is only opened.
void LeaveOutUnreadablePhotos(Run* run);

}  // namespace oraclegs

#pragma once
// Checks of photos without poses, before they are registered: photo_checks.json.

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Warns of photos that look unfit (capture/photo_checks.h) and removes from the scene those that cannot be decoded.
/// The findings are stored in the workspace and reported again when the run is continued. Does nothing for a scene with
/// poses. Throws InputError naming a photo that cannot be decoded when fewer than three others can.
void CheckRunPhotos(Run* run);

/// Removes the photos that CheckRunPhotos removed, for a run that is only opened.
void LeaveOutUnreadablePhotos(Run* run);

}  // namespace oraclegs

#pragma once
// Photos without poses are looked at before they are registered: photo_checks.json.

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Warns of photos that look unfit (capture/photo_checks.h) and leaves those out of the scene that cannot be decoded.
/// What was found is kept in the workspace and said again when the run is continued. Does nothing for a scene with
/// poses. Throws InputError naming a photo that cannot be decoded when fewer than three others can.
void CheckRunPhotos(Run* run);

/// Leaves out what CheckRunPhotos left out, for a run that is only opened.
void LeaveOutUnreadablePhotos(Run* run);

}  // namespace oraclegs

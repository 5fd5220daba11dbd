#pragma once
// Mask files: white pixels of the photo are used, black ones are ignored.

#include "oraclegs/core/progress.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Which pixels of a photo the view's mask file keeps: one channel, 255 or 0, in a size of the photo's aspect.
/// `width`, `height`: of the photo as it is read in `orientation`; a mask that was drawn on it in its other EXIF
/// orientation is turned. Throws InputError for a mask that cannot be read or has another aspect.
Image8 ReadMask(const SceneView& view, int width, int height, Orientation orientation);

/// Looks at all masks of a scene before anything else is done with them; each is decoded once. Sets
/// SceneView::mask_white where the masks are of 0 and one small value, with a note. Warns of photos without a mask
/// where others have one, of masks that look inverted or may be upside down, and notes those that are scaled to their
/// photos. Throws InputError naming the file: unreadable, of another aspect than its photo, without a white pixel, or
/// of several small values.
void CheckMasks(Scene* scene, const Listener& listener);

/// Leaves the scene's masks out where others are used, with a note.
void DropMasks(Scene* scene, const Listener& listener);

}  // namespace oraclegs

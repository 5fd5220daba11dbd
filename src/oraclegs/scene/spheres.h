#pragma once
// Spherical photos (equirectangular, 360 x 180 degrees) in a scene, and those of fisheye lenses that one pinhole view
// cannot show (camera/fisheye_lens.h): which photos are some, and the views that stand for them, of which each sees a
// part as a pinhole camera does.

#include <filesystem>

#include "oraclegs/core/enum_words.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Marks the photos of a scene without poses that are spheres: of an aspect of exactly 2:1, and kMarked by their
/// metadata (image/gpano.h), or kAll of them. Reads headers; a file that cannot be read is none.
void MarkSpheres(SphereChoice choice, Scene* scene);

/// Throws InputError naming the first sphere or wide fisheye photo, for a command that cannot cut it.
void RequireNoSpheres(const Scene& scene);

/// Puts views (camera/sphere_faces.h) in the place of each sphere and of each wide fisheye photo, whose images and
/// masks lie below `dir`, or will: nothing is written, and read are headers, and up to three fisheye photos of each
/// lens, for where its image circle ends. A sphere has six, a fisheye photo those that it fills, with masks of what it
/// shows. They have the photo's pose, turned, or without poses a sphere's exact focal length as SceneView::focal_prior.
/// Points that a photo saw are seen by those of its views that they fall into. A note to `listener` says what is cut.
/// Throws InputError for a sphere that is not twice as wide as high, and for more views without poses than can be put
/// together (kMaxPhotos).
void TakeFaces(const std::filesystem::path& dir, const Listener& listener, Scene* scene);

/// The indices in `views`, ascending, by the photo that they show: the faces of one photo are together, and each other
/// view is alone. In the order of the first ones.
std::vector<std::vector<int>> ByPhoto(const Scene& scene, const std::vector<int>& views);

}  // namespace oraclegs

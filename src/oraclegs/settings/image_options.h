#pragma once

#include <string>

#include "oraclegs/core/options.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// ImageOptions as the user asks for them.
struct AutoImageOptions {
  Auto<int> downscale;
  Auto<int> max_size;
  SmallerCopies smaller_copies = SmallerCopies::kWhereFound;
  ResizeFilter resize = ResizeFilter::kArea;
  Auto<Background> background;
  SphereChoice spheres = SphereChoice::kMarked;

  /// With full size and black where nothing chose otherwise (run_size.h does for a run).
  ImageOptions Settled() const {
    return {downscale.ValueOr(1), max_size.ValueOr(0), smaller_copies, resize, background.ValueOr(Background::kBlack)};
  }

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("max-size", self.max_size,
          "Pixels of the photos' longer side; larger photos are reduced. auto = by --quality and device: 1000 on a CPU "
          "and 1600 on a GPU for normal; no limit where --downscale is given, or a scene is looked at without a run; "
          "0 = full size",
          Range{0, 1e6});
    visit("downscale", self.downscale,
          "Divide the photos' size by this (antialiased; an existing images_N folder is used); auto = see --max-size",
          Range{1, 64});
    visit("smaller-copies", self.smaller_copies,
          "For --downscale N: auto = the dataset's own images_N where it has one, else the photos, resized; required = "
          "an error where there is none, for scores that compare with published ones",
          Tier::kSetting);
    visit("resize", self.resize,
          "Filter that reduces the photos, training and test photos alike: area = exact averages of areas; pillow = "
          "Pillow's bicubic filter at 8 bits, with which the scores of papers are made",
          Tier::kSetting);
    visit("background", self.background,
          "Color behind transparent pixels and behind the scene; auto = white where the photos show something before "
          "plain white, else black");
    visit("spheres", self.spheres,
          "Which photos without poses are equirectangular, 360 x 180 degrees, and are cut into views: marked = those "
          "whose metadata says so (GPano), as 360 degree cameras write it; all = every one twice as wide as high",
          Tier::kSetting);
  }
};

/// Masks of the photos, where a program makes them.
struct MaskOptions {
  std::string masks;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("masks", self.masks,
          "Shell command of a program that masks the photos: from the folder {request}, with each photo as NAME.png, "
          "into the folder {answer}, one image of the same name for each, white where the photo is used, black where "
          "it is ignored, e.g. \"python3 my_masks.py {request} {answer}\". Masks beside the photos are not used then "
          "(docs/formats.md#masks-by-a-command)");
  }
};

}  // namespace oraclegs

#pragma once
// Proposals from a folder, made by another generator.

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/propose/folder_layout.h"

namespace oraclegs {

struct FolderProposals {
  std::vector<Proposal> proposals;             ///< source "folder", each name once
  std::vector<std::vector<float>> confidence;  ///< per proposal, height * width, [0, 1], 1 = trust; empty = none
};

/// Reads one of two layouts:
///   transforms.json   the images it names, with its poses; optional confidence/NAME.png (255 = trust)
///   synthetic_N/      dir itself, or the only such folder in it: images named like the scene's views, with the
///                     views' poses; optional synthetic_N_attention_maps/NAME.png
/// An image named after a view gets the view's size; another one the working size if it has that shape, or else keeps
/// its shape with at most as many pixels. Images are resized by area, confidence maps with them. An image named after a
/// view whose shape (width to height) is up to 6 % off the view's shows the middle of it, as generators crop images to
/// multiples of 64 pixels: its camera is cropped likewise, and a Note says so.
/// Skipped, each reason with one Warning that counts and names: no image file, not readable, no pose, a camera model
/// that is no pinhole, a shape more than 1 % off its camera's or 6 % off its view's, a repeated name, and the pose or
/// the name of a test view. Confidence that is missing for some, not readable, not gray, or of a shape more than 6 %
/// off its image's is dropped with a Warning. One more Warning when nothing is left. Throws InputError: no folder, no
/// images, several synthetic_N, a damaged transforms.json.
FolderProposals ReadProposalFolder(const std::filesystem::path& dir, const FolderRequest& request,
                                   const Listener& listener);

}  // namespace oraclegs

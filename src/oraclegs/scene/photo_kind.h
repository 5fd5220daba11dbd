#pragma once
// Which files and folders are photos, and which lie beside photos and look like them.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// True for the name of a folder beside photos that holds none of them: masks, depth maps, confidence, thumbnails, and
/// the smaller copies images_2/, images_4/, ... Never for a name that begins with "_".
bool IsHelperFolder(const std::string& name);

/// Why a file that looks like a photo or video of another kind is not read, and what to do: "raw photos are not read;
/// export them as JPEG"; empty for all other files. By name.
std::string WhyNotRead(const std::filesystem::path& path);

/// True for a file that begins with `head` (kImageHeadBytes of it) when that is an image, whatever its name; not for
/// thumbnails and backups, by their names, nor for a TIFF file with an extension of its own: raw photos are such.
bool IsPhotoByContent(const std::filesystem::path& name, std::string_view head);

/// IsPhotoByContent of a file on the disk; false when it cannot be read.
bool IsPhotoByContent(const std::filesystem::path& file);

/// Removes from `photos`, and returns, images that go with photos of the list and are none: masks, depth maps,
/// thumbnails by name (frame_1.jpg with depth_1.png, conf_1.png, frame_1_mask.png); images of one channel that are
/// named as photos in another folder; PNG of 16 bits and one channel among colored photos; tables of a splat (SOG).
/// Keeps the order.
std::vector<std::filesystem::path> TakeCompanions(std::vector<std::filesystem::path>* photos);

}  // namespace oraclegs

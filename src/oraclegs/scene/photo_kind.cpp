#include "oraclegs/scene/photo_kind.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

struct UnreadKind {
  const char* reason;
  std::vector<std::string_view> extensions;
};

const std::vector<UnreadKind>& UnreadKinds() {
  static const std::vector<UnreadKind> kinds = {
      {"raw photos are not read; export them as JPEG",
       {".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".srf", ".sr2", ".dng", ".orf", ".rw2", ".raf", ".pef", ".srw",
        ".raw", ".gpr", ".rwl", ".3fr", ".fff", ".iiq", ".erf", ".dcr", ".kdc", ".mef", ".mos", ".x3f", ".mrw"}},
      {"videos beside photos are not read; name the video itself to take photos out of it",
       {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mts", ".m2ts", ".3gp", ".wmv", ".mpg", ".mpeg", ".insv"}},
      {"this kind of image is not read; save it as JPEG or PNG",
       {".gif", ".bmp", ".psd", ".svg", ".pdf", ".jp2", ".jxl", ".jxr", ".exr", ".hdr", ".tga", ".ppm", ".pgm", ".eps",
        ".ai", ".ico", ".insp", ".jps", ".xcf"}}};
  return kinds;
}

template <class Names>
bool Contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// "lowresDepth_004" as "lowres", "depth", "004".
Words WordsOf(const std::string& name) {
  enum Kind { kNone, kDigit, kLower, kUpper };
  Words words;
  Kind before = kNone;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const Kind kind = std::isdigit(byte)                   ? kDigit
                      : std::isupper(byte)                 ? kUpper
                      : std::isalpha(byte) || byte >= 0x80 ? kLower
                                                           : kNone;
    const bool goes_on = kind == before || (before == kUpper && kind == kLower);
    if (kind != kNone && !goes_on) words.emplace_back();
    if (kind != kNone) words.back() += static_cast<char>(std::tolower(byte));
    before = kind;
  }
  return words;
}

bool IsPhotoWord(std::string_view word) {
  static constexpr std::array<std::string_view, 8> kWords = {"frame", "rgb", "color", "colour",
                                                             "image", "img", "photo", "pic"};
  return Contains(kWords, word);
}

/// Words for images that say what the pixels of a photo are.
bool IsMapWord(std::string_view word) {
  static constexpr std::array<std::string_view, 18> kWords = {
      "mask",       "masks",     "depth",      "depths",       "depthmap",      "depthmaps",
      "confidence", "thumbnail", "thumbnails", "disparity",    "disparities",   "thumb",
      "thumbs",     "semantic",  "semantics",  "segmentation", "segmentations", "matte"};
  return Contains(kWords, word);
}

/// Those of a photo, too, when they are all of a name.
bool IsShortMapWord(std::string_view word) {
  static constexpr std::array<std::string_view, 13> kWords = {"masked", "conf",   "confs",      "normal", "normals",
                                                              "seg",    "segs",   "label",      "labels", "alpha",
                                                              "alphas", "mattes", "confidences"};
  return Contains(kWords, word);
}

/// The words of a name that say nothing of the kind of image; equal for a photo and its maps.
std::string KeyOf(const fs::path& path, bool* is_map) {
  std::string key;
  *is_map = false;
  for (const std::string& word : WordsOf(path.stem().string())) {
    if (IsMapWord(word) || IsShortMapWord(word)) {
      *is_map = true;
    } else if (!IsPhotoWord(word) && !HasImageExtension("x." + word)) {  // IMG_1.jpg.mask.png
      key += word + " ";
    }
  }
  return key;
}

bool IsSogTable(const fs::path& path) {
  static constexpr std::array<std::string_view, 7> kTables = {
      "means_l.webp", "means_u.webp", "quats.webp", "scales.webp", "sh0.webp", "shN_centroids.webp", "shN_labels.webp"};
  std::error_code error;
  return Contains(kTables, path.filename().string()) && fs::exists(path.parent_path() / "meta.json", error);
}

/// Moves what `is_companion` to the second list.
template <class IsCompanion>
void SetApart(std::vector<fs::path>* photos, std::vector<fs::path>* companions, const IsCompanion& is_companion) {
  const auto others = std::stable_partition(photos->begin(), photos->end(),
                                            [&](const fs::path& photo) { return !is_companion(photo); });
  std::move(others, photos->end(), std::back_inserter(*companions));
  photos->erase(others, photos->end());
}

void TakeMapsByName(std::vector<fs::path>* photos, std::vector<fs::path>* companions) {
  std::set<std::pair<fs::path, std::string>> keys;  // of photos that have no such word
  for (const fs::path& photo : *photos) {
    bool is_map = false;
    const std::string key = KeyOf(photo, &is_map);
    if (!is_map) keys.insert({photo.parent_path(), key});
  }
  SetApart(photos, companions, [&](const fs::path& photo) {
    bool is_map = false;
    const std::string key = KeyOf(photo, &is_map);
    const bool is_of_all = key.empty() && IsMapWord(Lower(photo.stem().string()));  // thumbnail.jpg, mask.png
    return is_map && (is_of_all ? !keys.empty() : keys.count({photo.parent_path(), key}) > 0);
  });
}

void TakeMapsByPixels(std::vector<fs::path>* photos, std::vector<fs::path>* companions) {
  std::map<fs::path, int> bits;
  std::set<std::string> colored;  // stems
  for (const fs::path& photo : *photos) {
    const int gray = PngGrayBits(ReadHead(photo, kPngHeaderBytes));
    if (gray > 0) bits[photo] = gray;
    if (gray == 0) colored.insert(photo.stem().string());
  }
  SetApart(photos, companions, [&](const fs::path& photo) {
    const auto gray = bits.find(photo);
    if (gray == bits.end() || colored.empty()) return false;
    return gray->second == 16 || colored.count(photo.stem().string()) > 0;
  });
}

}  // namespace

bool IsHelperFolder(const std::string& name) {
  constexpr std::string_view kSmaller = "images_";
  if (name.starts_with("_")) return name == "__MACOSX";
  if (name == "@eaDir" || name == "$RECYCLE.BIN") return true;  // of a Synology, of Windows
  if (name.starts_with(kSmaller) && name.size() > kSmaller.size() &&
      std::all_of(name.begin() + kSmaller.size(), name.end(), [](unsigned char c) { return std::isdigit(c); })) {
    return true;
  }
  static constexpr std::array<std::string_view, 14> kEndings = {"map",     "maps",    "image", "images", "frames",
                                                                "png",     "raw",     "vis",   "viz",    "color",
                                                                "colored", "preview", "gt",    "pred"};
  Words words = WordsOf(name);  // "lowres_depth_maps", but not "depth_test_photos"
  const bool is_plain = words.size() == 1 || (words.size() == 2 && words[1].starts_with("map"));
  if (is_plain && IsShortMapWord(words[0])) return true;
  while (!words.empty() &&
         (Contains(kEndings, words.back()) || std::isdigit(static_cast<unsigned char>(words.back()[0]))))
    words.pop_back();
  return !words.empty() && IsMapWord(words.back());
}

std::string WhyNotRead(const fs::path& path) {
  const std::string extension = Lower(path.extension().string());
  for (const UnreadKind& kind : UnreadKinds()) {
    if (Contains(kind.extensions, extension)) return kind.reason;
  }
  return "";
}

bool IsPhotoByContent(const fs::path& name, std::string_view head) {
  static constexpr std::array<std::string_view, 10> kOthers = {".thm", ".insp", ".jps",  ".bak",        ".orig",
                                                               ".old", ".tmp",  ".part", ".crdownload", ".download"};
  if (!IsImage(head)) return false;
  const std::string extension = Lower(name.extension().string());
  if (HasImageExtension(name)) return true;
  if (IsTiff(head)) return extension.empty();  // raw photos of many makers are TIFF files
  const bool is_backup = extension.ends_with("~") || extension.ends_with("_original");  // the latter of ExifTool
  return !is_backup && !Contains(kOthers, extension);
}

bool IsPhotoByContent(const fs::path& file) { return IsPhotoByContent(file, ReadHead(file, kImageHeadBytes)); }

std::vector<fs::path> TakeCompanions(std::vector<fs::path>* photos) {
  std::vector<fs::path> companions;
  SetApart(photos, &companions, IsSogTable);
  TakeMapsByName(photos, &companions);
  TakeMapsByPixels(photos, &companions);
  return companions;
}

}  // namespace oraclegs

#include "oraclegs/scene/named_files.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <unordered_map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fold_name.h"
#include "oraclegs/scene/photo_kind.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxFolderDepth = 12;     // below the scene's folder
constexpr size_t kMaxListed = 1000000;  // files and folders
constexpr size_t kMaxPathParts = 32;    // the last ones count
constexpr int kManyFiles = -1;          // in an index: not unique

/// How a file was found.
enum Way : unsigned { kAsWritten = 0, kSlashes = 1, kEnd = 2, kFolded = 4, kExtension = 8 };

/// The folders and the name of a path, without "." and "..".
std::vector<std::string> PartsOf(const std::string& path) {
  std::vector<std::string> parts = SplitTrimmed(path, '/');
  std::erase_if(parts, [](const std::string& part) { return part == "." || part == ".."; });
  if (parts.size() > kMaxPathParts) parts.erase(parts.begin(), parts.end() - kMaxPathParts);
  return parts;
}

std::string WithoutExtension(const std::string& path) {
  const size_t dot = path.find_last_of("./");
  return dot == std::string::npos || path[dot] == '/' || dot == 0 ? path : path.substr(0, dot);
}

/// The images below a folder, by the ends of their paths.
class ImageIndex {
 public:
  /// Folders of masks and the like are left out unless `wanted` (folded) has their name.
  ImageIndex(const fs::path& folder, const std::set<std::string>& wanted) : wanted_(wanted) { List(folder, "", 0); }

  struct Match {
    int file = kManyFiles;
    unsigned ways = kAsWritten;
  };

  /// The file of the longest end of `parts`; no more than `max_dropped` parts are left out at its front, and at least
  /// `min_parts` remain. Then `whole` asks that the file has no other folders.
  Match Find(const std::vector<std::string>& parts, size_t max_dropped, size_t min_parts, bool whole) const {
    for (size_t dropped = 0; dropped <= max_dropped && dropped + min_parts <= parts.size(); ++dropped) {
      const std::string end =
          fmt::format("{}", fmt::join(parts.begin() + static_cast<ptrdiff_t>(dropped), parts.end(), "/"));
      const std::string folded = FoldName(end);
      const std::pair<const Ends*, std::string> tries[] = {
          {&exact_, end}, {&folded_, folded}, {&stems_, WithoutExtension(folded)}};
      for (unsigned t = 0; t < std::size(tries); ++t) {
        const auto found = tries[t].first->find(tries[t].second);
        if (found == tries[t].first->end()) continue;
        const bool fits =
            found->second != kManyFiles && (!whole || files_[static_cast<size_t>(found->second)].parts == parts.size());
        if (!fits) return {};
        return {found->second, (dropped > 0 ? kEnd : 0u) | (t == 1 ? kFolded : 0u) | (t == 2 ? kExtension : 0u)};
      }
    }
    return {};
  }

  const std::string& NameOf(int file) const { return files_[static_cast<size_t>(file)].name; }

 private:
  using Ends = std::unordered_map<std::string, int>;
  struct File {
    std::string name;
    size_t parts = 0;
  };

  bool IsPassedOver(const fs::path& dir, const std::string& name) const {
    if (wanted_.count(FoldName(name)) > 0) return false;
    return name.starts_with(".") || IsHelperFolder(name) || IsFile(dir / "stages.json");
  }

  void Add(const std::string& name, const std::vector<size_t>& starts) {
    const int file = static_cast<int>(files_.size());
    files_.push_back({name, starts.size()});
    const auto put = [&](Ends* ends, const std::string& end) {
      const auto [it, is_new] = ends->emplace(end, file);
      if (!is_new) it->second = kManyFiles;
    };
    for (const size_t start : starts) {
      const std::string end = name.substr(start), folded = FoldName(end);
      put(&exact_, end);
      put(&folded_, folded);
      put(&stems_, WithoutExtension(folded));
    }
  }

  void List(const fs::path& dir, const std::string& prefix, int depth) {
    std::error_code error;
    const fs::path real = fs::canonical(dir, error);
    if (error || !seen_.insert(real).second) return;  // a link to a folder is followed once
    std::vector<size_t> starts{0};
    for (size_t i = 0; i < prefix.size(); ++i) {
      if (prefix[i] == '/') starts.push_back(i + 1);
    }
    std::vector<fs::directory_entry> entries;
    fs::directory_iterator it(dir, error);
    for (; !error && it != fs::directory_iterator() && listed_ < kMaxListed; it.increment(error), ++listed_) {
      entries.push_back(*it);
    }
    const auto rank = [](const fs::directory_entry& entry) {  // folders before the links that lead to them
      std::error_code ignored;
      return std::pair(entry.is_symlink(ignored), entry.path().native());
    };
    std::sort(entries.begin(), entries.end(),
              [&](const fs::directory_entry& a, const fs::directory_entry& b) { return rank(a) < rank(b); });
    for (const fs::directory_entry& entry : entries) {
      const std::string name = entry.path().filename().string();
      std::error_code ignored;
      if (entry.is_directory(ignored)) {
        if (depth < kMaxFolderDepth && !IsPassedOver(entry.path(), name))
          List(entry.path(), prefix + name + "/", depth + 1);
      } else if (HasImageExtension(entry.path()) && entry.is_regular_file(ignored)) {
        Add(prefix + name, starts);
      }
    }
  }

  const std::set<std::string>& wanted_;
  std::set<fs::path> seen_;
  size_t listed_ = 0;
  std::vector<File> files_;
  Ends exact_, folded_, stems_;
};

/// One query being answered.
class NamedFilesSearch {
 public:
  explicit NamedFilesSearch(const NamedFilesQuery& query)
      : query_(query), files_(query.written.size()), ways_(query.written.size(), kAsWritten) {}

  std::vector<NamedFile> Run(const Listener& listener) {
    for (size_t i = 0; i < files_.size(); ++i) FindAsWritten(i);
    if (std::any_of(files_.begin(), files_.end(), [](const NamedFile& file) { return file.path.empty(); })) {
      FindByEnds();
    }
    for (const auto& [i, path] : outside_) {
      if (files_[i].path.empty()) files_[i].path = path;  // refused, or allowed, by who knows
    }
    DropShared();
    Report(listener);
    return std::move(files_);
  }

 private:
  fs::path At(const std::string& written) const {
    if (query_.at) return query_.at(written);
    fs::path path = query_.folder / written;
    return IsFile(path) ? path : fs::path();
  }

  /// True unless an absolute path leads to another place of this machine, which a scene that was moved also has.
  bool MayStand(const std::string& written, const fs::path& path) const {
    return query_.allow_outside || !fs::path(written).is_absolute() || LiesIn(query_.folder, path);
  }

  void FindAsWritten(size_t i) {
    const std::string& written = query_.written[i];
    fs::path path = At(written);
    if (path.empty()) {
      const std::string slashes = WithSlashes(written);
      if (slashes == written) return;
      path = At(slashes);
      if (path.empty() || !LiesIn(query_.folder, path)) return;
      ways_[i] = kSlashes;
      path = path.lexically_normal();
      files_[i] = {path, path.lexically_relative(query_.folder.lexically_normal()).generic_string()};
    } else if (MayStand(written, path)) {
      files_[i].path = path;
    } else {
      outside_[i] = path;
    }
  }

  void FindByEnds() {
    const bool any = std::any_of(files_.begin(), files_.end(), [](const NamedFile& f) { return !f.path.empty(); });
    std::vector<std::vector<std::string>> parts;
    std::set<std::string> folders;
    for (const std::string& written : query_.written) {
      parts.push_back(PartsOf(WithSlashes(written)));
      for (size_t p = 0; p + 1 < parts.back().size(); ++p) folders.insert(FoldName(parts.back()[p]));
    }
    const ImageIndex index(query_.folder, folders);
    for (size_t i = 0; i < files_.size(); ++i) {
      if (!files_[i].path.empty()) continue;
      const std::string slashes = WithSlashes(query_.written[i]);
      const bool whole = any && !slashes.starts_with('/');
      const ImageIndex::Match match = index.Find(parts[i], whole ? 0 : parts[i].size(), query_.min_parts, whole);
      if (match.file == kManyFiles) continue;
      files_[i] = {query_.folder / index.NameOf(match.file), index.NameOf(match.file)};
      ways_[i] = match.ways | (slashes == query_.written[i] ? 0u : kSlashes);
      if (ways_[i] == kAsWritten) ways_[i] = kEnd;  // below the folder what was written from the root
    }
  }

  /// Takes away a file that was found for several paths: it is right for one of them at most.
  void DropShared() {
    if (std::all_of(ways_.begin(), ways_.end(), [](unsigned way) { return way == kAsWritten; })) return;
    std::unordered_map<std::string, std::set<std::string>> users;
    const auto users_of = [&](size_t i) -> auto& { return users[files_[i].path.lexically_normal().string()]; };
    for (size_t i = 0; i < files_.size(); ++i) {
      users_of(i).insert(query_.may_share ? query_.written[i] : std::to_string(i));
    }
    std::vector<size_t> shared;
    for (size_t i = 0; i < files_.size(); ++i) {
      if (ways_[i] != kAsWritten && users_of(i).size() > 1) shared.push_back(i);
    }
    for (const size_t i : shared) {
      files_[i] = {};
      ways_[i] = kAsWritten;
    }
  }

  void Report(const Listener& listener) const {
    unsigned ways = 0;
    size_t count = 0, example = 0;
    for (size_t i = ways_.size(); i-- > 0;) {
      ways |= ways_[i];
      if (files_[i].name.empty()) continue;
      ++count;
      example = i;
    }
    if (count == 0) return;
    std::vector<std::string> words;
    const std::pair<Way, const char*> kWords[] = {{kSlashes, "with / for \\"},
                                                  {kEnd, "by the ends of their paths"},
                                                  {kFolded, "in another case or Unicode form"},
                                                  {kExtension, "with another extension"}};
    for (const auto& [way, word] : kWords) {
      if (ways & way) words.emplace_back(word);
    }
    listener(Note{fmt::format("{}: {} of {} name no file as written; found {}: {} for '{}'", query_.source, count,
                              Counted(files_.size(), "path"), fmt::join(words, ", "), files_[example].name,
                              OneLine(query_.written[example]))});
  }

  const NamedFilesQuery& query_;
  std::vector<NamedFile> files_;
  std::vector<unsigned> ways_;
  std::map<size_t, fs::path> outside_;
};

}  // namespace

std::vector<NamedFile> FindNamedFiles(const NamedFilesQuery& query, const Listener& listener) {
  return NamedFilesSearch(query).Run(listener);
}

std::string WithSlashes(const std::string& written) {
  std::string path = written;
  std::replace(path.begin(), path.end(), '\\', '/');
  const bool drive =
      path.size() > 2 && std::isalpha(static_cast<unsigned char>(path[0])) && path[1] == ':' && path[2] == '/';
  return drive ? path.substr(2) : path;
}

bool LiesIn(const fs::path& folder, const fs::path& path) {
  const fs::path outer = fs::absolute(folder / "").lexically_normal(), inner = fs::absolute(path).lexically_normal();
  const auto last = std::prev(outer.end());  // the empty name after the slash
  return std::mismatch(outer.begin(), last, inner.begin(), inner.end()).first == last;
}

}  // namespace oraclegs

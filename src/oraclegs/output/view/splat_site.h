#pragma once
// A splat file as a folder that the viewer's server shows.

#include <filesystem>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

/// A fresh folder that only this user can read, gone with everything in it at the end of the scope.
class TemporaryFolder {
 public:
  /// Throws RunError when there can be none.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline constexpr int64_t kMaxShownGaussians = 4'000'000;  ///< what a browser can hold

/// What of a splat is shown: of more than `max` Gaussians those that cover and hide little are left out, with a
/// warning. Throws InputError naming `file` when it has none.
GaussianPly ShownPart(GaussianPly splat, const std::string& file, int64_t max, const Listener& listener);

/// Writes the splat of `file`, in any format, to `folder` as the viewer takes it: report/run.json of kind "file",
/// splat.spz, and support.bin where the file has the support of its Gaussians. Throws InputError, UsageError, RunError.
void WriteSplatSite(const std::filesystem::path& file, const std::filesystem::path& folder, const Listener& listener);

}  // namespace oraclegs

#pragma once
// Turns a splat file into a folder for the viewer's server.

#include <filesystem>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

/// New folder that only this user can read; it is removed with its content at the end of the scope.
class TemporaryFolder {
 public:
  /// Throws RunError when it cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline constexpr int64_t kMaxShownGaussians = 4'000'000;  ///< limit of browsers

/// Gaussians to show. From more than `max` those that cover and hide little are left out, with a warning.
/// Throws InputError naming `file` when it has none.
GaussianPly ShownPart(GaussianPly splat, const std::string& file, int64_t max, const Listener& listener);

/// Writes the splat of `file`, in any format, to `folder` in the viewer's form: report/run.json of kind "file",
/// splat.spz, and support.bin and uncertainty.bin where the file has these marks of its Gaussians. Throws InputError,
/// UsageError, RunError.
void WriteSplatSite(const std::filesystem::path& file, const std::filesystem::path& folder, const Listener& listener);

}  // namespace oraclegs

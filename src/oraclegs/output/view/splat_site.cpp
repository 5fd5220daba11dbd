#include "oraclegs/output/view/splat_site.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/evaluate/uncertainty.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/formats/values.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/output/live/run_state.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr double kInnerShare = 0.7;  // share of the Gaussians within the radius that is shown first

/// {"up", "center", "radius"} of the viewer's first camera. The up direction is unknown: in most files y points down.
nlohmann::json Framing(const Gaussians& gaussians) {
  std::array<std::vector<double>, 3> axes;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    for (int c = 0; c < 3; ++c) axes[static_cast<size_t>(c)].push_back(gaussians.means[3 * i + c]);
  }
  std::array<double, 3> center{};
  for (size_t c = 0; c < 3; ++c) center[c] = Median(&axes[c]);
  std::vector<double> distances;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    double square = 0;
    for (int c = 0; c < 3; ++c) square += std::pow(gaussians.means[3 * i + c] - center[static_cast<size_t>(c)], 2);
    distances.push_back(std::sqrt(square));
  }
  const auto inner = static_cast<std::ptrdiff_t>(kInnerShare * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), distances.begin() + inner, distances.end());
  const double radius = distances[static_cast<size_t>(inner)];
  return {{"up", {0, -1, 0}}, {"center", center}, {"radius", radius > 0 ? radius : 1}};
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const fs::path base = fs::temp_directory_path(error);
  std::string name = ((error ? fs::path("/tmp") : base) / "oraclegs-view-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw RunError("{}: a temporary folder cannot be made: {}; name another place with TMPDIR", name,
                   std::strerror(errno));
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

GaussianPly ShownPart(GaussianPly splat, const std::string& file, int64_t max, const Listener& listener) {
  const int64_t all = splat.gaussians.size();
  if (all == 0) throw InputError("{}: holds no Gaussian that can be shown; name another file", file);
  if (all <= max) return splat;
  listener(
      Warning{fmt::format("{}: holds {} Gaussians; the {} that cover and hide most are shown (`oraclegs export` "
                          "writes smaller files)",
                          file, all, max)});
  std::vector<int64_t> kept(static_cast<size_t>(all));
  std::iota(kept.begin(), kept.end(), 0);
  kept = MostPresent(splat.gaussians, std::move(kept), max);
  return {Picked(splat.gaussians, kept), splat.sh_degree, splat.comments, Picked(splat.marks, kept)};
}

void WriteSplatSite(const fs::path& file, const fs::path& folder, const Listener& listener) {
  nlohmann::json warnings = nlohmann::json::array();
  const Listener listening = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) warnings.push_back(warning->text);
    listener(event);
  };
  const GaussianPly shown = ShownPart(ReadSplat(file, listening), file.string(), kMaxShownGaussians, listening);
  const std::string spz = EncodeSpz(shown.gaussians, shown.sh_degree);
  nlohmann::json splat = {{"url", "splat.spz"},
                          {"format", "spz"},
                          {"gaussians", shown.gaussians.size()},
                          {"bytes", spz.size()},
                          {"sh_degree", shown.sh_degree},
                          {"support", nullptr},
                          {"uncertainty", nullptr}};
  splat.update(Framing(shown.gaussians));
  ReplaceFile(folder / "splat.spz", spz);
  if (!shown.marks.support.empty()) {
    splat["support"] = {{"url", "support.bin"}};
    ReplaceFile(folder / "support.bin", MarkBytes(shown.marks.support, 1));
  }
  if (!shown.marks.uncertainty.empty()) {
    splat["uncertainty"] = {{"url", "uncertainty.bin"}};
    ReplaceFile(folder / "uncertainty.bin", MarkBytes(shown.marks.uncertainty, kLargestShownError));
  }
  const nlohmann::json document = {{"format", 1},
                                   {"kind", "file"},
                                   {"title", file.filename().string()},
                                   {"created", UtcNow()},
                                   {"finished", true},
                                   {"splat", std::move(splat)},
                                   {"views", nlohmann::json::array()},
                                   {"warnings", std::move(warnings)}};
  fs::create_directory(folder / "report");
  ReplaceFile(folder / "report" / "run.json",
              document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace oraclegs

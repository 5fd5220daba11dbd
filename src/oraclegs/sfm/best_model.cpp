#include "oraclegs/sfm/best_model.h"
#include "oraclegs/sfm/choose_pairs.h"

#include <fmt/format.h>

#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/sfm/colmap_workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// The candidate without some images, adjusted below `folder`; nothing where colmap leaves no model.
std::optional<Candidate> Without(const Candidate& candidate, const std::vector<std::string>& names,
                                 const ColmapRunner& colmap, const fs::path& folder) {
  const fs::path model = colmap.WithoutImages(candidate.model, names, folder);
  if (model.empty()) return std::nullopt;
  Candidate rest{model, candidate.database, MeasureModel(model), candidate.set, candidate.left_out};
  rest.left_out.insert(rest.left_out.end(), names.begin(), names.end());
  return rest;
}

void NoteQuality(const ModelQuality& quality, AttemptRecord* record) {
  record->registered = quality.registered();
  record->points = quality.points;
  record->reprojection_error = quality.reprojection_error;
  record->parallax_degrees = quality.parallax_degrees;
  record->flaw = FlawOf(quality);
}

}  // namespace

void BestModel::Resume() {
  journal_ = ReadAttemptJournal(folder_);
  if (journal_.model.empty()) return;
  try {
    const fs::path model = folder_ / journal_.model;
    best_ = {model, folder_ / journal_.database, MeasureModel(model), {}, journal_.left_out};
    for (const int images : {1, kMaxImagesToMatchAll + 1}) {
      for (const FeatureSet& set : RegistrationSchedule(images)) {
        if (set.name == journal_.features) best_.set = set;
      }
    }
  } catch (const InputError&) {
    journal_ = {};  // all is made again
    best_ = {};
  }
}

fs::path BestModel::NewModelFolder() {
  fs::path dir = folder_ / fmt::format("models{}", journal_.folders++);
  MakeFolder(dir);
  return dir;
}

void BestModel::Consider(const Candidate& candidate, const ColmapRunner& colmap, AttemptRecord* record) {
  if (HasPlausiblePart(candidate.quality)) {
    const auto rest = Without(candidate, candidate.quality.implausible_images, colmap, NewModelFolder());
    if (rest) Consider(*rest, colmap, record);
    return;
  }
  if (candidate.quality.registered() > record->registered) NoteQuality(candidate.quality, record);
  if (IsSound(candidate.quality) && IsBetter(candidate.quality, best_.quality)) Take(candidate, record);
}

void BestModel::LeaveOut(const std::vector<std::string>& names, const ColmapRunner& colmap, AttemptRecord* record) {
  const auto rest = Without(best_, names, colmap, NewModelFolder());
  if (!rest || !IsSound(rest->quality)) return;
  NoteQuality(rest->quality, record);
  Take(*rest, record);
}

void BestModel::Take(const Candidate& candidate, AttemptRecord* record) {
  best_ = candidate;
  for (AttemptRecord& other : journal_.records) other.kept = false;
  record->kept = true;
  journal_.model = best_.model.lexically_relative(folder_).string();
  journal_.database = best_.database.filename().string();
  journal_.features = best_.set.name;
  journal_.left_out = best_.left_out;
}

}  // namespace oraclegs

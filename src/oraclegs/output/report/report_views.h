#pragma once
// Views of a report: cameras, images, proposals, and renders of the splat from there.

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/output/report/report_files.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// {"width", "height", "fx", "fy", "cx", "cy", "world_to_camera": 16 numbers, row by row}.
nlohmann::json CameraToJson(const Camera& camera);

inline constexpr size_t kReportedViews = 48;  ///< for each role; more make the page heavy, not clearer

/// Elements at even steps, at most `count` of them.
template <class T>
std::vector<T> Evenly(const std::vector<T>& all, size_t count) {
  if (all.size() <= count) return all;
  std::vector<T> chosen;
  for (size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
  return chosen;
}

/// Rows of "views", in the order in which they are added; ids count from 0. With a model each row has a render of it.
/// Images are written one by one.
class ReportViews {
 public:
  /// A null model means that there is none yet.
  ReportViews(const Run& run, const ReportFiles& files, const Model* model);
  ~ReportViews();

  /// Adds a photo whose camera is not known yet.
  void AddPhoto(const std::string& name, const Image8& image);
  /// Call it for all training views before AddProposals.
  void AddTraining(const LoadedView& view);
  /// Adds the run's proposals, at most 32, with confidence and nearest training view, as far as their files exist.
  void AddProposals();
  /// Adds a test view with error, expected error and support of each pixel. Does nothing without a model.
  void AddTest(const LoadedView& view);
  /// Takes the places of the scene's photos that neither train nor test into account for Advice. Call it after all
  /// training views have been added. Does nothing without a model.
  void AddSpares();

  /// Suggests where another photo would help most: of the proposals' and spare photos' places, those from which the
  /// model is the least sure (evaluate/uncertainty.h). At most three of {"text", "view": id of a row}, or one that says
  /// that there are photos enough, with a null view; none without a model or places. A suggested spare photo gets a row
  /// of role "spare", whose image is a render.
  nlohmann::json Advice();

  const nlohmann::json& Rows() const;

 private:
  struct Renderer;
  /// A place that a photo could be taken from.
  struct Place {
    Camera camera;
    std::optional<size_t> row;  ///< nothing = it has none yet
    std::string photo;          ///< name of the spare photo there; empty = there is none
    double error = 0;           ///< mean error to expect there
  };

  void AddProposal(const Target& target);
  nlohmann::json Row(const std::string& name, const char* role, const Image8& image);
  const Run& run_;
  const ReportFiles& files_;
  std::unique_ptr<Renderer> renderer_;
  nlohmann::json rows_;
  std::vector<std::string> names_;  ///< names of the training views
  std::vector<Camera> cameras_;     ///< cameras of the training views
  std::vector<Place> places_;
  bool of_object_ = false;  ///< the photos show an object before a plain background, of which nobody needs more
};

}  // namespace oraclegs

#pragma once
// The views of a report: cameras, images, proposals, and what the splat shows from there.

#include <memory>
#include <nlohmann/json.hpp>
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

inline constexpr size_t kReportedViews = 48;  ///< of a role; more make the page heavy, not clearer

/// Every n-th, so that at most `count` are left.
template <class T>
std::vector<T> Evenly(const std::vector<T>& all, size_t count) {
  if (all.size() <= count) return all;
  std::vector<T> chosen;
  for (size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
  return chosen;
}

/// The rows of "views", in the order in which they are added; ids count from 0. With a model each has what the model
/// shows from there. Images go to the files one by one.
class ReportViews {
 public:
  /// model: null = there is none yet.
  ReportViews(const Run& run, const ReportFiles& files, const Model* model);
  ~ReportViews();

  /// All of these before the proposals.
  void AddTraining(const LoadedView& view);
  /// The run's proposals, at most 32, with confidence and nearest training view, as far as their files are there.
  void AddProposals();
  /// With error and support of each pixel. Does nothing without a model.
  void AddTest(const LoadedView& view);

  const nlohmann::json& Rows() const;

  /// Where another photo would help most: from the proposals whose pixels are least supported. One sentence each, at
  /// most three; without a model, or support in it, none.
  std::vector<std::string> Advice() const;

 private:
  struct Renderer;
  struct Seen {
    std::string proposal;
    std::vector<std::string> neighbors;  ///< names of the nearest training views, at most two
    double supported = 0;                ///< share of the pixels that two or more images support
  };

  void AddProposal(const Target& target);
  nlohmann::json Row(const std::string& name, const char* role, const Camera& camera, const Image8& image);
  const Run& run_;
  const ReportFiles& files_;
  std::unique_ptr<Renderer> renderer_;
  nlohmann::json rows_;
  std::vector<std::string> names_;  ///< of the training views
  std::vector<Camera> cameras_;     ///< likewise
  std::vector<Seen> seen_;
};

}  // namespace oraclegs

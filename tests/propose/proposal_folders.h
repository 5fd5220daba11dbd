#pragma once
// Folders of proposals as other generators leave them.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/folder.h"
#include "oraclegs/propose/proposal_files.h"
#include "propose/rigs.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {

/// A scene of views images/0.jpg ... images/9.jpg, of which 0 and 8 are test views; working size 64 x 48.
class ProposalFolderTest : public ::testing::Test {
 protected:
  ProposalFolderTest() {
    const std::vector<Camera> cameras = RigAround(10);
    request_.width = 64, request_.height = 48;
    for (size_t i = 0; i < cameras.size(); ++i) {
      const Target view{"images/" + std::to_string(i) + ".jpg", cameras[i]};
      (i % 8 == 0 ? request_.test : request_.dataset).push_back(view);
      if (i % 8 != 0 && i % 2 == 0) request_.train.push_back(cameras[i]);
    }
  }
  void WriteFrames(const std::vector<std::string>& names) {
    std::vector<Target> targets;
    for (const std::string& name : names) {
      targets.push_back({name, RigCamera({5, 0.1 * static_cast<double>(targets.size()), 2}, {0, 0, 0})});
    }
    WriteTargets(dir_.path(), targets);
  }
  /// Changes one frame of transforms.json.
  template <class Action>
  void EditFrame(size_t index, Action action) {
    nlohmann::json file = nlohmann::json::parse(std::ifstream(dir_ / "transforms.json"));
    action(&file["frames"][index]);
    WriteText(dir_ / "transforms.json", file.dump());
  }
  void Paint(const std::string& name, std::vector<uint8_t> color, int width = 64, int height = 48) {
    Image8 image{width, height, static_cast<int>(color.size()), {}};
    for (int i = 0; i < width * height; ++i) image.data.insert(image.data.end(), color.begin(), color.end());
    std::filesystem::create_directories((dir_ / name).parent_path());
    WritePng(dir_ / name, image);
  }
  FolderProposals Read(const std::string& below = "") {
    return ReadProposalFolder(below.empty() ? dir_.path() : dir_ / below, request_, events_.AsListener());
  }
  std::string ErrorOf(const std::string& below = "") {
    return MessageOf<InputError>([&] { Read(below); });
  }

  TempDir dir_;
  FolderRequest request_;
  EventRecorder events_;
};

inline std::vector<std::string> NamesOf(const FolderProposals& read) {
  std::vector<std::string> names;
  for (const Proposal& proposal : read.proposals) names.push_back(proposal.name);
  return names;
}

}  // namespace oraclegs

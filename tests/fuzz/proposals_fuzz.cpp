// transforms.json of a folder of proposals, whose images exist, and of the targets of a generator.

#include "fuzz/fuzz.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/folder.h"
#include "oraclegs/propose/proposal_files.h"

namespace {

class ProposalImages : public oraclegs::fuzz::Folder {
 public:
  ProposalImages() {
    const oraclegs::Image8 image{8, 6, 3, std::vector<uint8_t>(144, 128)}, tall{6, 8, 4, std::vector<uint8_t>(192, 99)};
    for (const char* name : {"1.png", "a/2.png", "confidence/1.png"}) {
      Put(name, "");
      oraclegs::WritePng(path() / name, image);
    }
    oraclegs::WritePng(path() / "3.png", tall);
    Put("4.png", "damaged");
  }
};

oraclegs::FolderRequest RequestOfViews() {
  oraclegs::Camera camera{8, 6, 8, 8, 4, 3};
  oraclegs::FolderRequest request;
  request.width = 8, request.height = 6;
  for (int i = 0; i < 3; ++i) {
    camera.cam_from_world.translation().x() = i;
    request.train.push_back(camera);
    request.dataset.push_back({"a/" + std::to_string(i) + ".jpg", camera});
  }
  camera.cam_from_world.translation().y() = 1;
  request.test.push_back({"a/2.jpg", camera});
  return request;
}

}  // namespace

ORACLEGS_FUZZ_TARGET(proposals) {
  using namespace oraclegs;
  static const ProposalImages folder;
  static const FolderRequest request = RequestOfViews();
  folder.Put("transforms.json", bytes);
  fuzz::Try([&] { ReadTargets(folder.path()); });
  fuzz::Try([&] { ReadProposalFolder(folder.path(), request, Silent()); });
}

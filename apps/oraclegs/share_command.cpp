#include "oraclegs/image/image.h"
#include "oraclegs/run/stages.h"
#include "source_command.h"

namespace oraclegs {
namespace {

struct ShareOptions {
  std::string stage;
  int round = 0;
  std::string part = "1/1";
  std::string key;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("stage", self.stage, "Stage of which a part is made: proxies, propose or validate");
    visit("round", self.round, "Of a stage that is made in rounds, from 0", Range{0, 100});
    visit("part", self.part, "Which part of how many: 2/3");
    visit("key", self.key, "What the run that asks for it knows of its inputs; others are refused");
  }
};

/// What --spread starts.
class ShareCommand : public Command {
 public:
  explicit ShareCommand(CLI::App* app)
      : Command(app, "share",
                "Make a part of a stage for a run that another process works on; --spread starts such processes",
                "oraclegs share out/ --stage proxies --part 2/3 --key KEY") {
    BindInput("input", &input_, "Workspace of the run");
    Bind("Share", &options_);
    Bind("Machine", &device_);
    BindMachine(&machine_);
  }

 private:
  void Body(const Listener& listener) override {
    const auto share = ParseShare(options_.part);
    if (!share) throw UsageError("--part {}: is no part; say which of how many, such as 2/3", options_.part);
    const RunRequest request = RequestAsSaved(input_, machine_, device_);
    SetMaxMegapixels(request.options.file_limits.max_megapixels);
    oraclegs::Run run = JoinRun(request, listener);
    MakeShare(&run, Stages(), options_.stage, {options_.key, options_.round, *share});
  }

  std::filesystem::path input_;
  ShareOptions options_;
  MachineOptions machine_;
  DeviceOptions device_;
};

}  // namespace

std::unique_ptr<Command> MakeShareCommand(CLI::App* app) { return std::make_unique<ShareCommand>(app); }

}  // namespace oraclegs

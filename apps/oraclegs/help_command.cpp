#include "command.h"
#include "help_text.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

struct HelpOptions {
  bool all = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("all", self.all, "Explain all options of the command, not only the basic ones");
  }
};

class HelpCommand : public Command {
 public:
  HelpCommand(CLI::App* app, std::function<Catalog()> catalog)
      : Command(app, "help", "Explain a command", "oraclegs help reconstruct", General::kHelpAlone),
        catalog_(std::move(catalog)) {
    this->app()
        ->add_option("command", name_,
                     "The command to explain, or settings: all that --set has; without, the commands are listed")
        ->type_name("COMMAND");
    Bind("Help", &options_);
  }

 private:
  void Body(const Listener&) override {
    const Catalog catalog = catalog_();
    if (name_.empty()) {
      WriteOut(OverviewText(catalog));
      return;
    }
    std::vector<std::string> names = {"settings"};
    for (const CommandInfo& command : catalog) {
      names.push_back(command.name);
      if (name_ == "settings" && command.name == "reconstruct") return WriteOut(SettingsText(command));
      if (command.name != name_) continue;
      WriteOut(HelpText(command, options_.all));
      return;
    }
    throw UsageError("there is no command '{}'{}", name_, DidYouMean(name_, names));
  }

  std::function<Catalog()> catalog_;
  std::string name_;
  HelpOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeHelp(CLI::App* app, std::function<Catalog()> catalog) {
  return std::make_unique<HelpCommand>(app, std::move(catalog));
}

}  // namespace oraclegs

#include "command.h"
#include "completion.h"

namespace oraclegs {
namespace {

class CompletionCommand : public Command {
 public:
  CompletionCommand(CLI::App* app, std::function<Catalog()> catalog)
      : Command(app, "completion", "Print the completion script of a shell",
                "oraclegs completion bash > ~/.local/share/bash-completion/completions/oraclegs\n"
                "  oraclegs completion zsh > ~/.zfunc/_oraclegs\n"
                "  oraclegs completion fish > ~/.config/fish/completions/oraclegs.fish",
                General::kHelpAlone),
        catalog_(std::move(catalog)) {
    this->app()->add_option("shell", shell_, "bash, zsh or fish")->type_name("SHELL")->required();
  }

 private:
  void Body(const Listener&) override { WriteOut(CompletionOf(shell_, catalog_())); }

  std::function<Catalog()> catalog_;
  std::string shell_;
};

}  // namespace

std::unique_ptr<Command> MakeCompletion(CLI::App* app, std::function<Catalog()> catalog) {
  return std::make_unique<CompletionCommand>(app, std::move(catalog));
}

}  // namespace oraclegs

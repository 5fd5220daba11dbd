#include "command.h"
#include "man_page.h"

namespace oraclegs {
namespace {

class ManCommand : public Command {
 public:
  ManCommand(CLI::App* app, std::function<Catalog()> catalog)
      : Command(app, "man", "Print the man page, oraclegs(1)", "oraclegs man | man -l -", General::kHelpAlone),
        catalog_(std::move(catalog)) {}

 private:
  void Body(const Listener&) override { WriteOut(ManPage(catalog_(), ORACLEGS_VERSION)); }

  std::function<Catalog()> catalog_;
};

}  // namespace

std::unique_ptr<Command> MakeMan(CLI::App* app, std::function<Catalog()> catalog) {
  return std::make_unique<ManCommand>(app, std::move(catalog));
}

}  // namespace oraclegs

#include "oraclegs/propose/generator.h"

#include <system_error>

#include "oraclegs/image/codecs.h"

namespace oraclegs {

namespace fs = std::filesystem;

void RunGenerator(const GeneratorRun& run, const std::vector<Target>& targets, const Listener& listener) {
  const CommandFolders paths{fs::absolute(run.proposals / "generator")};
  RunUserCommand({"--generator", run.command, run.timeout, paths},
                 {"propose", "generated views", targets.size(), [&] { return CountAnswers(paths, targets); }},
                 listener);
  const std::vector<Image8> images = ReadAnswers(paths, targets);
  for (size_t t = 0; t < targets.size(); ++t) {
    WritePng(run.proposals / kGeneratorSource / (targets[t].name + ".png"), images[t]);
  }
  std::error_code ignored;
  fs::remove_all(paths.answer(), ignored);
}

void RemoveGeneratorFiles(const fs::path& proposals) {
  std::error_code ignored;
  fs::remove_all(proposals / "generator", ignored);
  fs::remove_all(proposals / kGeneratorSource, ignored);
}

}  // namespace oraclegs

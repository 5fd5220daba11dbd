#include "oraclegs/proposers/proposer_rows.h"

#include "oraclegs/networks/seva_size.h"
#include "oraclegs/propose/generator.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/proposers/proxy_models.h"
#include "oraclegs/proposers/seva.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

void RemoveFolder(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

ProposerRow WarpRow() {
  return {.word = kWarpWord,
          .can_hold_out = true,
          .stands_in = true,
          .make =
              [](const Run&, const Warper& warper) {
                std::vector<AskedProposer> members;
                members.push_back({std::make_unique<WarpProposer>(warper)});
                return members;
              },
          .undo = [](const fs::path& proposals) { RemoveFolder(proposals / kWarpWord); }};
}

ProposerRow ProxiesRow() {
  return {.word = kProxiesWord,
          .can_hold_out = true,
          .make =
              [](const Run& run, const Warper&) {
                std::vector<AskedProposer> members;
                if (run.results->proxies.empty()) return members;
                const RenderOptions render{BackgroundColor(run.plan.image.background), run.options.train.sh_degree,
                                           run.options.train.antialiased};
                members.push_back(
                    {.proposer = std::make_unique<EnsembleProposer>(run.results->proxies, render), .renders = true});
                return members;
              },
          .undo = [](const fs::path& proposals) { RemoveFolder(proposals / kProxiesWord); }};
}

ProposerRow SevaRow() {
  return {.word = "seva",
          .sees_anything = true,
          .non_commercial = kSevaName,
          .own_size =
              [](const Run& run, PixelSize view) {
                const seva::Size size = seva::GeneratedSize({view.width, view.height}, run.options.seva.short_side);
                return PixelSize{static_cast<int>(size.width), static_cast<int>(size.height)};
              },
          .own = [](const Run& run,
                    Fingerprint* key) { key->Add(SevaKey(run.options.seva, FindSevaFiles(run.options.weights))); },
          .prepare =
              [](Run* run, const std::string& key) {
                const auto larger = LargerViews(*run, run->options.seva.short_side);
                GenerateViews({larger ? *larger : ViewsOf(run).views, run->results->targets, key,
                               FindSevaFiles(run->options.weights), run->options.seva, run->workspace.proposals(),
                               run->plan.device},
                              run->listener);
              },
          .make =
              [](const Run& run, const Warper&) {
                std::vector<AskedProposer> members;
                for (int k = 0; k < run.options.seva.candidates; ++k) {
                  members.push_back({std::make_unique<StoredProposer>(run.workspace.proposals(), SevaSource(k))});
                }
                return members;
              },
          .undo = RemoveGenerated,
          .finish = RemoveChunks};
}

/// Has the command of --generator paint all targets.
void RunCommand(Run* run, const std::string&) {
  const fs::path proposals = run->workspace.proposals();
  const std::vector<Target>& targets = run->results->targets;
  WriteGeneratorRequest({proposals / "generator"}, targets, ViewsOf(run).views, ProposersOf(run).warper(),
                        RunFromScene(run->frame).Inverse());
  RunGenerator({run->options.propose.generator, run->options.generator_limits.generator_timeout, proposals}, targets,
               run->listener);
}

ProposerRow CommandRow() {
  return {.word = kCommandWord,
          .sees_anything = true,
          .prepare = RunCommand,
          .make =
              [](const Run& run, const Warper&) {
                std::vector<AskedProposer> members;
                members.push_back({std::make_unique<StoredProposer>(run.workspace.proposals(), kGeneratorSource)});
                return members;
              },
          .undo = RemoveGeneratorFiles};
}

}  // namespace

const std::vector<ProposerRow>& ProposerRows() {
  static const std::vector<ProposerRow> rows = {WarpRow(), ProxiesRow(), SevaRow(), CommandRow()};
  return rows;
}

}  // namespace oraclegs

#include "command.h"
#include "export_one.h"
#include "oraclegs/output/splat_folder.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string format;
  bool overwrite = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    static const std::string help =
        "Write this format into the folder `out`, under the names of the input: " + SplatExtensions();
    visit("format", self.format, help.c_str());
    visit("overwrite", self.overwrite, "Replace files that are there");
  }
};

/// Events of a file among many, for which its line on stdout stands.
Listener WithoutFiles(const Listener& listener) {
  return [listener](const Event& event) {
    if (!std::holds_alternative<FileWritten>(event)) listener(event);
  };
}

class ConvertCommand : public Command {
 public:
  explicit ConvertCommand(CLI::App* app)
      : Command(app, "convert", "Splat files to another format, one or a whole folder, edited as `export` does",
                "oraclegs convert scene.ply scene.spz --crop sphere:0,0,0,5\n  "
                "oraclegs convert splats/ small/ --format sog") {
    static const std::string help = "A splat (" + SplatExtensions() +
                                    ", folder of SOG, workspace), or a folder of splats, of which those in folders "
                                    "below are left alone";
    BindInput("input", &input_, help.c_str());
    BindInput("out", &out_, "The file to write; with --format the folder");
    Bind("Output", &convert_);
    Bind("Edits", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    std::error_code ignored;
    const bool one = !fs::is_directory(input_, ignored) || IsSplatFolder(input_) || IsWorkspace(input_);
    if (!one) return ConvertFolder(listener);
    const fs::path out = convert_.format.empty() ? out_ : SplatJobOf(input_, out_, convert_.format).to;
    CheckExport({input_, out}, options_);
    if (IsThere(out)) throw UsageError("{}: is there already; name another file, or give --overwrite", out.string());
    if (!convert_.format.empty()) fs::create_directories(out_);
    Print(LineOf(out, ExportOne(input_, out, options_, listener)));
  }

  void ConvertFolder(const Listener& listener) const {
    const std::vector<SplatJob> jobs = SplatJobsOf(input_, out_, convert_.format);
    CheckExport({input_, jobs[0].to}, options_);
    fs::create_directories(out_);
    size_t written = 0, there = 0;
    for (const auto& [from, to] : jobs) {
      if (IsThere(to)) {
        ++there;
        Print(fmt::format("left       {} (is there already)", to.string()));
        continue;
      }
      try {
        Print(LineOf(to, ExportOne(from, to, options_, WithoutFiles(listener))));
        ++written;
      } catch (const Interrupted&) {
        throw;
      } catch (const Error& error) {
        WriteError(error.what());
      }
    }
    const size_t failed = jobs.size() - written - there;
    Print(fmt::format("converted  {} of {}{}", written, jobs.size(),
                      there == 0 ? "" : fmt::format("; {} were there already (--overwrite replaces them)", there)));
    if (failed > 0) {
      throw InputError("{}: {} of {} splats could not be converted; the lines above say why", input_.string(), failed,
                       jobs.size());
    }
  }

  bool IsThere(const fs::path& file) const {
    std::error_code ignored;
    return !convert_.overwrite && fs::exists(file, ignored);
  }

  fs::path input_, out_;
  ConvertOptions convert_;
  ExportOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeConvert(CLI::App* app) { return std::make_unique<ConvertCommand>(app); }

}  // namespace oraclegs

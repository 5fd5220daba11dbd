#include "oraclegs/output/figures/figure.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/stage_works.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// `count` indices of 0 .. size - 1 at even steps, starting with 0.
std::vector<size_t> Evenly(size_t size, size_t count) {
  std::vector<size_t> chosen;
  count = std::min(count, size);
  for (size_t i = 0; i < count; ++i) chosen.push_back(i * size / count);
  return chosen;
}

/// Names that --show asks for, else some at even steps.
std::vector<std::string> Chosen(const std::vector<std::string>& names, const FigureOptions& options,
                                const std::string& folder) {
  std::vector<std::string> chosen;
  for (const std::string& word : SplitTrimmed(options.show, ',')) {
    const std::string name = FileName(word);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw InputError("{}: --show names '{}'; there are {}", folder, word, SomeNames(names));
    }
    chosen.push_back(name);
  }
  if (!chosen.empty()) return chosen;
  for (const size_t i : Evenly(names.size(), static_cast<size_t>(options.rows))) chosen.push_back(names[i]);
  return chosen;
}

Image8 InPlasma(const Image8& gray) {
  Image8 colored{gray.width, gray.height, 3, {}};
  const auto channels = static_cast<size_t>(gray.channels);
  for (size_t i = 0; i < gray.data.size(); i += channels) {
    const auto color = MapColor(ColorMap::kPlasma, static_cast<float>(gray.data[i]) / 255);
    colored.data.insert(colored.data.end(), color.begin(), color.end());
  }
  return colored;
}

double Mean(const Image8& gray) {
  double sum = 0;
  const auto channels = static_cast<size_t>(gray.channels);
  for (size_t i = 0; i < gray.data.size(); i += channels) sum += gray.data[i];
  return sum / (255.0 * static_cast<double>(gray.data.size() / channels));
}

struct FigureCrop {
  int x = 0, y = 0, width = 0, height = 0;
};

std::optional<FigureCrop> CropOf(const std::string& text) {
  if (text.empty()) return {};
  std::vector<int> numbers;
  for (const std::string& word : SplitTrimmed(text, ',')) {
    int number = -1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || number < 0) numbers.clear();
    numbers.push_back(number);
  }
  if (numbers.size() != 4 || *std::min_element(numbers.begin(), numbers.end()) < 0 || numbers[2] == 0 ||
      numbers[3] == 0) {
    throw UsageError("--crop is '{}'; write X,Y,WIDTH,HEIGHT, for example 40,60,128,96", Printable(text));
  }
  return FigureCrop{numbers[0], numbers[1], numbers[2], numbers[3]};
}

Image8 Cropped(Image8 image, const std::optional<FigureCrop>& crop) {
  if (!crop) return image;
  if (int64_t{crop->x} + crop->width > image.width || int64_t{crop->y} + crop->height > image.height) {
    throw UsageError("--crop {},{},{},{} reaches beyond the renders of {} x {} pixels", crop->x, crop->y, crop->width,
                     crop->height, image.width, image.height);
  }
  Image8 part{crop->width, crop->height, image.channels, {}};
  const auto channels = static_cast<int64_t>(image.channels);
  for (int64_t y = crop->y; y < int64_t{crop->y} + crop->height; ++y) {
    const auto row = image.data.begin() + (y * image.width + crop->x) * channels;
    part.data.insert(part.data.end(), row, row + crop->width * channels);
  }
  return part;
}

/// PSNR of a test view, with the name of its file.
struct TestView {
  std::string name;
  std::optional<double> psnr;
};

std::vector<TestView> TestViewsOf(const fs::path& workspace) {
  std::vector<TestView> views;
  const nlohmann::json metrics = ReadMetrics(workspace);
  const nlohmann::json test = metrics.value("test", nlohmann::json::object());
  for (const nlohmann::json& view : test.value("views", nlohmann::json::array())) {
    const nlohmann::json psnr = view.value("psnr", nlohmann::json());
    views.push_back({FileName(view.at("name").get<std::string>()),
                     psnr.is_number() ? std::optional(psnr.get<double>()) : std::nullopt});
  }
  if (views.empty()) {
    throw InputError("{}: has no scores of test views; run `oraclegs evaluate` on it", workspace.string());
  }
  return views;
}

constexpr const char* kBenchReport = "bench.json";

/// A run of a benchmark, from the report.
struct SuiteRun {
  std::string method, workspace, failure;
  int64_t seed = 0;
  bool is_scored = false;
};

/// {views, scene}: a row of the figure.
using SuiteRow = std::pair<int64_t, std::string>;

/// The runs of each row, of rising seeds. Throws json::exception.
std::map<SuiteRow, std::vector<SuiteRun>> SuiteRunsOf(const nlohmann::json& report) {
  std::map<SuiteRow, std::vector<SuiteRun>> rows;
  for (const nlohmann::json& run : report.at("runs")) {
    const nlohmann::json failure = run.value("failure", nlohmann::json());
    rows[{run.at("views").get<int64_t>(), run.at("scene").get<std::string>()}].push_back(
        {run.at("method").get<std::string>(), run.at("workspace").get<std::string>(),
         failure.is_string() ? failure.get<std::string>() : "", run.at("seed").get<int64_t>(),
         run.value("psnr", nlohmann::json()).is_number()});
  }
  for (auto& [row, runs] : rows) {
    std::stable_sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.seed < b.seed; });
  }
  return rows;
}

/// The run of a method that is shown: the first with scores, else the first; nullptr where none was planned.
const SuiteRun* ShownRun(const std::vector<SuiteRun>& runs, const std::string& method) {
  const SuiteRun* shown = nullptr;
  for (const SuiteRun& run : runs) {
    if (run.method != method) continue;
    if (run.is_scored) return &run;
    if (shown == nullptr) shown = &run;
  }
  return shown;
}

/// The first of `views` that --show names, else the one with the median PSNR, the lower of two.
std::string ViewToShow(std::vector<TestView> views, const std::string& show) {
  for (const std::string& word : SplitTrimmed(show, ',')) {
    const std::string name = FileName(word);
    for (const TestView& view : views) {
      if (view.name == name) return view.name;
    }
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const TestView& a, const TestView& b) { return a.psnr.value_or(0) < b.psnr.value_or(0); });
  return views[(views.size() - 1) / 2].name;
}

std::string FolderName(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).filename().string();
}

}  // namespace

Sheet ConfidenceSheet(const Run& run, const FigureOptions& options) {
  const nlohmann::json record = run.workspace.Record("validate");
  const nlohmann::json validated =
      record.is_object() ? record.value("mean_confidence", nlohmann::json::object()) : nlohmann::json::object();
  if (validated.empty()) {
    throw InputError("{}: holds no validated proposals; run `oraclegs validate` on it", run.workspace.root().string());
  }
  std::vector<std::string> names, seen;
  for (const auto& [name, confidence] : validated.items()) names.push_back(name);
  std::sort(names.begin(), names.end(), NaturalLess);
  std::vector<int> photos;
  for (const int v : SpareViews(run)) {
    const std::string name = FileName(run.scene.views[static_cast<size_t>(v)].name);
    if (validated.contains(name)) photos.push_back(v), seen.push_back(name);
  }
  Sheet sheet{{"proposal", "confidence"}, {}, ColorMap::kPlasma, "confidence"};
  if (!photos.empty()) sheet.heads.push_back("photo");
  // Proposals with a photo are preferred.
  const bool some_seen = options.show.empty() && !seen.empty();
  for (const std::string& name : Chosen(some_seen ? seen : names, options, run.workspace.root().string())) {
    const Image8 map = ReadImage(run.workspace.confidence() / (name + ".png"));
    std::vector<Panel> row = {{ReadImage(run.workspace.proposals() / (name + ".png")), name},
                              {InPlasma(map), fmt::format("mean {:.2f}", Mean(map))}};
    if (!photos.empty()) row.emplace_back();
    const auto found = std::find(seen.begin(), seen.end(), name);
    if (found != seen.end()) {
      const int v = photos[static_cast<size_t>(found - seen.begin())];
      row.back().image = ToImage8(LoadViews(run.scene, {v}, run.plan.image, run.listener).front().rgb);
    }
    sheet.rows.push_back(std::move(row));
  }
  return sheet;
}

Sheet ComparisonSheet(const std::vector<fs::path>& workspaces, const FigureOptions& options) {
  std::vector<std::string> labels = SplitTrimmed(options.labels, ',');
  if (labels.empty()) {
    for (const fs::path& workspace : workspaces) labels.push_back(FolderName(workspace));
  }
  if (labels.size() != workspaces.size()) {
    throw UsageError("--labels names {} runs, there are {}", labels.size(), workspaces.size());
  }
  const std::optional<FigureCrop> crop = CropOf(options.crop);
  std::vector<std::vector<TestView>> views;
  for (const fs::path& workspace : workspaces) views.push_back(TestViewsOf(workspace));
  std::vector<std::string> names;
  for (const TestView& view : views.front()) names.push_back(view.name);
  Sheet sheet;
  sheet.heads = labels;
  sheet.heads.push_back("photo");
  for (const std::string& name : Chosen(names, options, workspaces.front().string())) {
    std::vector<Panel> row;
    int width = 0, height = 0;
    for (size_t w = 0; w < workspaces.size(); ++w) {
      const auto view = std::find_if(views[w].begin(), views[w].end(), [&](const auto& v) { return v.name == name; });
      if (view == views[w].end()) {
        throw InputError("{}: has no test view {}; compare runs of one scene and split", workspaces[w].string(), name);
      }
      Image8 render = ReadImage(WorkspacePaths(workspaces[w]).renders("test") / (name + ".png"));
      if (w > 0 && (render.width != width || render.height != height)) {
        throw InputError("{}: renders {} in {} x {} pixels, {} in {} x {}; compare runs of one size",
                         workspaces[w].string(), name, render.width, render.height, workspaces[0].string(), width,
                         height);
      }
      width = render.width, height = render.height;
      row.push_back({Cropped(std::move(render), crop), view->psnr ? fmt::format("{:.2f} dB", *view->psnr) : ""});
    }
    Image8 photo = ReadImage(WorkspacePaths(workspaces[0]).renders("test") / (name + "_gt.png"));
    row.push_back({Cropped(std::move(photo), crop), name});
    sheet.rows.push_back(std::move(row));
  }
  return sheet;
}

bool IsSuiteFolder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kBenchReport, ignored);
}

Sheet SuiteSheet(const fs::path& folder, const FigureOptions& options) {
  const fs::path file = folder / kBenchReport;
  const nlohmann::json report = ParseJsonOrDiscard(ReadFile(file));
  std::vector<std::string> scenes, methods, labels = SplitTrimmed(options.labels, ',');
  std::map<SuiteRow, std::vector<SuiteRun>> rows;
  const bool names_methods = !labels.empty();
  try {
    scenes = report.at("scenes").get<std::vector<std::string>>();
    for (const nlohmann::json& method : report.at("methods")) {
      methods.push_back(method.at("name").get<std::string>());
      if (!names_methods) labels.push_back(method.at("label").get<std::string>());
    }
    rows = SuiteRunsOf(report);
  } catch (const nlohmann::json::exception&) {
    throw InputError("{}: is no report of `oraclegs bench`; run the same `oraclegs bench` again", file.string());
  }
  if (labels.size() != methods.size()) {
    throw UsageError("--labels names {} methods, {} has {}", labels.size(), file.string(), methods.size());
  }
  const std::optional<FigureCrop> crop = CropOf(options.crop);
  Sheet sheet;
  sheet.heads = {"photo"};
  sheet.heads.insert(sheet.heads.end(), labels.begin(), labels.end());
  // By the number of views, then as the suite lists its scenes.
  std::vector<SuiteRow> order;
  for (const auto& [row, runs] : rows) order.push_back(row);
  const auto place = [&](const SuiteRow& row) {
    return std::pair(row.first, std::find(scenes.begin(), scenes.end(), row.second));
  };
  std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  bool has_images = false;
  for (const SuiteRow& row : order) {
    const std::string title = row.first > 0 ? fmt::format("{}, {} views", row.second, row.first) : row.second;
    std::string name;
    std::vector<Panel> panels = {{{}, title}};
    for (const std::string& method : methods) {
      const SuiteRun* run = ShownRun(rows.at(row), method);
      if (run == nullptr || !run->is_scored) {
        panels.push_back({{}, run == nullptr || run->failure.empty() ? "not run" : run->failure});
        continue;
      }
      const WorkspacePaths paths(folder / run->workspace);
      const std::vector<TestView> views = TestViewsOf(paths.root());
      const fs::path renders = paths.renders("test");
      if (name.empty()) {
        name = ViewToShow(views, options.show);
        panels[0] = {Cropped(ReadImage(renders / (name + "_gt.png")), crop), fmt::format("{}: {}", title, name)};
      }
      const auto view = std::find_if(views.begin(), views.end(), [&](const auto& v) { return v.name == name; });
      if (view == views.end()) {
        panels.push_back({{}, fmt::format("has no test view {}", name)});
        continue;
      }
      panels.push_back({Cropped(ReadImage(renders / (name + ".png")), crop),
                        view->psnr ? fmt::format("{:.2f} dB", *view->psnr) : ""});
      has_images = true;
    }
    sheet.rows.push_back(std::move(panels));
  }
  if (!has_images) throw InputError("{}: no run has scores yet; run the same `oraclegs bench` again", file.string());
  return sheet;
}

}  // namespace oraclegs

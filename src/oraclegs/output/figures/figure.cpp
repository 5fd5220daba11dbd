#include "oraclegs/output/figures/figure.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "oraclegs/core/text.h"
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

}  // namespace oraclegs

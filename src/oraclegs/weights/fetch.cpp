#include "oraclegs/weights/fetch.h"

#include <algorithm>
#include <cstdlib>

#include "oraclegs/core/error.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/convert.h"
#include "oraclegs/weights/download.h"
#include "oraclegs/weights/folder.h"
#include "oraclegs/weights/http.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

void Convert(const WeightsInfo& model, const std::vector<fs::path>& published, const fs::path& to,
             const Listener& listener) {
  ConvertRequest request{published, to};
  request.model = &model;
  try {
    ConvertWeights(request, listener);
  } catch (const InputError& error) {
    throw RunError("{}: cannot convert its files: {}; remove them from {} to get them again", model.name, error.what(),
                   to.parent_path().string());
  }
}

bool IsThisMachine(const std::string& url) {
  const Origin origin = OriginOf(url);
  return !origin.has_user && (origin.host == "127.0.0.1" || origin.host == "localhost" || origin.host == "[::1]");
}

/// Whether nobody on the way can read what is sent.
bool KeepsSecrets(const std::string& url) { return OriginOf(url).scheme == "https" || IsThisMachine(url); }

/// `fix` is what to do about it, beyond what the check says.
void WarnIfUnexpected(const WeightsInfo& model, const fs::path& weights, const char* fix, const Listener& listener) {
  try {
    CheckWeights(model, weights, listener);
  } catch (const InputError& error) {
    listener(Warning{fmt::format("{}{}", error.what(), fix)});
  }
}

}  // namespace

FetchSettings FetchSettingsFromEnvironment() {
  FetchSettings settings{Variable("HF_TOKEN"), Variable("ORACLEGS_MODELS_URL")};
  const bool printable =
      std::all_of(settings.token.begin(), settings.token.end(), [](unsigned char c) { return c > 0x20 && c < 0x7f; });
  if (!printable) throw UsageError("HF_TOKEN holds blanks or line breaks; set it to the token alone");
  const std::string& mirror = settings.mirror;
  if (!mirror.empty() && !mirror.starts_with("http://") && !mirror.starts_with("https://")) {
    throw UsageError("ORACLEGS_MODELS_URL is '{}', must begin with http:// or https://", WithoutSecrets(mirror));
  }
  if (!mirror.empty() && (OriginOf(mirror).host.empty() || OriginOf(mirror).has_user)) {
    throw UsageError(
        "ORACLEGS_MODELS_URL is no address of a server without user and password; set it to one, for example "
        "http://mirror:8080");
  }
  return settings;
}

std::string LicenseText(const WeightsInfo& model) {
  std::string text = fmt::format("{}: license {}", model.name, model.license);
  if (model.non_commercial) text += "; not for commercial use";
  if (!model.restriction.empty()) text += "; " + model.restriction;
  return text + "; see " + model.license_page;
}

std::string AtMirror(const std::string& url, const std::string& mirror) {
  if (mirror.empty()) return url;
  const size_t path = url.find('/', url.find("://") + 3);
  return mirror.substr(0, mirror.find_last_not_of('/') + 1) + url.substr(path);
}

fs::path FetchWeights(const WeightsInfo& model, const FetchOptions& options, const FetchSettings& settings,
                      const Listener& listener) {
  if (const auto here = LocateWeights(model.name)) {
    WarnIfUnexpected(model, *here, "; it is here already and is not replaced: remove it first", listener);
    return *here;
  }
  if (!options.accept_license) {
    throw UsageError("{}; if you agree to it, add --accept-license", LicenseText(model));
  }
  listener(Note{LicenseText(model)});
  fs::path weights = FetchedFile(model.name);
  std::vector<fs::path> published;
  for (const PublishedFile& file : model.files) {
    DownloadRequest request;
    request.url = AtMirror(file.url, settings.mirror);
    request.to = model.convert ? weights.parent_path() / file.url.substr(file.url.rfind('/') + 1) : weights;
    if (file.sha256.empty() && !settings.mirror.empty() && !IsThisMachine(request.url)) {
      throw UsageError(
          "{}: its checksum is not known beforehand, so it is taken from {} alone; unset ORACLEGS_MODELS_URL, or give "
          "a file that you have with `oraclegs models convert`",
          model.name, kHuggingFace);
    }
    if (file.url.starts_with(kHuggingFace) && KeepsSecrets(request.url)) request.bearer = settings.token;
    request.sha256 = file.sha256;
    request.bytes = file.bytes;
    request.stage = "fetch " + request.to.filename().string();
    published.push_back(request.to);
    if (!fs::exists(request.to)) Download(request, listener);
  }
  if (model.convert) {
    listener(Note{fmt::format("{}: converting to {}", model.name, weights.string())});
    Convert(model, published, weights, listener);
    for (const fs::path& file : published) {
      if (!options.keep_published) fs::remove(file);
    }
  } else {
    WarnIfUnexpected(model, weights, "", listener);
  }
  return weights;
}

}  // namespace oraclegs

#include "oraclegs/web/site.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr const char* kDocument = "report/run.json";
constexpr const char* kLive = "live/state.json";
constexpr uint64_t kMaxDocumentBytes = 64 << 20;

/// The document; null if it is not a JSON object or is nested too deeply, since readers walk through it by recursion.
nlohmann::json ParseDocument(const std::string& text) {
  nlohmann::json json = ParseJsonOrDiscard(text);
  return json.is_object() ? std::move(json) : nullptr;
}

std::string TagOf(const std::string& text) { return fmt::format("{:x}", std::hash<std::string>{}(text)); }

}  // namespace

std::set<std::string> UrlsOf(const nlohmann::json& document) {
  std::set<std::string> urls;
  std::vector<const nlohmann::json*> left = {&document};
  while (!left.empty()) {
    const nlohmann::json& value = *left.back();
    left.pop_back();
    if (value.is_object() && value.contains("url") && value["url"].is_string()) {
      const auto url = value["url"].get<std::string>();
      if (IsPlainPath(url)) urls.insert(url);
    }
    if (value.is_structured()) {
      for (const nlohmann::json& item : value) left.push_back(&item);
    }
  }
  return urls;
}

void Site::Look(const char* path, Known* known) const {
  const auto file = FileBelow::Open(root_, path);
  if (!file) {  // --overwrite removed it, or nobody wrote it yet
    *known = {.revision = known->revision};
    return;
  }
  if (file->tag() == known->tag) return;
  const auto text = file->ReadAll(kMaxDocumentBytes);
  if (!text) return;  // it is being written in place, or far too large
  known->tag = file->tag();
  const nlohmann::json json = ParseDocument(*text);
  if (json.is_null() || *text == known->json) return;
  known->urls = UrlsOf(json);
  known->json = *text;
  ++known->revision;
}

std::optional<SiteDocument> Site::Document() {
  const std::lock_guard<std::mutex> guard(mutex_);
  Look(kDocument, &document_);
  if (document_.json.empty()) return std::nullopt;
  return SiteDocument{document_.json, TagOf(document_.json)};
}

std::optional<nlohmann::json> Site::LiveState() {
  Look(kLive, &live_);
  if (live_.json.empty()) return std::nullopt;
  return ParseDocument(live_.json);
}

std::optional<SiteDocument> Site::Live() {
  const std::lock_guard<std::mutex> guard(mutex_);
  Look(kDocument, &document_);
  std::optional<nlohmann::json> state = LiveState();
  const auto runs = [&] { return state && state->value("state", nlohmann::json()) == "running"; };
  const auto locks = [&] { return state->value("lock", nlohmann::json()) == true; };
  if (runs() && locks() && !IsFolderLocked(root_ / "live")) {
    state = LiveState();  // it may have ended between our two looks
    if (runs()) {
      (*state)["state"] = "interrupted";
      (*state)["message"] = "the run was ended from outside; run the same command again to continue it";
    }
  }
  if (!state) return std::nullopt;
  (*state)["document"] = !document_.json.empty();
  (*state)["document_revision"] = document_.revision;
  std::string text = state->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string tag = TagOf(text);
  return SiteDocument{std::move(text), std::move(tag)};
}

std::optional<FileBelow> Site::File(std::string_view path) {
  {
    const std::lock_guard<std::mutex> guard(mutex_);
    Look(kDocument, &document_);
    Look(kLive, &live_);
    const std::string name(path);
    if (!document_.urls.contains(name) && !live_.urls.contains(name)) return std::nullopt;
  }
  return FileBelow::Open(root_, path);
}

}  // namespace oraclegs

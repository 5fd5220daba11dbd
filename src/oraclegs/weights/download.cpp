#include "oraclegs/weights/download.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/weights/http.h"
#include "oraclegs/weights/part_file.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMega = 1'000'000, kKilo = 1000;

/// "bytes 100-199/200" -> 100 and 200, "bytes */200" -> nothing and 200.
struct ContentRange {
  std::optional<uint64_t> begin, total;
};
ContentRange ParseRange(const HttpReply& reply) {
  const auto it = reply.headers.find("content-range");
  if (it == reply.headers.end()) return {};
  std::string_view text = it->second;
  if (!text.starts_with("bytes ")) return {};
  text.remove_prefix(6);
  const auto number = [](std::string_view digits) -> std::optional<uint64_t> {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    return value;
  };
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos) return {};
  return {number(text.substr(0, text.find('-'))), number(text.substr(slash + 1))};
}

/// The SHA-256 that the server sends: the entity tag of a large file on Hugging Face is one.
std::string SentSha256(const HttpReply& reply) {
  for (const char* header : {"x-linked-etag", "etag"}) {
    const auto it = reply.headers.find(header);
    if (it == reply.headers.end()) continue;
    std::string tag = it->second;
    if (tag.starts_with("W/")) tag.erase(0, 2);
    if (tag.size() >= 2 && tag.front() == '"' && tag.back() == '"') tag = tag.substr(1, tag.size() - 2);
    if (IsSha256(tag)) return tag;
  }
  return "";
}

/// Thrown to leave an answer that does not join what is there.
struct StartAnew {};

class Transfer {
 public:
  Transfer(const DownloadRequest& request, const Listener& listener)
      : request_(request), listener_(listener), part_(request.to), shown_(WithoutSecrets(request.url)) {}

  void Run() {
    while (!TryOnce()) {
    }
    Verify();
    part_.Finish();
  }

 private:
  /// True when all bytes are there; false to ask again.
  bool TryOnce() {
    const uint64_t before = part_.size();
    const HttpHandlers handlers{[&](const HttpReply& reply) { Begin(reply); },
                                [&](std::string_view bytes) { Arrive(bytes); }};
    HttpEnd end;
    try {
      end = HttpGet({request_.url, request_.bearer, before}, handlers);
    } catch (const StartAnew&) {
      Restart();
      return false;
    }
    if (end.reply.status == 416 && before > 0) return RangeRefused(end.reply);
    if (end.reply.status != 200 && end.reply.status != 206) Refused(end.reply.status);
    std::string lost = end.dropped;
    if (lost.empty() && total_ > 0 && part_.size() < total_) lost = "the server closed the connection";
    if (lost.empty()) return true;
    if (part_.size() > before) {
      listener_(Note{fmt::format("{}: {}; going on from byte {}", shown_, lost, part_.size())});
      return false;
    }
    throw RunError("{}: {} after {} of {} bytes; the same command continues", shown_, lost, part_.size(),
                   total_ > 0 ? std::to_string(total_) : "an unknown number of");
  }

  void Begin(const HttpReply& reply) {
    const std::string sent = SentSha256(reply);
    if (!request_.sha256.empty() && !sent.empty() && sent != request_.sha256) {
      part_.Discard();
      throw RunError(
          "{}: the server has a file with SHA-256 {}, expected {}; it was replaced: get an oraclegs that "
          "knows the new one, or the old file from elsewhere",
          shown_, sent, request_.sha256);
    }
    sha256_ = request_.sha256.empty() ? sent : request_.sha256;
    uint64_t sent_bytes = reply.Number("content-length", 0);
    if (reply.status == 200) {
      part_.Restart();  // this server knows no ranges, or nothing was there
    } else {
      const ContentRange range = ParseRange(reply);
      if (range.begin != part_.size()) throw StartAnew();
      sent_bytes = range.total.value_or(0);
    }
    total_ = request_.bytes > 0 ? request_.bytes : reply.Number("x-linked-size", sent_bytes);
    if (sent_bytes > 0 && sent_bytes != total_) {
      part_.Discard();
      throw RunError("{}: the server has {} bytes, expected {}; try again later, or without a mirror or proxy", shown_,
                     sent_bytes, total_);
    }
    RequireSpace();
  }

  void Restart() {
    if (restarted_) throw RunError("{}: the server's parts do not join; try another server or proxy", shown_);
    restarted_ = true;
    part_.Restart();
  }

  void Arrive(std::string_view bytes) {
    if (total_ > 0 && bytes.size() > total_ - std::min(total_, part_.size())) {
      part_.Discard();
      throw RunError("{}: is longer than the {} bytes it should have; try another server or proxy", shown_, total_);
    }
    part_.Append(bytes);
    const bool small = total_ > 0 && total_ < 10 * kMega;
    const uint64_t unit = small ? kKilo : kMega, done = part_.size() / unit;
    if (done == reported_) return;
    reported_ = done;
    listener_(StepDone{request_.stage, static_cast<int64_t>(done), static_cast<int64_t>((total_ + unit - 1) / unit),
                       small ? "kB" : "MB", ""});
  }

  /// 416: we may have asked for what lies behind the last byte.
  bool RangeRefused(const HttpReply& reply) {
    const std::string sent = SentSha256(reply);
    sha256_ = request_.sha256.empty() ? sent : request_.sha256;
    total_ = request_.bytes > 0 ? request_.bytes : ParseRange(reply).total.value_or(0);
    if (total_ > 0 && part_.size() == total_) return true;
    Restart();
    return false;
  }

  [[noreturn]] void Refused(int status) const {
    if (status == 401) {
      throw InputError(
          "{}: the server asks for an account (401); set HF_TOKEN to a token of an account that has agreed to "
          "the license on the model's page",
          shown_);
    }
    if (status == 403) {
      throw InputError("{}: access denied (403); agree to the license on the model's page with the account of HF_TOKEN",
                       shown_);
    }
    if (status == 404 || status == 410) {
      throw InputError("{}: is not there ({}); it was moved or renamed, see docs/models.md for doing it by hand",
                       shown_, status);
    }
    if (status == 429 || status >= 500) {
      throw RunError("{}: the server is busy or broken ({}); try again later, the same command continues", shown_,
                     status);
    }
    throw RunError("{}: the server answers {}; try again later", shown_, status);
  }

  void RequireSpace() const {
    std::error_code unknown;
    const auto space = std::filesystem::space(request_.to.parent_path(), unknown);
    if (unknown || total_ == 0) return;
    const uint64_t needed = total_ - std::min(total_, part_.size());
    if (needed > space.available) {
      throw RunError("{}: {} MB are needed, {} are free; free some, or set ORACLEGS_MODELS to another disk",
                     request_.to.parent_path().string(), needed / kMega, space.available / kMega);
    }
  }

  void Verify() {
    const std::string found = part_.Sha256Hex();
    if (sha256_.empty()) {
      listener_(Warning{fmt::format("{}: its checksum is not known, only its length was compared", shown_)});
    } else if (found != sha256_) {
      part_.Discard();
      throw RunError("{}: its SHA-256 is {}, expected {}; it was damaged on the way, the same command tries again",
                     shown_, found, sha256_);
    }
  }

  const DownloadRequest& request_;
  const Listener& listener_;
  PartFile part_;
  std::string shown_, sha256_;
  uint64_t total_ = 0;                ///< 0 = not known
  uint64_t reported_ = ~uint64_t{0};  ///< bytes at the last progress event
  bool restarted_ = false;
};

}  // namespace

void Download(const DownloadRequest& request, const Listener& listener) {
  RequireWritableFolder(request.to.parent_path());
  Transfer(request, listener).Run();
}

}  // namespace oraclegs

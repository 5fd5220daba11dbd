#include "oraclegs/weights/http.h"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <exception>
#include <memory>
#include <mutex>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"

namespace oraclegs {
namespace {

constexpr int kMaxRedirects = 10;
constexpr long kConnectSeconds = 30, kStallSeconds = 60;
constexpr size_t kMaxHeaders = 1000, kMaxHeaderBytes = 16384;

struct UrlDeleter {
  void operator()(CURLU* url) const { curl_url_cleanup(url); }
};
struct EasyDeleter {
  void operator()(CURL* curl) const { curl_easy_cleanup(curl); }
};
struct ListDeleter {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using Easy = std::unique_ptr<CURL, EasyDeleter>;

using Url = std::unique_ptr<CURLU, UrlDeleter>;

/// Null when it is no address.
Url ParseUrl(const std::string& address) {
  Url url(curl_url());
  if (url && curl_url_set(url.get(), CURLUPART_URL, address.c_str(), 0) != CURLUE_OK) url.reset();
  return url;
}

/// Empty when the address has no such part.
std::string PartOf(const Url& url, CURLUPart part, unsigned flags = 0) {
  char* text = nullptr;
  if (curl_url_get(url.get(), part, &text, flags) != CURLUE_OK) return "";
  std::string out = text;
  curl_free(text);
  return out;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

/// One request and its answer; a member of what libcurl calls back.
struct Exchange {
  CURL* curl;
  const HttpHandlers* handlers;
  HttpReply* reply;
  bool begun = false;
  std::exception_ptr thrown;

  bool HasFile() const { return reply->status == 200 || reply->status == 206; }

  /// Runs `action`; keeps what it throws, which must not travel through libcurl.
  template <class Action>
  bool Guarded(const Action& action) {
    try {
      action();
      return true;
    } catch (...) {
      thrown = std::current_exception();
      return false;
    }
  }
  void Begin() {
    if (begun) return;
    begun = true;
    handlers->begin(*reply);
  }
  void Header(std::string_view line) {
    if (line.starts_with("HTTP/")) return;
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos || line.size() > kMaxHeaderBytes || reply->headers.size() >= kMaxHeaders)
      return;
    std::string name(line.substr(0, colon));
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    const std::string value(Trimmed(line.substr(colon + 1)));
    // The first server's word about the file is not overruled by a server it redirects to.
    if (name.starts_with("x-linked-")) {
      reply->headers.emplace(name, value);
    } else {
      reply->headers[name] = value;
    }
  }
  void Body(std::string_view bytes) {
    long status = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    reply->status = static_cast<int>(status);
    if (!HasFile()) return;
    Begin();
    handlers->body(bytes);
  }

  static size_t OnHeader(char* data, size_t size, size_t count, void* self) {
    auto* exchange = static_cast<Exchange*>(self);
    const bool good = exchange->Guarded([&] { exchange->Header({data, size * count}); });
    return good ? size * count : 0;
  }
  static size_t OnBody(char* data, size_t size, size_t count, void* self) {
    auto* exchange = static_cast<Exchange*>(self);
    const bool good = exchange->Guarded([&] { exchange->Body({data, size * count}); });
    return good ? size * count : 0;
  }
  static int OnProgress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) { return InterruptRequested() ? 1 : 0; }
};

/// Failures after which the same request may well succeed, and what has arrived is good.
bool IsDropped(CURLcode code) {
  return code == CURLE_PARTIAL_FILE || code == CURLE_RECV_ERROR || code == CURLE_OPERATION_TIMEDOUT ||
         code == CURLE_HTTP2 || code == CURLE_HTTP2_STREAM || code == CURLE_GOT_NOTHING || code == CURLE_SEND_ERROR;
}

Easy MakeEasy() {
  static std::once_flag once;
  std::call_once(once, [] { curl_global_init(CURL_GLOBAL_DEFAULT); });
  Easy easy(curl_easy_init());
  if (!easy) throw RunError("libcurl cannot start");
  CURL* curl = easy.get();
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_SUPPRESS_CONNECT_HEADERS, 1L);  // a proxy's answer is not the server's
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "oraclegs");
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, kStallSeconds);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, Exchange::OnProgress);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, Exchange::OnHeader);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, Exchange::OnBody);
  return easy;
}

std::string Reason(CURLcode code, const char* detail) { return *detail ? detail : curl_easy_strerror(code); }

}  // namespace

uint64_t HttpReply::Number(const std::string& header, uint64_t otherwise) const {
  const auto it = headers.find(header);
  if (it == headers.end()) return otherwise;
  uint64_t number = 0;
  const char* last = it->second.data() + it->second.size();
  const auto [end, error] = std::from_chars(it->second.data(), last, number);
  return error == std::errc() && end == last && !it->second.empty() ? number : otherwise;
}

std::string WithoutSecrets(const std::string& url) {
  if (const Url parsed = ParseUrl(url)) {
    const std::string port = PartOf(parsed, CURLUPART_PORT, CURLU_NO_DEFAULT_PORT);
    const std::string path = PartOf(parsed, CURLUPART_PATH);
    return fmt::format("{}://{}{}{}{}", PartOf(parsed, CURLUPART_SCHEME), PartOf(parsed, CURLUPART_HOST),
                       port.empty() ? "" : ":", port, path == "/" && !url.ends_with('/') ? "" : path);
  }
  const size_t at = url.rfind('@');  // whatever it was meant to be: what stands before may be a password
  const std::string rest = at == std::string::npos ? url : url.substr(at + 1);
  return rest.substr(0, rest.find_first_of("?#"));
}

Origin OriginOf(const std::string& address) {
  const Url url = ParseUrl(address);
  if (!url) return {};
  Origin origin;
  origin.scheme = PartOf(url, CURLUPART_SCHEME);
  origin.host = PartOf(url, CURLUPART_HOST);
  std::transform(origin.host.begin(), origin.host.end(), origin.host.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  origin.text = fmt::format("{}://{}:{}", origin.scheme, origin.host, PartOf(url, CURLUPART_PORT, CURLU_DEFAULT_PORT));
  origin.has_user = !PartOf(url, CURLUPART_USER).empty() || !PartOf(url, CURLUPART_PASSWORD).empty();
  return origin;
}

HttpEnd HttpGet(const HttpRequest& request, const HttpHandlers& handlers) {
  const Origin first = OriginOf(request.url);
  HttpEnd end;
  std::string url = request.url;
  for (int hop = 0; hop <= kMaxRedirects; ++hop) {
    ThrowIfInterrupted();
    // Another one for each: libcurl 7.88 joins a first header that begins with a blank to one of the answer before,
    // which it has freed.
    const Easy easy = MakeEasy();
    CURL* curl = easy.get();
    const Origin origin = OriginOf(url);
    const std::string shown = WithoutSecrets(url);
    if (origin.text.empty()) throw RunError("{}: is no address of a server", shown);
    if (first.scheme == "https" && origin.scheme != "https") {
      throw RunError("{}: redirects to {}, which is not encrypted; refused", WithoutSecrets(request.url), shown);
    }
    end.reply.status = 0;
    end.reply.headers.erase("location");
    for (const char* of_one_answer : {"content-length", "content-range"}) end.reply.headers.erase(of_one_answer);
    Exchange exchange{curl, &handlers, &end.reply, false, nullptr};
    char detail[CURL_ERROR_SIZE] = "";
    // The target of a redirection is another party: it gets neither the secret nor a header that held it.
    const bool trusted = !request.bearer.empty() && origin.text == first.text;
    const std::unique_ptr<curl_slist, ListDeleter> list(
        trusted ? curl_slist_append(nullptr, ("Authorization: Bearer " + request.bearer).c_str()) : nullptr);
    curl_easy_setopt(curl, CURLOPT_HTTPHEADER, list.get());
    curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
    const std::string range = fmt::format("{}-", request.offset);
    curl_easy_setopt(curl, CURLOPT_RANGE, request.offset > 0 ? range.c_str() : nullptr);
    curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, detail);
    curl_easy_setopt(curl, CURLOPT_HEADERDATA, &exchange);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, &exchange);
    const CURLcode code = curl_easy_perform(curl);
    curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, nullptr);
    if (exchange.thrown) std::rethrow_exception(exchange.thrown);
    if (code == CURLE_ABORTED_BY_CALLBACK) ThrowIfInterrupted();
    long status = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    end.reply.status = static_cast<int>(status);
    if (code != CURLE_OK) {
      if (exchange.HasFile() && IsDropped(code)) {
        end.dropped = Reason(code, detail);
        return end;
      }
      throw RunError("{}: no answer: {}; check the network, and http_proxy and https_proxy", shown,
                     Reason(code, detail));
    }
    char* next = nullptr;
    curl_easy_getinfo(curl, CURLINFO_REDIRECT_URL, &next);
    if (status < 300 || status >= 400 || !next) {
      if (exchange.HasFile()) exchange.Begin();
      return end;
    }
    url = next;
  }
  throw RunError("{}: redirects more than {} times", WithoutSecrets(request.url), kMaxRedirects);
}

}  // namespace oraclegs

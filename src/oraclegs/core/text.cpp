#include "oraclegs/core/text.h"

#include <fmt/format.h>
#include <cctype>
#include <cstring>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

constexpr size_t kMaxNamesShown = 5;

/// Characters: bytes that do not continue one.
size_t WidthOf(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

struct Character {
  uint32_t code = 0;
  size_t bytes = 1;
};

/// The character that begins `text`, which is not empty. A byte that begins none is a character of its own.
Character FirstCharacter(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const size_t bytes = lead >= 0xF0 && lead < 0xF5 ? 4 : lead >= 0xE0 ? 3 : 2;
  constexpr uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};  // of so many bytes; what is written longer is none
  if (lead < 0xC2 || lead >= 0xF5 || text.size() < bytes) return {lead};
  uint32_t code = lead & (0x7FU >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {lead};
    code = code << 6 | (byte(i) & 0x3FU);
  }
  return code < kSmallest[bytes] ? Character{lead} : Character{code, bytes};
}

/// Control characters, C1 included, whose U+009B and lone byte 9B begin the sequences of a terminal as ESC [ does;
/// separators of lines and paragraphs; embeddings, overrides and isolates of bidirectional text.
bool SteersTerminals(uint32_t code) {
  return code < ' ' || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 ||
         (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

std::string Tamed(std::string_view text, std::string_view allowed) {
  std::string tamed;
  while (!text.empty()) {
    const Character first = FirstCharacter(text);
    if (SteersTerminals(first.code) && allowed.find(text.front()) == std::string_view::npos) {
      tamed += '?';
    } else {
      tamed += text.substr(0, first.bytes);
    }
    text.remove_prefix(first.bytes);
  }
  return tamed;
}

constexpr size_t kMaxLetters = 64;  // longer texts are no slip of a word, and the distance costs their product
constexpr size_t kMinBeginning = 3;

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Letters to replace, insert, remove or swap with the next one to make `b` of `a`.
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const size_t replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({replaced, d[i - 1][j] + 1, d[i][j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string FormatSeconds(double seconds) {
  const auto s = static_cast<int64_t>(std::llround(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string SomeNames(const std::vector<std::string>& names) {
  const size_t shown = std::min(names.size(), kMaxNamesShown);
  std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<ptrdiff_t>(shown), ", "));
  if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

bool NaturalLess(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto run = [&](std::string_view text, size_t from) {
    size_t end = from;
    while (end < text.size() && digit(text[end])) ++end;
    return text.substr(from, end - from);
  };
  const auto value = [](std::string_view digits) {
    return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
  };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const std::string_view left = run(a, i), right = run(b, j);
      const std::string_view x = value(left), y = value(right);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
      i += left.size(), j += right.size();
    } else if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    } else {
      ++i, ++j;
    }
  }
  const size_t left = a.size() - i, right = b.size() - j;
  return left != right ? left < right : a < b;
}

std::vector<std::string> SplitTrimmed(const std::string& text, char separator) {
  constexpr const char* kBlanks = " \t\r";
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const size_t first = part.find_first_not_of(kBlanks);
    if (first != std::string::npos) parts.push_back(part.substr(first, part.find_last_not_of(kBlanks) - first + 1));
    begin = end + 1;
  }
  return parts;
}

std::string ShellQuoted(const std::string& word) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || (c & 0x80) != 0 || std::strchr("-_./,:=@+%", c) != nullptr;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

bool IsUtf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

std::string ForTerminal(std::string_view text) { return Tamed(text, "\t\n"); }

std::string OneLine(std::string_view text) { return Tamed(text, ""); }

std::string PercentEncoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte < 0x80 && (std::isalnum(byte) != 0 || c == '.' || c == '-' || c == '_' || c == '/');
    encoded += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return encoded;
}

std::string EscapeBytes(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    escaped += byte < 0x80 ? std::string(1, c) : fmt::format("\\x{:02X}", byte);
  }
  return escaped;
}

std::string Printable(std::string_view text, size_t max_bytes) {
  std::string shown(text.substr(0, max_bytes));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

std::string AlignColumns(const std::vector<std::vector<std::string>>& rows, const std::string& sides) {
  std::vector<size_t> widths(sides.size(), 0);
  for (const auto& row : rows) {
    const size_t own = row.size() < sides.size() && !row.empty() ? row.size() - 1 : row.size();
    for (size_t c = 0; c < own; ++c) widths[c] = std::max(widths[c], WidthOf(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += "  ";
      const bool reaches_over = row.size() < sides.size() && c + 1 == row.size();
      const std::string blanks(reaches_over ? 0 : widths[c] - WidthOf(row[c]), ' ');
      line += sides[c] == 'r' ? blanks + row[c] : row[c] + blanks;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string NearestWord(std::string_view typed, const std::vector<std::string>& words) {
  if (typed.empty() || typed.size() > kMaxLetters) return "";
  const std::string lower = Lower(typed);
  std::string nearest;
  size_t least = std::max<size_t>(1, (lower.size() + 1) / 3) + 1;
  for (const std::string& word : words) {
    if (word.size() > kMaxLetters) continue;
    const size_t distance = EditDistance(lower, Lower(word));
    if (distance < least && distance < word.size()) least = distance, nearest = word;
  }
  if (!nearest.empty() || lower.size() < kMinBeginning) return nearest;
  for (const std::string& word : words) {
    if (Lower(word).starts_with(lower)) return word;
  }
  return "";
}

std::string DidYouMean(std::string_view typed, const std::vector<std::string>& words) {
  const std::string nearest = NearestWord(typed, words);
  return nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
}

}  // namespace oraclegs

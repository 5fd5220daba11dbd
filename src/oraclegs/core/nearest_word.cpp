#include "oraclegs/core/nearest_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace oraclegs {
namespace {

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

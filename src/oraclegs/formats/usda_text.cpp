#include "oraclegs/formats/usda_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr std::string_view kUsdaMark = "#usda 1.", kUsdcMark = "PXR-USDC";
constexpr std::string_view kLineBlanks = " \t\r", kAllBlanks = " \t\r\n;";
constexpr std::string_view kOpening = "([{", kClosing = ")]}";
constexpr size_t kShownBytes = 40;  // of a text in a message

bool IsOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '.'; }

}  // namespace

UsdaText::UsdaText(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
  if (Follows(kUsdcMark)) {
    throw InputError("{}: is USD's binary format, and only its text is read; convert it with usdcat -o splat.usda",
                     file_);
  }
  if (!Follows(kUsdaMark)) throw InputError("{}: does not begin with '#usda 1.0'; is it a text file of USD?", file_);
}

void UsdaText::Fail(const std::string& what) const {
  const size_t here = std::min(at_, text_.size());
  const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(here), '\n');
  throw InputError("{}:{}: {}; export it again", file_, line, what);
}

void UsdaText::PassBlanks(std::string_view blanks) {
  while (at_ < text_.size()) {
    if (blanks.find(text_[at_]) != std::string_view::npos) {
      ++at_;
    } else if (text_[at_] == '#' || Follows("//")) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (Follows("/*")) {
      PassUntil("*/", 2, "a comment");
    } else {
      return;
    }
  }
}

void UsdaText::PassUntil(std::string_view end, size_t behind, const char* what) {
  const size_t found = text_.find(end, std::min(at_ + behind, text_.size()));
  if (found == std::string_view::npos) Fail(fmt::format("{} that begins here does not end", what));
  at_ = found + end.size();
}

bool UsdaText::AtEnd() {
  PassBlanks(kAllBlanks);
  return at_ == text_.size();
}

bool UsdaText::WordFollows() {
  PassBlanks(kLineBlanks);
  return at_ < text_.size() && IsOfWord(text_[at_]);
}

bool UsdaText::Take(char c) {
  if (AtEnd() || text_[at_] != c) return false;
  ++at_;
  return true;
}

bool UsdaText::TakeOnLine(char c) {
  PassBlanks(kLineBlanks);
  if (at_ == text_.size() || text_[at_] != c) return false;
  ++at_;
  return true;
}

std::string_view UsdaText::Word() {
  AtEnd();
  const size_t begin = at_;
  while (at_ < text_.size() && IsOfWord(text_[at_])) ++at_;
  if (at_ == begin) Fail(fmt::format("'{}' stands where a name was expected", Printable(text_.substr(at_, 1))));
  if (Follows("[]")) at_ += 2;
  return text_.substr(begin, at_ - begin);
}

std::string_view UsdaText::Quoted() {
  if (AtEnd() || (text_[at_] != '"' && text_[at_] != '\'')) Fail("a text in quotes was expected");
  const char quote = text_[at_];
  const std::string three(3, quote);
  const size_t width = Follows(three) ? 3 : 1;
  const size_t begin = at_ + width;
  for (size_t end = begin; end < text_.size(); ++end) {
    if (text_[end] == '\\') {
      ++end;
    } else if (text_.substr(end, width) == three.substr(0, width)) {
      at_ = end + width;
      return text_.substr(begin, end - begin);
    }
  }
  Fail("a text that begins here does not end");
}

std::vector<std::string_view> UsdaText::QuotedList() {
  if (!Take('[')) return {Quoted()};
  std::vector<std::string_view> list;
  while (!Take(']')) {
    list.push_back(Quoted());
    Take(',');
  }
  return list;
}

void UsdaText::SkipValue() {
  std::string open;  // what closes the brackets that are open, not recursion: a file may have a million of them
  do {
    if (AtEnd()) Fail("the text ends within a value");
    const char c = text_[at_];
    const size_t opening = kOpening.find(c);
    if (c == '"' || c == '\'') {
      Quoted();
    } else if (c == '@') {
      Follows("@@@") ? PassUntil("@@@", 3, "a path") : PassUntil("@", 1, "a path");
    } else if (c == '<') {
      PassUntil(">", 1, "a path");
    } else if (opening != std::string_view::npos) {
      open.push_back(kClosing[opening]);
      ++at_;
    } else if (kClosing.find(c) != std::string_view::npos) {
      if (open.empty() || open.back() != c) Fail(fmt::format("'{}' closes what is not open", c));
      open.pop_back();
      ++at_;
    } else if (IsOfWord(c) || c == '-' || c == '+') {
      ++at_;
      while (at_ < text_.size() && (IsOfWord(text_[at_]) || text_[at_] == '-' || text_[at_] == '+')) ++at_;
    } else if (open.empty()) {
      Fail(fmt::format("'{}' stands where a value was expected", Printable(text_.substr(at_, 1))));
    } else {
      ++at_;  // separators
    }
  } while (!open.empty());
}

template <class T>
T UsdaText::Number() {
  T value = 0;
  const char *from = text_.data() + at_, *end = text_.data() + text_.size();
  auto [stop, error] = std::from_chars(from, end, value);
  if (error == std::errc::result_out_of_range) {  // of a float: 1e-50 is 0, 1e300 infinite
    double wide = 0;
    if (std::from_chars(from, end, wide).ec == std::errc()) {
      value = static_cast<T>(wide);
      error = std::errc();
    }
  }
  if (error != std::errc()) Fail(fmt::format("'{}' is no number", Printable(text_.substr(at_, kShownBytes))));
  at_ += static_cast<size_t>(stop - from);
  return value;
}

template <class T>
std::vector<T> UsdaText::Numbers(int components) {
  std::vector<T> numbers;
  std::string open;
  size_t first = 0;  // number of the innermost parentheses
  do {
    if (AtEnd()) Fail("the text ends within numbers");
    const char c = text_[at_];
    if (c == '[' || c == '(') {
      if (open.size() == 3) Fail("numbers are nested too deep");
      open.push_back(kClosing[kOpening.find(c)]);
      first = numbers.size();
      ++at_;
    } else if (c == ']' || c == ')') {
      if (open.empty() || open.back() != c) Fail(fmt::format("'{}' closes what is not open", c));
      if (c == ')' && numbers.size() - first != static_cast<size_t>(components)) {
        Fail(fmt::format("{} numbers are in parentheses, expected {}", numbers.size() - first, components));
      }
      open.pop_back();
      ++at_;
    } else if (c == ',' && !open.empty()) {
      ++at_;
    } else {
      if ((components > 1) != (!open.empty() && open.back() == ')')) {
        Fail(fmt::format("'{}' stands where {} was expected", Printable(text_.substr(at_, kShownBytes)),
                         components > 1 ? fmt::format("'(' before {} numbers", components) : "a number"));
      }
      numbers.push_back(Number<T>());
    }
  } while (!open.empty());
  return numbers;
}

template std::vector<float> UsdaText::Numbers<float>(int components);
template std::vector<double> UsdaText::Numbers<double>(int components);

}  // namespace oraclegs

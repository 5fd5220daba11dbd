#pragma once
// Text for people: durations, sizes, lists of names, words out of damaged files, counts, mistyped words, columns.

#include <fmt/format.h>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// "9:05", "1:02:33"
std::string FormatSeconds(double seconds);

/// 10^9 bytes, as disks and GPUs are sold.
inline double Gigabytes(int64_t bytes) { return static_cast<double>(bytes) * 1e-9; }

/// "a, b, c, d, e and 7 more": at most five of `names`.
std::string SomeNames(const std::vector<std::string>& names);

/// Names as people sort them: runs of digits compare by their value, all else by bytes, so that r_2 comes before r_10.
/// Names that differ in leading zeros alone compare by bytes. A strict weak order.
bool NaturalLess(std::string_view a, std::string_view b);

/// The parts of `text` between separators, without the blanks around them; empty ones are left out.
std::vector<std::string> SplitTrimmed(const std::string& text, char separator);

/// The word as a POSIX shell reads it: as it is, or in single quotes.
std::string ShellQuoted(const std::string& word);

/// True when `text` can stand in JSON as it is.
bool IsUtf8(const std::string& text);

/// Text that may be shown in a terminal: '?' in place of what steers one (control characters of ASCII and Unicode, also
/// as single bytes; separators of lines; what turns the direction of writing), but for tabs and ends of lines.
std::string ForTerminal(std::string_view text);

/// A file name or a message, which is one line: as ForTerminal, and '?' for tabs and ends of lines, too.
std::string OneLine(std::string_view text);

/// The text as a part of an address: bytes other than ASCII letters, digits, '.', '-', '_' and '/' as %XX.
std::string PercentEncoded(std::string_view text);

/// Bytes outside ASCII as \xNN, to show a name that is not UTF-8.
std::string EscapeBytes(const std::string& text);

/// A word out of a file for an error message: its first `max_bytes`, with '?' for what is not printable ASCII.
std::string Printable(std::string_view text, size_t max_bytes = 120);

/// The rows as lines, columns two blanks apart; sides[c] is 'l' or 'r'. The last cell of a row that has fewer cells
/// than `sides` reaches over the columns it lacks. Texts are UTF-8, one column wide a character; no line ends in
/// blanks.
std::string AlignColumns(const std::vector<std::vector<std::string>>& rows, const std::string& sides);

/// "1 view", "0 views", "12 views": a count with a noun whose plural has an s more.
template <std::integral Count>
std::string Counted(Count count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// The one of `words` that `typed` is most likely a slip of: at most a third of its letters are wrong, missing, too
/// many or swapped with the next, or it is the beginning (3 letters or more) of a word. Case does not count. The first
/// of several as near; empty when none is.
std::string NearestWord(std::string_view typed, const std::vector<std::string>& words);

/// "; did you mean 'white'?" of the nearest word, or nothing: the end of an error message.
std::string DidYouMean(std::string_view typed, const std::vector<std::string>& words);

}  // namespace oraclegs

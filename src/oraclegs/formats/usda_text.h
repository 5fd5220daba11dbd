#pragma once
// The words and values of USD's text format (.usda), front to back: what is not asked for is passed over.

#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

class UsdaText {
 public:
  /// `text` must live as long as this. Throws InputError naming `file`, as all of this class, and from then on also the
  /// line: no text of USD 1, or USD's binary format.
  UsdaText(std::string_view text, std::string file);

  const std::string& file() const { return file_; }
  [[noreturn]] void Fail(const std::string& what) const;

  /// Passes blanks, comments, and the ends of lines and statements; true where the text ends.
  bool AtEnd();
  /// Passes blanks of this line only; true where a word follows.
  bool WordFollows();
  /// Passes what AtEnd passes; true, and past it, where this character follows.
  bool Take(char c);
  /// True, and past it, where this character follows on this line.
  bool TakeOnLine(char c);
  /// A name or a type: "radiance:sphericalHarmonicsDegree", "point3f[]".
  std::string_view Word();
  /// A text in quotes, as it stands there.
  std::string_view Quoted();
  /// A list of texts in quotes, or one.
  std::vector<std::string_view> QuotedList();
  /// Passes one value of any kind.
  void SkipValue();
  /// Numbers of a value or an array, `components` in each pair of parentheses (1: none). A matrix is an array of rows.
  template <class T>
  std::vector<T> Numbers(int components);

 private:
  bool Follows(std::string_view word) const { return text_.substr(at_, word.size()) == word; }
  void PassBlanks(std::string_view blanks);
  /// Past the next `end`, which stands `behind` characters or more from here.
  void PassUntil(std::string_view end, size_t behind, const char* what);
  template <class T>
  T Number();

  std::string_view text_;
  std::string file_;
  size_t at_ = 0;
};

}  // namespace oraclegs

#pragma once
// The word that a mistyped one was meant to be.

#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

/// The one of `words` that `typed` is most likely a slip of: at most a third of its letters are wrong, missing, too
/// many or swapped with the next, or it is the beginning (3 letters or more) of a word. Case does not count. The first
/// of several as near; empty when none is.
std::string NearestWord(std::string_view typed, const std::vector<std::string>& words);

/// "; did you mean 'white'?" of the nearest word, or nothing: the end of an error message.
std::string DidYouMean(std::string_view typed, const std::vector<std::string>& words);

}  // namespace oraclegs

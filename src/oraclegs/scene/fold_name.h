#pragma once

#include <string>
#include <string_view>

namespace oraclegs {

/// A file name for comparison with names that another system wrote: letters in lower case and without accents, so that
/// composed and decomposed Unicode (as Macs store it) are equal. Latin, Greek, Cyrillic, kana and Hangul. Bytes that
/// are not UTF-8 stay as they are. Different names may become equal; who compares asks for exactly one match.
std::string FoldName(std::string_view name);

}  // namespace oraclegs

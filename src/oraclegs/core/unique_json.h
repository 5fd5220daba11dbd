#pragma once
// JSON of files that somebody else wrote.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace oraclegs {

/// Parses JSON that says nothing twice: the library alone would keep the last of two equal keys. Throws InputError with
/// `file` and `part` ("header") when it is no JSON, repeats a key or is nested more than 64 levels deep.
nlohmann::json ParseUniqueJson(std::string_view text, const std::string& file, const std::string& part);

/// Parses JSON of any file. Values nested more than 64 levels deep are refused: copying one takes a recursion a level,
/// and a file of a few kilobytes would end the program. Throws nlohmann::json::exception.
nlohmann::json ParseJson(std::string_view text);

/// Parses as ParseJson does, without an exception: returns a discarded value where that throws.
nlohmann::json ParseJsonOrDiscard(std::string_view text);

/// A name out of a file, in quotes and made fit for a one-line message: at most 120 bytes, all of them printable.
std::string QuotedForMessage(const std::string& name);

}  // namespace oraclegs

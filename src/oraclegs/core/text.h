#pragma once
// Text for people: durations, sizes, and columns that stand below each other.

#include <cstdint>
#include <string>
#include <vector>

namespace oraclegs {

/// "9:05", "1:02:33"
std::string FormatSeconds(double seconds);

/// 10^9 bytes, as disks and GPUs are sold.
inline double Gigabytes(int64_t bytes) { return static_cast<double>(bytes) * 1e-9; }

/// The rows as lines, columns two blanks apart; sides[c] is 'l' or 'r'. The last cell of a row that has fewer cells
/// than `sides` reaches over the columns it lacks. Texts are UTF-8, one column wide a character; no line ends in
/// blanks.
std::string AlignColumns(const std::vector<std::vector<std::string>>& rows, const std::string& sides);

}  // namespace oraclegs

#pragma once
// What an ablation adds, part by part: the rows of Table 3 of the OracleGS paper in its order, then what this program
// has beyond it.

#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// One part of the program. Each row trains with what the rows above it switched on.
struct AblationRow {
  const char* name;         ///< for --rows and folders
  const char* label;        ///< for tables
  const char* explanation;  ///< what it adds, in one sentence
  /// Changes the options of the row above. Values come from `asked`, the options the whole ablation was asked for, so
  /// that the last row is what `reconstruct` makes of them.
  void (*apply)(const RunOptions& asked, RunOptions* options);
};

const std::vector<AblationRow>& AblationRows();

/// Options of a row, an index of AblationRows(). Those of the last row are `asked`.
RunOptions RowOptions(size_t row, const RunOptions& asked);

/// The rows that --rows names by number (from 1) or name, separated by commas, in the order of the table; all of them
/// for "". Throws UsageError that lists the rows.
std::vector<size_t> ChooseRows(const std::string& words);

/// Throws UsageError when `asked` lacks what several rows are about: proposals, and a start of the rows' choice.
void RequireAblatable(const RunOptions& asked);

}  // namespace oraclegs

#pragma once
// Images in a grid, with words beside them, as a PNG and as a PDF.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/image/colormap.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

struct Panel {
  Image8 image;         ///< 1 or 3 channels; of no size: the place stays empty
  std::string caption;  ///< below it; may be empty
};

struct Sheet {
  std::vector<std::string> heads;        ///< of the columns
  std::vector<std::vector<Panel>> rows;  ///< of heads.size() panels each
  std::optional<ColorMap> scale;         ///< a bar of its colors from 0 to 1, below all
  std::string scale_title;
};

struct SheetFiles {
  std::filesystem::path png, pdf;
};

/// Writes STEM.png and STEM.pdf, each panel panel_width pixels wide (a point in the PDF, which keeps the images' own
/// pixels). The PNG's larger side is at most 32767 pixels. Throws ShapeError for a row of another length, UsageError
/// when it would be larger, RunError when a file cannot be written.
SheetFiles WriteSheet(const Sheet& sheet, const std::filesystem::path& stem, int panel_width);

}  // namespace oraclegs

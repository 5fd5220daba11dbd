#pragma once
// Images in a grid, with headings and captions, as a PNG and as a PDF.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/image/colormap.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

struct Panel {
  Image8 image;         ///< 1 or 3 channels; an empty image leaves the place empty
  std::string caption;  ///< text below the image; may be empty
};

struct Sheet {
  std::vector<std::string> heads;        ///< heading of each column
  std::vector<std::vector<Panel>> rows;  ///< each row has heads.size() panels
  std::optional<ColorMap> scale;         ///< color map shown as a bar from 0 to 1 below all rows
  std::string scale_title;
};

struct SheetFiles {
  std::filesystem::path png, pdf;
};

/// Writes STEM.png and STEM.pdf. Each panel is panel_width pixels wide in the PNG and as many points in the PDF, which
/// keeps the images' own pixels. Throws ShapeError for a row of another length, UsageError when a side of the PNG would
/// exceed 32767 pixels, RunError when a file cannot be written.
SheetFiles WriteSheet(const Sheet& sheet, const std::filesystem::path& stem, int panel_width);

}  // namespace oraclegs

#include "oraclegs/output/figures/sheet.h"

#include <cairo-pdf.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr double kGap = 6, kMargin = 8, kLine = 18, kFontSize = 12, kBarHeight = 10;
constexpr double kMaxSide = 32767;  // limit of a cairo image

struct Release {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, Release>;
using Context = std::unique_ptr<cairo_t, Release>;

/// Positions of all parts, in pixels of the PNG.
struct Layout {
  double panel = 0, width = 0, height = 0;
  std::vector<double> tops, heights;  ///< top and height of each row's panels
  std::vector<bool> captioned;
  double scale_top = 0;
};

Layout Arrange(const Sheet& sheet, int panel_width) {
  Layout layout;
  layout.panel = panel_width;
  const auto columns = static_cast<double>(sheet.heads.size());
  layout.width = 2 * kMargin + columns * layout.panel + (columns - 1) * kGap;
  double y = kMargin + kLine;
  for (const std::vector<Panel>& row : sheet.rows) {
    double height = 0;
    bool captioned = false;
    for (const Panel& panel : row) {
      if (panel.image.width > 0) height = std::max(height, layout.panel * panel.image.height / panel.image.width);
      captioned |= !panel.caption.empty();
    }
    layout.tops.push_back(y), layout.heights.push_back(height), layout.captioned.push_back(captioned);
    y += height + (captioned ? kLine : 0) + kGap;
  }
  layout.scale_top = y;
  if (sheet.scale) y += kBarHeight + kLine + kGap;
  layout.height = y - kGap + kMargin;
  return layout;
}

void Write(cairo_t* context, const std::string& text, double center, double baseline, double max_width) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  const double scale = extents.x_advance > max_width ? max_width / extents.x_advance : 1;
  cairo_save(context);
  cairo_translate(context, center - scale * extents.x_advance / 2, baseline);
  cairo_scale(context, scale, scale);
  cairo_move_to(context, 0, 0);
  cairo_show_text(context, text.c_str());
  cairo_restore(context);
}

void Draw(cairo_t* context, const Image8& image, double left, double top, double width) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  unsigned char* const pixels = cairo_image_surface_get_data(surface.get());
  if (pixels == nullptr) throw RunError("an image of {} x {} cannot be drawn", image.width, image.height);
  const int stride = cairo_image_surface_get_stride(surface.get());
  const auto channels = static_cast<size_t>(image.channels);
  for (int y = 0; y < image.height; ++y) {
    auto* const row = reinterpret_cast<uint32_t*>(pixels + static_cast<ptrdiff_t>(y) * stride);
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* p = image.data.data() + (static_cast<size_t>(y) * image.width + x) * channels;
      const size_t g = channels > 1 ? 1 : 0, b = channels > 1 ? 2 : 0;
      row[x] = uint32_t{p[0]} << 16 | uint32_t{p[g]} << 8 | uint32_t{p[b]};
    }
  }
  cairo_surface_mark_dirty(surface.get());
  const double scale = width / image.width;
  cairo_save(context);
  cairo_translate(context, left, top);
  cairo_rectangle(context, 0, 0, width, scale * image.height);
  cairo_clip(context);
  cairo_scale(context, scale, scale);
  cairo_set_source_surface(context, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(context), scale > 1 ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_paint(context);
  cairo_restore(context);
}

void DrawScale(cairo_t* context, const Sheet& sheet, const Layout& layout) {
  const double width = layout.panel, left = (layout.width - width) / 2, top = layout.scale_top;
  const int steps = static_cast<int>(width);
  Image8 bar{steps, static_cast<int>(kBarHeight), 3, {}};
  for (int i = 0; i < steps * bar.height; ++i) {
    const auto color = MapColor(*sheet.scale, static_cast<float>(i % steps) / static_cast<float>(steps - 1));
    bar.data.insert(bar.data.end(), color.begin(), color.end());
  }
  Draw(context, bar, left, top, width);
  cairo_set_source_rgb(context, 0, 0, 0);
  const double baseline = top + kBarHeight + kFontSize + 2;
  Write(context, "0", left, baseline, width);
  Write(context, sheet.scale_title, left + width / 2, baseline, width - 2 * kLine);
  Write(context, "1", left + width, baseline, width);
}

void Paint(cairo_surface_t* surface, const Sheet& sheet, const Layout& layout) {
  const Context context(cairo_create(surface));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  cairo_select_font_face(context.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context.get(), kFontSize);
  const auto left = [&](size_t column) { return kMargin + static_cast<double>(column) * (layout.panel + kGap); };
  cairo_set_source_rgb(context.get(), 0, 0, 0);
  for (size_t c = 0; c < sheet.heads.size(); ++c) {
    Write(context.get(), sheet.heads[c], left(c) + layout.panel / 2, kMargin + kFontSize, layout.panel);
  }
  for (size_t r = 0; r < sheet.rows.size(); ++r) {
    for (size_t c = 0; c < sheet.rows[r].size(); ++c) {
      const Panel& panel = sheet.rows[r][c];
      if (panel.image.width > 0) Draw(context.get(), panel.image, left(c), layout.tops[r], layout.panel);
      cairo_set_source_rgb(context.get(), 0, 0, 0);
      Write(context.get(), panel.caption, left(c) + layout.panel / 2,
            layout.tops[r] + layout.heights[r] + kFontSize + 1, layout.panel);
    }
  }
  if (sheet.scale) DrawScale(context.get(), sheet, layout);
  if (cairo_status(context.get()) != CAIRO_STATUS_SUCCESS) {
    throw RunError("the figure cannot be drawn: {}", cairo_status_to_string(cairo_status(context.get())));
  }
}

cairo_status_t Append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

SheetFiles WriteSheet(const Sheet& sheet, const std::filesystem::path& stem, int panel_width) {
  for (const std::vector<Panel>& row : sheet.rows) {
    if (row.size() != sheet.heads.size()) {
      throw ShapeError("WriteSheet: a row has {} panels, the sheet {} columns", row.size(), sheet.heads.size());
    }
  }
  const Layout layout = Arrange(sheet, panel_width);
  if (std::max(layout.width, layout.height) > kMaxSide) {
    throw UsageError("the figure would have {:.0f} x {:.0f} pixels; ask for narrower panels or fewer rows",
                     layout.width, layout.height);
  }
  SheetFiles files{stem.string() + ".png", stem.string() + ".pdf"};
  std::string png, pdf;
  {
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(layout.width)),
                                                     static_cast<int>(std::ceil(layout.height))));
    Paint(surface.get(), sheet, layout);
    if (cairo_surface_write_to_png_stream(surface.get(), Append, &png) != CAIRO_STATUS_SUCCESS) {
      throw RunError("{}: the figure cannot be packed", files.png.string());
    }
  }
  {
    const Surface surface(cairo_pdf_surface_create_for_stream(Append, &pdf, layout.width, layout.height));
    Paint(surface.get(), sheet, layout);
    cairo_surface_finish(surface.get());
  }
  WriteFileAtomically(files.png, png);
  WriteFileAtomically(files.pdf, pdf);
  return files;
}

}  // namespace oraclegs

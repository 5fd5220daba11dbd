#include "oraclegs/networks/seva_size.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs::seva {
namespace {

void RequirePositive(const char* who, const Size& size) {
  if (size.width > 0 && size.height > 0) return;
  throw ShapeError("{}: an image of {} x {} pixels", who, size.width, size.height);
}

int64_t RoundTo(int64_t value, int64_t stride) {
  return static_cast<int64_t>(std::floor(static_cast<double>(value) / static_cast<double>(stride) + 0.5)) * stride;
}

/// Start of an axis of the resized image in the working image.
int64_t Offset(int64_t resized, int64_t working, FitMode mode) {
  if (mode == FitMode::kPad) return (working - resized) / 2;
  return -std::clamp<int64_t>(resized / 2 - working / 2, 0, resized - working);
}

}  // namespace

Size WorkingSize(const Size& original, int64_t short_side, int64_t stride) {
  RequirePositive("WorkingSize", original);
  if (short_side <= 0 || stride <= 0) throw ShapeError("WorkingSize: side {} and stride {}", short_side, stride);
  const int64_t shorter = std::min(original.width, original.height);
  const int64_t longer = short_side * std::max(original.width, original.height) / shorter;
  const int64_t a = std::max(RoundTo(short_side, stride), stride), b = std::max(RoundTo(longer, stride), stride);
  return original.width > original.height ? Size{b, a} : Size{a, b};
}

ImageFit FitImage(const Size& original, const Size& working, FitMode mode) {
  RequirePositive("FitImage", original);
  RequirePositive("FitImage", working);
  const double by_height = static_cast<double>(working.height) / static_cast<double>(original.height);
  const double by_width = static_cast<double>(working.width) / static_cast<double>(original.width);
  const bool crop = mode == FitMode::kCrop;
  const double factor = crop ? std::max(by_height, by_width) : std::min(by_height, by_width);
  // A product may land just above a whole number: then the official code has one row more, and so have we.
  ImageFit fit{original,
               {static_cast<int64_t>(std::ceil(factor * static_cast<double>(original.width))),
                static_cast<int64_t>(std::ceil(factor * static_cast<double>(original.height)))},
               working};
  if (!crop) fit.resized = {std::min(fit.resized.width, working.width), std::min(fit.resized.height, working.height)};
  fit.left = Offset(fit.resized.width, working.width, mode);
  fit.top = Offset(fit.resized.height, working.height, mode);
  return fit;
}

Size GeneratedSize(const Size& target, int64_t short_side) {
  return FitImage(target, WorkingSize(target, short_side), FitMode::kPad).resized;
}

}  // namespace oraclegs::seva

// Drawing of text, lines and discs on a picture, and writing it as PNG. The one place, with canvas.cpp, that
// includes cairo.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "geometry/vector.h"
#include "inspection/colour_map.h"
#include "inspection/shade_part.h"

namespace trueblade {

enum class Align { left, centre, right };

// Lengths in pixels, right and down. Text is UTF-8.
class Canvas {
 public:
  Canvas(int width_px, int height_px);  // white
  ~Canvas();

  void put(const ShadedPixels& pixels, int left, int top);  // precondition: it lies inside the canvas
  void rectangle(double left, double top, double width, double height, Colour fill);
  void frame(double left, double top, double width, double height, Colour colour, double line_width);
  void line(const Vec2& from, const Vec2& to, Colour colour, double line_width);
  // A disc of the given radius seen obliquely: its radius is shortened to `shortened` along `direction`.
  void disc(const Vec2& centre, double radius, double shortened, const Vec2& direction, Colour fill);
  // `baseline` is the lower edge of the letters.
  void text(double x, double baseline, const std::string& words, double size, Align align, Colour colour,
            bool bold = false);
  // Everything drawn from now on is cut off outside the rectangle, until unclip().
  void clip(double left, double top, double width, double height);
  void unclip();

  void write_png(const std::filesystem::path& file) const;  // throws InputError when it cannot be written

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trueblade

#include "inspection/canvas.h"

#include <cairo.h>

#include <cstring>
#include <stdexcept>

#include "geometry/atomic_file.h"

namespace trueblade {

struct Canvas::Impl {
  cairo_surface_t* surface;
  cairo_t* cairo;

  Impl(int width, int height)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), cairo(cairo_create(surface)) {
    if (cairo_status(cairo) != CAIRO_STATUS_SUCCESS) {
      const std::string reason = cairo_status_to_string(cairo_status(cairo));
      release();
      throw std::runtime_error("picture of " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels: " + reason);
    }
  }
  ~Impl() { release(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void release() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  void colour(Colour c) { cairo_set_source_rgb(cairo, c.red / 255.0, c.green / 255.0, c.blue / 255.0); }
};

Canvas::Canvas(int width_px, int height_px) : impl_(std::make_unique<Impl>(width_px, height_px)) {
  cairo_set_source_rgb(impl_->cairo, 1.0, 1.0, 1.0);
  cairo_paint(impl_->cairo);
}
Canvas::~Canvas() = default;

void Canvas::put(const ShadedPixels& pixels, int left, int top) {
  cairo_surface_flush(impl_->surface);
  unsigned char* data = cairo_image_surface_get_data(impl_->surface);
  const int stride = cairo_image_surface_get_stride(impl_->surface);
  for (int y = 0; y < pixels.height_px; ++y) {
    std::memcpy(data + static_cast<std::ptrdiff_t>(top + y) * stride + left * 4,
                pixels.rgb.data() + static_cast<std::size_t>(y) * pixels.width_px, pixels.width_px * 4UL);
  }
  cairo_surface_mark_dirty(impl_->surface);
}

void Canvas::rectangle(double left, double top, double width, double height, Colour fill) {
  impl_->colour(fill);
  cairo_rectangle(impl_->cairo, left, top, width, height);
  cairo_fill(impl_->cairo);
}

void Canvas::frame(double left, double top, double width, double height, Colour colour, double line_width) {
  impl_->colour(colour);
  cairo_set_line_width(impl_->cairo, line_width);
  cairo_rectangle(impl_->cairo, left, top, width, height);
  cairo_stroke(impl_->cairo);
}

void Canvas::line(const Vec2& from, const Vec2& to, Colour colour, double line_width) {
  impl_->colour(colour);
  cairo_set_line_width(impl_->cairo, line_width);
  cairo_move_to(impl_->cairo, from.x(), from.y());
  cairo_line_to(impl_->cairo, to.x(), to.y());
  cairo_stroke(impl_->cairo);
}

void Canvas::disc(const Vec2& centre, double radius, double shortened, const Vec2& direction, Colour fill) {
  constexpr double kFullTurn = 6.283185307179586;
  cairo_t* const c = impl_->cairo;
  impl_->colour(fill);
  cairo_save(c);
  cairo_translate(c, centre.x(), centre.y());
  cairo_rotate(c, std::atan2(direction.y(), direction.x()));
  cairo_scale(c, shortened, radius);
  cairo_arc(c, 0.0, 0.0, 1.0, 0.0, kFullTurn);
  cairo_restore(c);
  cairo_fill(c);
}

void Canvas::text(double x, double baseline, const std::string& words, double size, Align align,
                  Colour colour, bool bold) {
  cairo_t* const c = impl_->cairo;
  impl_->colour(colour);
  cairo_select_font_face(c, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, words.c_str(), &extents);
  const double shift = align == Align::left     ? 0.0
                       : align == Align::centre ? 0.5 * extents.x_advance
                                                : extents.x_advance;
  cairo_move_to(c, x - shift, baseline);
  cairo_show_text(c, words.c_str());
  cairo_new_path(c);
}

void Canvas::clip(double left, double top, double width, double height) {
  cairo_save(impl_->cairo);
  cairo_rectangle(impl_->cairo, left, top, width, height);
  cairo_clip(impl_->cairo);
}

void Canvas::unclip() {
  cairo_restore(impl_->cairo);
}

void Canvas::write_png(const std::filesystem::path& file) const {
  std::string bytes;
  const auto append = [](void* closure, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  const cairo_status_t status = cairo_surface_write_to_png_stream(impl_->surface, append, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) throw std::runtime_error(cairo_status_to_string(status));
  write_file_atomically(file, [&](std::ostream& out) { out << bytes; });
}

}  // namespace trueblade

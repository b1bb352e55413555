// SPDX-License-Identifier: MIT
#include "pointsweep/render/canvas.h"

#include <png.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "pointsweep/cancellation.h"
#include "pointsweep/colors/color_map.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

Vec3 no_longer_than(Vec3 v, double longest) {
  const double l = length(v);
  return l > longest ? (longest / l) * v : v;
}

}  // namespace

Canvas::Canvas(unsigned width, unsigned height, unsigned fineness, Rgb background)
    : width_(width),
      height_(height),
      fineness_(fineness),
      columns_(std::int64_t{width} * fineness),
      rows_(std::int64_t{height} * fineness),
      longest_(static_cast<double>(std::max(columns_, rows_)) / 8),
      samples_(static_cast<std::size_t>(columns_ * rows_), {-std::numeric_limits<float>::infinity(), background}) {}

void Canvas::draw(const ProjectedEllipse& ellipse, Rgb color) {
  const double f = fineness_;
  const Vec3 c = f * ellipse.center, u = no_longer_than(f * ellipse.u, longest_),
             v = no_longer_than(f * ellipse.v, longest_);
  const double half_x = std::sqrt(u.x * u.x + v.x * v.x), half_y = std::sqrt(u.y * u.y + v.y * v.y);
  const double width = static_cast<double>(columns_), height = static_cast<double>(rows_);
  if (!(c.x + half_x >= 0 && c.x - half_x <= width && c.y + half_y >= 0 && c.y - half_y <= height)) return;
  if (c.x >= 0 && c.x < width && c.y >= 0 && c.y < height) {
    put(static_cast<std::int64_t>(c.x), static_cast<std::int64_t>(c.y), c.z, color);
  }
  const double det = u.x * v.y - u.y * v.x;
  if (std::abs(det) < 0.05) return;  // the area is below a sixth of a sample: the ellipse is far away or seen edge-on
  const Vec3 across_s = (1 / det) * Vec3{v.y, v.x, 0}, across_t = (1 / det) * Vec3{u.x, u.y, 0};
  const auto first = [](double low) { return static_cast<std::int64_t>(std::max(0.0, std::ceil(low - 0.5))); };
  const auto last = [](double high, std::int64_t count) {
    return std::min(count - 1, static_cast<std::int64_t>(std::floor(high - 0.5)));
  };
  const std::int64_t x_end = last(c.x + half_x, columns_), y_end = last(c.y + half_y, rows_);
  for (std::int64_t y = first(c.y - half_y); y <= y_end; ++y) {
    for (std::int64_t x = first(c.x - half_x); x <= x_end; ++x) {
      const double dx = static_cast<double>(x) + 0.5 - c.x, dy = static_cast<double>(y) + 0.5 - c.y;
      const double s = dx * across_s.x - dy * across_s.y, t = dy * across_t.x - dx * across_t.y;
      const double r2 = s * s + t * t;
      if (r2 <= 1) put(x, y, c.z + s * u.z + t * v.z - f * ellipse.bulge * r2, color);
    }
  }
}

void Canvas::put(std::int64_t x, std::int64_t y, double depth, Rgb color) {
  Sample& sample = samples_[static_cast<std::size_t>(y * columns_ + x)];
  const auto near = static_cast<float>(depth);
  if (near > sample.depth) sample = {near, color};
}

void Canvas::shade_by_depth() {
  constexpr std::int64_t kSteps[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  const std::int64_t reach = 2 * fineness_;
  for (std::int64_t y = 0; y < rows_; ++y) {
    stop_if_cancelled();
    for (std::int64_t x = 0; x < columns_; ++x) {
      const double depth = samples_[static_cast<std::size_t>(y * columns_ + x)].depth;
      if (!std::isfinite(depth)) continue;
      double behind = 0;
      for (const auto& [dx, dy] : kSteps) {
        const std::int64_t other_x = x + reach * dx, other_y = y + reach * dy;
        if (other_x < 0 || other_x >= columns_ || other_y < 0 || other_y >= rows_) continue;
        const double other = samples_[static_cast<std::size_t>(other_y * columns_ + other_x)].depth;
        if (std::isfinite(other)) behind += std::clamp((other - depth) / static_cast<double>(reach), 0.0, 2.0);
      }
      Rgb& color = samples_[static_cast<std::size_t>(y * columns_ + x)].color;
      color = shaded(color, 1 / (1 + 0.15 * behind));
    }
  }
}

Picture Canvas::picture() const {
  Picture picture{width_, height_, std::vector<Rgb>(std::size_t{width_} * height_)};
  const unsigned n = fineness_ * fineness_;
  for (std::size_t y = 0; y < height_; ++y) {
    stop_if_cancelled();
    for (std::size_t x = 0; x < width_; ++x) {
      unsigned red = n / 2, green = n / 2, blue = n / 2;
      for (unsigned i = 0; i < n; ++i) {
        const std::size_t row = y * fineness_ + i / fineness_, column = x * fineness_ + i % fineness_;
        const Rgb color = samples_[row * static_cast<std::size_t>(columns_) + column].color;
        red += color.red, green += color.green, blue += color.blue;
      }
      const auto byte = [n](unsigned sum) { return static_cast<std::uint8_t>(sum / n); };
      picture.pixels[y * width_ + x] = {byte(red), byte(green), byte(blue)};
    }
  }
  return picture;
}

std::vector<std::byte> to_png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = PNG_FORMAT_RGB;
  static_assert(sizeof(Rgb) == 3);
  const auto write = [&](void* bytes, png_alloc_size_t& size) {
    if (png_image_write_to_memory(&image, bytes, &size, 0, picture.pixels.data(), 0, nullptr) != 0) return;
    const std::string reason = image.message;
    png_image_free(&image);
    fail("a picture of {}x{} pixels could not be made: {}.", picture.width, picture.height, reason);
  };
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> bytes(size);
  write(bytes.data(), size);
  bytes.resize(size);
  return bytes;
}

Rgb parse_color(std::string_view text) {
  if (text == "white") return {255, 255, 255};
  if (text == "black") return {0, 0, 0};
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 6 || error != std::errc() || end != text.data() + text.size())
    fail_usage("--background: '{}' is not white, black or RRGGBB in hexadecimal, e.g. 20242c.", text);
  const auto byte = [value](int shift) { return static_cast<std::uint8_t>(value >> shift & 255); };
  return {byte(16), byte(8), byte(0)};
}

}  // namespace pointsweep

// SPDX-License-Identifier: MIT
#include "pointsweep/render/png.h"

#include <png.h>

#include <string>

#include "pointsweep/fail.h"

namespace pointsweep {

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

}  // namespace pointsweep

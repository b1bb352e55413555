// SPDX-License-Identifier: MIT
/// A page that is one file: plots inside, pictures inside, nothing to load.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pointsweep {

/// RFC 4648, with padding.
std::string to_base64(std::span<const std::byte> bytes);

class Page {
 public:
  explicit Page(std::string title) : title_(std::move(title)) {}

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// Two columns, escaped.
  void table(const std::vector<std::pair<std::string, std::string>>& rows);
  /// An SVG as plot.h makes it.
  void plot(const std::string& svg);
  /// Adds a plot with a caption below it. Figures stand side by side where there is room.
  void figure(const std::string& svg, const std::string& caption);
  void picture(std::span<const std::byte> png, const std::string& caption);

  std::string html() const;

 private:
  std::string title_, body_;
};

}  // namespace pointsweep

// SPDX-License-Identifier: MIT
/// An HTML page in one file, which contains its plots and pictures and loads nothing else.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pointsweep {

/// Returns the bytes in Base64 (RFC 4648), with padding.
std::string to_base64(std::span<const std::byte> bytes);

class Page {
 public:
  explicit Page(std::string title) : title_(std::move(title)) {}

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// Adds a table with two columns of text.
  void table(const std::vector<std::pair<std::string, std::string>>& rows);
  /// Adds a plot, an SVG made by a function of plot.h.
  void plot(const std::string& svg);
  /// Adds a plot with a caption below it. Successive figures stand side by side if the page is wide enough.
  void figure(const std::string& svg, const std::string& caption);
  void picture(std::span<const std::byte> png, const std::string& caption);

  std::string html() const;

 private:
  std::string title_, body_;
};

}  // namespace pointsweep

// SPDX-License-Identifier: MIT
#include "pointsweep/report/page.h"

#include <fmt/format.h>

#include "pointsweep/report/plot.h"

namespace pointsweep {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:760px;margin:2em auto;padding:0 "
    "1em;color:#1b1e23;background:#fff}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:1.8em}table{border-collapse:collapse}"
    "td{padding:.15em 1.2em .15em 0;border-bottom:1px solid "
    "#e4e6ea;vertical-align:top}td+td{font-variant-numeric:tabular-nums;overflow-wrap:anywhere}"
    "svg{width:100%;height:auto;font:12px system-ui,sans-serif;fill:#454b54;margin:.6em 0}svg "
    ".title{font-weight:600;fill:#1b1e23}"
    "svg .grid{stroke:#e4e6ea}svg .line{fill:none;stroke-width:1.6;stroke-linejoin:round}svg "
    ".area{fill-opacity:.25;stroke-width:1.4}"
    "img{max-width:100%;height:auto}figure{margin:1em 0}figcaption{color:#5b626c;font-size:.9em}"
    "td:first-child{min-width:9em}.plot{overflow-x:auto}.plot svg{min-width:560px}"
    "figure.small{display:inline-block;vertical-align:top;width:48%;min-width:300px;margin:.4em .8% .4em 0}"
    "@media(max-width:660px){figure.small{width:100%;min-width:0}body{margin:1em auto}td{padding-right:.6em}}";

}  // namespace

std::string to_base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned>(bytes[i + j]) : 0);
    }
    for (std::size_t digit = 0; digit < 4; ++digit) {
      const bool padding = digit > bytes.size() - i;
      text += padding ? '=' : kDigits[group >> (18 - 6 * digit) & 63];
    }
  }
  return text;
}

void Page::heading(const std::string& text) { body_ += fmt::format("<h2>{}</h2>\n", escaped(text)); }

void Page::paragraph(const std::string& text) { body_ += fmt::format("<p>{}</p>\n", escaped(text)); }

void Page::table(const std::vector<std::pair<std::string, std::string>>& rows) {
  body_ += "<table>\n";
  for (const auto& [name, value] : rows) {
    body_ += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escaped(name), escaped(value));
  }
  body_ += "</table>\n";
}

void Page::plot(const std::string& svg) {
  if (!svg.empty()) body_ += fmt::format("<div class=\"plot\">{}</div>\n", svg);
}

void Page::figure(const std::string& svg, const std::string& caption) {
  body_ += fmt::format("<figure class=\"small\">{}<figcaption>{}</figcaption></figure>\n", svg, escaped(caption));
}

void Page::picture(std::span<const std::byte> png, const std::string& caption) {
  body_ +=
      fmt::format("<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
                  escaped(caption), to_base64(png));
}

std::string Page::html() const {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n</html>\n",
      escaped(title_), kStyle, body_);
}

}  // namespace pointsweep

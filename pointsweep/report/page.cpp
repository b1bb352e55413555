// SPDX-License-Identifier: MIT
#include "pointsweep/report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pointsweep {
namespace {

double nice_step(double span, int wanted) {
  const double rough = span / wanted, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough) return step * power;
  }
  return 10 * power;
}

constexpr double kWidth = 720, kHeight = 300, kLeft = 64, kRight = 16, kPlotTop = 34, kBottom = 46;
constexpr const char* kColors[] = {"#4269d0", "#efb118", "#ff725c", "#6cc5b0", "#3ca951", "#ff8ab7", "#a463f2"};
constexpr double kBarHeight = 22;

const char* color_of(std::size_t i) { return kColors[i % std::size(kColors)]; }

/// Returns the beginning of an SVG of this size, with the title from `left` on.
std::string opened(double width, double height, double left, const std::string& title) {
  return fmt::format(
      "<svg viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" aria-label=\"{2}\">\n<text x=\"{3:g}\" y=\"18\" "
      "class=\"title\">{2}</text>\n",
      width, height, escaped(title), left);
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escaped(text));
}

/// Returns the grid, numbers and labels of both axes as SVG.
std::string frame_of(const PlotText& text, const Scale& x, const Scale& y) {
  std::string svg;
  const double bottom = kHeight - kBottom;
  for (const Tick& tick : y.ticks(5)) {
    const double at = y.place(tick.value);
    svg += fmt::format("<path class=\"grid\" d=\"M{:g} {:.1f}H{:g}\"/>\n", kLeft, at, kWidth - kRight);
    svg += text_at(kLeft - 6, at + 4, "end", tick.text);
  }
  for (const Tick& tick : x.ticks(8)) {
    const double at = x.place(tick.value);
    svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:g}v5\"/>\n", at, bottom);
    svg += text_at(at, bottom + 18, "middle", tick.text);
  }
  svg += text_at(0.5 * (kLeft + kWidth - kRight), kHeight - 8, "middle", text.x);
  return svg + text_at(kWidth - kRight, 18, "end", text.y);
}

/// Returns the area below the outline of a histogram. Bin i is edges[i] .. edges[i+1].
std::string area_of(const std::vector<double>& edges, const std::vector<double>& counts, const Scale& x, const Scale& y,
                    const char* color) {
  std::string path = fmt::format("M{:.1f} {:.1f}", x.place(edges.front()), y.place(0));
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    path += fmt::format("V{:.1f}H{:.1f}", y.place(counts[i]), x.place(edges[i + 1]));
  return fmt::format("<path class=\"area\" stroke=\"{0}\" fill=\"{0}\" d=\"{1}V{2:.1f}Z\"/>\n", color, path,
                     y.place(0));
}

std::string legend(const std::vector<std::string>& names) {
  if (names.size() < 2) return {};
  std::string svg;
  double x = kLeft + 8;
  for (std::size_t i = 0; i < names.size(); ++i) {
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:g}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n", x, kPlotTop,
                       color_of(i));
    svg += text_at(x + 14, kPlotTop + 9, "start", names[i]);
    x += 34 + 6.5 * static_cast<double>(names[i].size());
  }
  return svg;
}

}  // namespace

std::string short_number(double value) {
  const double size = std::abs(value);
  if (size >= 1e12 || (size > 0 && size < 1e-3)) return fmt::format("{:.3g}", value);
  for (const auto& [unit, letter] : {std::pair(1e9, 'G'), std::pair(1e6, 'M'), std::pair(1e3, 'k')}) {
    if (size >= unit) return fmt::format("{:.4g}{}", value / unit, letter);
  }
  return fmt::format("{:.4g}", value);
}

Scale::Scale(double lo, double hi, double begin, double end, bool logarithmic)
    : lo_(logarithmic ? std::log10(lo) : lo),
      hi_(logarithmic ? std::log10(hi) : hi),
      begin_(begin),
      end_(end),
      logarithmic_(logarithmic) {
  if (!(hi_ > lo_)) hi_ = lo_ + 1;
}

double Scale::place(double value) const {
  const double v = logarithmic_ ? std::log10(value) : value;
  return begin_ + (v - lo_) / (hi_ - lo_) * (end_ - begin_);
}

std::vector<Tick> Scale::ticks(int wanted) const {
  std::vector<Tick> ticks;
  const double slack = 1e-9 * (hi_ - lo_);
  if (!logarithmic_) {
    const double step = nice_step(hi_ - lo_, wanted);
    for (double i = std::ceil((lo_ - slack) / step) + 0.0; i * step <= hi_ + slack; ++i) {
      ticks.push_back({i * step, short_number(i * step)});
    }
    return ticks;
  }
  const bool few = hi_ - lo_ < 2.5;
  const double skip = std::max(1.0, std::ceil((hi_ - lo_) / wanted));
  for (double power = std::floor(lo_); power <= hi_ + slack; power += few ? 1 : skip) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, power), place = std::log10(value);
      if ((few || factor == 1) && place >= lo_ - slack && place <= hi_ + slack)
        ticks.push_back({value, short_number(value)});
    }
  }
  return ticks;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

std::string line_plot(const PlotText& text, const std::vector<Series>& series) {
  double most_x = 0, most_y = 0;
  std::vector<std::string> names;
  for (const Series& s : series) {
    names.push_back(s.name);
    for (const auto& [x, y] : s.points) {
      if (std::isfinite(x)) most_x = std::max(most_x, x);
      if (std::isfinite(y)) most_y = std::max(most_y, y);
    }
  }
  const Scale x(0, most_x, kLeft, kWidth - kRight), y(0, 1.1 * most_y, kHeight - kBottom, kPlotTop);
  std::string svg = opened(kWidth, kHeight, kLeft, text.title) + frame_of(text, x, y);
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::string path;
    for (const auto& [px, py] : series[i].points) {
      if (!std::isfinite(px) || !std::isfinite(py)) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x.place(px), y.place(py));
    }
    svg += fmt::format("<path class=\"line\" stroke=\"{}\" d=\"{}\"/>\n", color_of(i), path);
  }
  return svg + legend(names) + "</svg>\n";
}

std::string bar_plot(const std::string& title, const std::vector<Bar>& bars) {
  constexpr double kNames = 190;
  double most = 0;
  for (const Bar& bar : bars) most = std::max(most, bar.value);
  const Scale x(0, most, kNames, kWidth - 150);
  std::string svg = opened(kWidth, kPlotTop + kBarHeight * static_cast<double>(bars.size()) + 8, kLeft, title);
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = kPlotTop + kBarHeight * static_cast<double>(i), end = x.place(bars[i].value);
    svg += text_at(kNames - 8, y + 14, "end", bars[i].name);
    svg += fmt::format("<rect x=\"{:g}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:g}\" fill=\"{}\"/>\n", kNames, y + 3,
                       std::max(0.5, end - kNames), kBarHeight - 6, color_of(0));
    svg += text_at(end + 6, y + 14, "start", bars[i].label);
  }
  return svg + "</svg>\n";
}

std::string value_plot(const std::string& title, const std::vector<double>& edges, const std::vector<double>& counts) {
  if (counts.empty()) return "";
  constexpr double kSmallWidth = 360, kSmallHeight = 150, kSide = 14, kFoot = 24;
  const Scale x(edges.front(), edges.back(), kSide, kSmallWidth - kSide);
  const Scale y(0, *std::ranges::max_element(counts), kSmallHeight - kFoot, kPlotTop);
  std::string svg = opened(kSmallWidth, kSmallHeight, kSide, title) + area_of(edges, counts, x, y, color_of(0));
  for (const Tick& tick : x.ticks(5)) svg += text_at(x.place(tick.value), kSmallHeight - 6, "middle", tick.text);
  return svg + "</svg>\n";
}

std::string histogram_plot(const PlotText& text, const std::vector<double>& edges,
                           const std::vector<Histogram>& histograms) {
  if (edges.size() < 2) return {};
  double most = 0;
  std::vector<std::string> names;
  for (const Histogram& h : histograms) {
    names.push_back(h.name);
    for (const double count : h.counts) most = std::max(most, count);
  }
  const Scale x(edges.front(), edges.back(), kLeft, kWidth - kRight, true),
      y(0, 1.1 * most, kHeight - kBottom, kPlotTop);
  std::string svg = opened(kWidth, kHeight, kLeft, text.title) + frame_of(text, x, y);
  for (std::size_t h = 0; h < histograms.size(); ++h) svg += area_of(edges, histograms[h].counts, x, y, color_of(h));
  return svg + legend(names) + "</svg>\n";
}

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

// SPDX-License-Identifier: MIT
/// `pointsweep render IN... OUT.png`: a picture of a cloud of any size.
#include <charconv>
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/progress.h"
#include "pointsweep/program/formats.h"
#include "pointsweep/program/render.h"
#include "pointsweep/program/whole_file.h"

namespace pointsweep {
namespace {

struct RenderCommand {
  CommonOptions common;
  InputsAndOutput paths;
  RenderOptions options;
  std::string view = "auto", up = "auto";
};

template <class T>
bool parse_whole(std::string_view text, int base, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return error == std::errc() && end == text.data() + text.size();
}

void parse_picture_size(const std::string& text, RenderOptions& options) {
  const std::size_t cross = text.find('x');
  if (cross == text.npos || !parse_whole(std::string_view(text).substr(0, cross), 10, options.width) ||
      !parse_whole(std::string_view(text).substr(cross + 1), 10, options.height)) {
    refuse("--size: '{}' is not WIDTHxHEIGHT in pixels, e.g. 1200x900.", text);
  }
}

/// Returns a sentence like "wrote a.png: 5 points from azimuth 30, elevation 25 with z up, coloured by height, violet 0
/// to yellow 3".
std::string conclusion(const std::filesystem::path& output, const Rendering& r) {
  const std::string points =
      r.drawn < r.points ? fmt::format("{} of {}", r.drawn, r.points) : fmt::format("{}", r.points);
  std::string sentence = fmt::format(
      "wrote {}: {} points from azimuth {:g}, elevation {:g} with {}{} up, coloured by {}", output.string(), points,
      r.view.angles.azimuth, r.view.angles.elevation, r.view.up.sign < 0 ? "-" : "", "xyz"[r.view.up.axis], r.color);
  if (r.is_number) sentence += fmt::format(", violet {:.4g} to yellow {:.4g}", r.lo, r.hi);
  return sentence;
}

void render_picture(RenderCommand& command) {
  const ResolvedFiles files = resolve(command.paths, command.common.format);
  const auto& output = files.output;
  require_one_output(files, "a picture shows all inputs");
  if (extension_of(output) != ".png") refuse("{}: pictures are PNG; give a name that ends with .png.", output.string());
  RenderOptions options = command.options;
  options.angles = parse_view(command.view);
  options.up = parse_up(command.up);
  WholeFile file(output, command.common.overwrite);
  take_standard_input(files.inputs, command.common);
  Cloud cloud(files.inputs, cloud_options(command.common));
  if (const auto& crs = cloud.input(0).crs) options.length_unit = length_unit_of(*crs);
  ProgressDisplay display(command.common);
  options.progress = reporting_to(display);
  const Rendering rendering = render(cloud, options);
  for (const std::string& notice : files.notices) display.say(Severity::note, notice);
  for (const std::string& warning : cloud.warnings()) display.say(Severity::warning, warning);
  file.complete(to_png(rendering.picture));
  if (!rendering.remark.empty()) display.say(Severity::note, rendering.remark);
  if (rendering.outside > 0)
    display.say(Severity::warning,
                fmt::format("{} far from all others {} outside of the picture.",
                            rendering.outside == 1 ? "one point" : fmt::format("{} points", rendering.outside),
                            rendering.outside == 1 ? "is" : "are"));
  display.say(Severity::note, conclusion(output, rendering));
}

}  // namespace

void declare_render_verb(CLI::App& verb) {
  auto command = std::make_shared<RenderCommand>();
  add_inputs_and_output(verb, command->paths, "picture (.png)");
  verb.add_option("--color", command->options.color,
                  "Colour points by rgb, normal, height, curvature, classification, an attribute, or not at all "
                  "(plain) (default: rgb if it varies, else plain with normals, else height)")
      ->type_name("WHAT");
  verb.add_option(
          "--view", command->view,
          "Direction to look from: front, top, iso or AZIMUTH,ELEVATION in degrees (default: top for flat clouds, "
          "else 30,25)")
      ->type_name("VIEW");
  verb.add_option("--up", command->up,
                  "Axis that points up: x, y, z, -x, -y or -z (default: z for LAS, else found from the shape)")
      ->type_name("AXIS");
  verb.add_option_function<std::string>(
          "--size", [command](const std::string& text) { parse_picture_size(text, command->options); },
          "Width and height of the picture in pixels (default: 1200x900)")
      ->type_name("WxH");
  verb.add_option("--point-size", command->options.point_size,
                  "Diameter of every point in pixels (default: splats or radii of the file, else as the points around "
                  "lie apart)")
      ->type_name("PIXELS")
      ->check(CLI::Range(0.1, 1000.0).description(""));
  verb.add_option_function<std::string>(
          "--background", [command](const std::string& text) { command->options.background = parse_color(text); },
          "Background colour: white, black or RRGGBB in hexadecimal (default: white)")
      ->type_name("COLOR");
  verb.add_flag_callback(
      "--no-legend", [command] { command->options.legend = false; }, "Hide the legend");
  add_crs_option(verb, command->common);
  add_format_option(verb, command->common.format);
  add_run_option(verb, command->common, "overwrite");
  add_progress_options(verb, command->common);
  verb.footer(
      "Points are drawn as their splats where the file has them (nx.., splat_x.., splat_length, splat_ratio), else as "
      "discs "
      "with the file's radius or one as large as points lie apart (1.5 times as large with normals). "
      "Numbers are coloured from their 5 % to their 95 % quantile. "
      "The cloud is read twice and never held in memory; of COPC files no finer levels than pixels show (--depth 31 "
      "draws all points).\n"
      "\nExample:\n"
      "  pointsweep render splats.ply picture.png --color curvature --view 30,20");
  verb.callback([command] { render_picture(*command); });
}

}  // namespace pointsweep

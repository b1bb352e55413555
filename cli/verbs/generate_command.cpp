// SPDX-License-Identifier: MIT
/// `pointsweep generate SHAPE OUT`: a cloud of known geometry and any size.
#include <chrono>

#include "cli/console/console.h"
#include "cli/verbs/cloud_run.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/common_options.h"
#include "cli/verbs/progress.h"
#include "pointsweep/program/generate.h"
#include "pointsweep/writer.h"

namespace pointsweep {
namespace {

struct GenerateOptions {
  CommonOptions common;
  std::string shape;
  std::filesystem::path positional, output;  ///< the output as an argument and as the value of --output; one is empty
  Sampling sampling;
};

void generate(const GenerateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<Reader> reader = generated_points(options.shape, options.sampling);
  OutputPlan plan;
  plan.path = options.output;
  plan.schema = reader->info().schema;
  plan.count = reader->info().count;
  plan.overwrite = options.common.overwrite;
  plan.bounds = reader->info().bounds;
  if (options.common.crs) plan.crs = options.common.crs->crs;
  const std::unique_ptr<Writer> writer = create_writer(plan);
  ProgressDisplay progress(options.common);
  const auto show = [&](std::uint64_t done) { progress.report("generate", done, plan.count); };
  show(0);
  write_generated(*reader, *writer, options.common.resources.threads, show);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.say(Severity::note, fmt::format("wrote {}: {} points of a {} in {:.1f} s", options.output.string(),
                                           plan.count, options.shape, seconds));
}

/// Returns the footer of the help. Called only when help is printed, because setting up the shapes takes time.
std::string footer() {
  std::string text = "Shapes, in metres:\n";
  for (const NamedShape& shape : shapes()) text += fmt::format("  {:<10}{}\n", shape.name, shape.meaning);
  return text +
         "\nPoints come in random order, with the normals of the shape where it has them. Row i depends on shape, seed "
         "and options only, so the same command gives the same bytes on every machine.\n"
         "\nExample: two million points of a statue, half a millimetre of noise, one point in a thousand astray:\n"
         "  pointsweep generate statue statue.ply -n 2M --noise 0.0005 --outliers 0.001";
}

void add_sampling_options(CLI::App& verb, Sampling& sampling) {
  verb.add_option_function<std::string>(
          "-n,--points", [&sampling](const std::string& text) { sampling.count = parse_count("-n", text); },
          "Number of points; the suffixes K, M, G and T are powers of 1000")
      ->type_name("N")
      ->required();
  verb.add_option_function<std::string>(
          "--seed", [&sampling](const std::string& text) { sampling.seed = parse_count("--seed", text); },
          "Seed of the random sample (default: 1)")
      ->type_name("S");
  verb.add_option("--noise", sampling.noise,
                  "Standard deviation of Gaussian noise on each coordinate, in metres (default: 0)")
      ->type_name("SIGMA");
  verb.add_option("--outliers", sampling.outliers,
                  "Share of points, 0 to 1, that lie at random in a larger box, with normal 0 (default: 0)")
      ->type_name("FRACTION");
  verb.add_option("--outlier-box", sampling.outlier_box,
                  "Size of the box of outliers as a multiple of the size of the shape (default: 20)")
      ->type_name("FACTOR");
  verb.add_option_function<std::string>(
          "--origin",
          [&sampling](const std::string& text) {
            sampling.origin = parse_vector("--origin", text);
            sampling.float64 = true;
          },
          "Move the cloud, e.g. to map coordinates; implies --double")
      ->type_name("X,Y,Z");
  verb.add_flag("--double", sampling.float64, "Write coordinates as float64 instead of float32");
}

}  // namespace

void declare_generate_verb(CLI::App& verb) {
  auto options = std::make_shared<GenerateOptions>();
  verb.add_option("SHAPE", options->shape, "Name of a shape (see below)")->required()->type_name("");
  verb.add_option("OUT", options->positional, "File to write, in the format of its extension")->type_name("");
  add_output_option(verb, options->output);
  add_sampling_options(verb, options->sampling);
  add_stated_crs_option(verb, options->common);
  add_named_options(verb, options->common, {"threads", "overwrite"});
  add_progress_options(verb, options->common);
  verb.footer("");  // removes the footer of the tool, which the parser would add
  verb.footer(footer);
  verb.callback([options] {
    if (options->positional.empty() == options->output.empty())
      refuse("OUT: name one file to write, last or with --output.");
    if (options->output.empty()) options->output = options->positional;
    generate(*options);
  });
}

}  // namespace pointsweep

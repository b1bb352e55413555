// SPDX-License-Identifier: MIT
/// The options and the start of a run that the Python package performs on the workers of Dask: over a folder of tiles,
/// or with an output that is divided among files.

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/console/console.h"
#include "cli/text/help.h"
#include "cli/verbs/cloud_run.h"
#include "pointsweep/crs.h"
#include "pointsweep/error.h"

namespace pointsweep {
namespace {

/// Returns a value of --crs that parse_crs() understands on any machine: WKT, a code or "none"; empty if the user
/// states no system.
std::string stated_text(const CommonOptions& options) {
  if (!options.crs) return "";
  const std::optional<Crs>& crs = options.crs->crs;
  if (!crs) return "none";
  if (!crs->wkt.empty()) return crs->wkt;
  return "EPSG:" + std::to_string(crs->epsg) +
         (crs->vertical_epsg == 0 ? "" : "+" + std::to_string(crs->vertical_epsg));
}

/// The Python program that performs the run. It reads the request from a descriptor, since the request may be too long
/// for an argument.
constexpr const char* kStart = R"(
import json, sys
try:
    from pointsweep.cluster import main
except ImportError as missing:
    print(f"error: --dask: {sys.executable} lacks a package ({missing}); install it: pip install pointsweep distributed,"
          " or name another Python with POINTSWEEP_PYTHON.", file=sys.stderr)
    sys.exit(1)
with open(int(sys.argv[1])) as request:
    sys.exit(main(json.load(request)))
)";

/// Returns the descriptor of a file in memory that holds the text. The descriptor stays open in a program that replaces
/// this one by exec().
int descriptor_of(const std::string& text) {
  const int descriptor = ::memfd_create("request", 0);
  if (const int error = write_all(descriptor, text); error != 0)
    throw Error(std::string("--dask: the request cannot be passed on: ") + std::strerror(error));
  ::lseek(descriptor, 0, SEEK_SET);
  return descriptor;
}

nlohmann::json request_of(const std::vector<std::string>& stages, const PipelineRun& run, const ResolvedFiles& files) {
  const CommonOptions& common = run.common;
  nlohmann::json request = {
      {"client", common.cluster.dask},
      {"scratch", common.cluster.scratch.string()},
      {"take_over", common.cluster.take_over},
      {"output", files.tiles.empty() ? (files.output.parent_path() / "").string() : files.output.string()},
      {"stages", stages},
      {"keep", common.keep},
      {"format", common.format},
      {"crs", stated_text(common)},
      {"replace_crs", common.replace_crs},
      {"ignore_crs", common.ignore_crs},
      {"quiet", common.quiet},
      {"stats", common.stats.string()},
      {"options", nlohmann::json::object()}};
  for (const auto& path : files.inputs) request["inputs"].push_back(path.string());
  for (const auto& path : files.tiles) request["outputs"].push_back(path.string());
  if (files.tiles.empty()) request["outputs"] = {files.output.string()};
  for (const auto& [name, text] : texts_of(common)) request["options"][name] = text;
  return request;
}

}  // namespace

void add_cluster_options(CLI::App& verb, ClusterOptions& options) {
  verb.add_option("--dask", options.dask,
                  "Divide the work on a folder of tiles among the workers of the Dask scheduler at this address, e.g. "
                  "tcp://host:8786, or among workers on this machine ('local'); needs the Python package")
      ->type_name("ADDRESS")
      ->group(kMachineGroup);
  verb.add_option(
          "--scratch", options.scratch,
          "Folder, or URL in a bucket, that all workers see, through which they pass on points; after a crash the same "
          "command goes on from there")
      ->type_name("DIR")
      ->group(kMachineGroup);
  verb.add_flag("--take-over", options.take_over,
                "Go on in a scratch whose process is gone, without waiting for two minutes")
      ->group(kMachineGroup);
}

void run_on_cluster(const std::vector<std::string>& stages, const PipelineRun& run) {
  const CommonOptions& common = run.common;
  if (common.cluster.scratch.empty())
    throw UsageError("--dask: needs a folder that all workers see; name it with --scratch DIR.");
  if (common.dry_run) throw UsageError("--dry-run: describes a run of one process; leave out --dask.");
  if (!common.report.empty())
    throw UsageError("--report: describes a run of one process; --stats FILE says what workers did.");
  InputsAndOutput named = run.paths;
  named.divides = common.division.divides();
  const ResolvedFiles files = resolve(named, common.format);
  if (files.tiles.empty() && !named.divides)
    throw UsageError("--dask: many processes write a file for each input; name a folder as the output, e.g. out/.");
  const std::string request = std::to_string(descriptor_of(request_of(stages, run, files).dump()));
  const char* const given = std::getenv("POINTSWEEP_PYTHON");
  const std::string python = given != nullptr ? given : "python3";
  ::execlp(python.c_str(), python.c_str(), "-c", kStart, request.c_str(), nullptr);
  throw Error("--dask: " + python + " cannot be started: " + std::strerror(errno) +
              "; install Python and the package: pip install pointsweep distributed.");
}

}  // namespace pointsweep

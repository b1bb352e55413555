// SPDX-License-Identifier: MIT
/// Computes normals from file to file with one of the instruction sets for which the library is built, as if the
/// machine had no better set.
///   with_instruction_set                                     prints the sets of this machine, the best first
///   with_instruction_set SET IN OUT [K=8] [THREADS=all]      prints the set that was used
#include "pointsweep/math/instruction_sets.h"
// The header above must precede all headers of Highway, because it chooses the instruction sets.
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/engine_run.h"

namespace {

std::vector<std::int64_t> instruction_sets() {
  std::vector<std::int64_t> sets;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    sets.push_back(rest & -rest);
  return sets;
}

bool take(const std::string& name) {
  for (const std::int64_t set : instruction_sets()) {
    if (hwy::TargetName(set) != name) continue;
    hwy::SetSupportedTargetsForTest(set);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return true;
  }
  return false;
}

void normals(const char* in, const char* out, std::size_t k, unsigned threads) {
  using namespace pointsweep;
  InputCloud cloud({in});
  const Chain chain{.neighborhood = {.k = k}, .stages = {std::make_shared<Normals>()}};
  EngineOptions options;
  options.resources.threads = threads;
  options.overwrite = true;
  run(cloud, chain, {.points = out, .arrays = {}, .writer = {}}, options);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 1) {
    for (const std::int64_t set : instruction_sets()) std::printf("%s\n", hwy::TargetName(set));
    return 0;
  }
  if (argc < 4) return std::fprintf(stderr, "usage: %s [SET IN OUT [K [THREADS]]]\n", argv[0]), 2;
  if (!take(argv[1])) return std::fprintf(stderr, "%s: not on this machine, or not built\n", argv[1]), 2;
  normals(argv[2], argv[3], argc > 4 ? std::stoul(argv[4]) : 8, argc > 5 ? unsigned(std::stoul(argv[5])) : 0);
  const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
  std::printf("%s\n", hwy::TargetName(supported & -supported));
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}

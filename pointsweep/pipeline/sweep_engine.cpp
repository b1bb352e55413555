// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/sweep_engine.h"

#include <atomic>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

/// The registered engine. Engine has one value besides `exact`, so one pointer is enough.
std::atomic<const SweepEngine*> registered = nullptr;

}  // namespace

void register_engine(Engine engine, const SweepEngine& made) {
  if (engine == Engine::reference) registered = &made;
}

const SweepEngine* engine_of(Engine engine) {
  if (engine == Engine::exact) return nullptr;
  if (registered == nullptr)
    fail_usage("This program has no reference engine; run Engine::exact, or the tool with --engine reference.");
  return registered;
}

}  // namespace pointsweep

// SPDX-License-Identifier: MIT
#include "pointsweep/leftovers.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "pointsweep/program/process.h"

namespace pointsweep {
namespace {

enum class State : unsigned char { free, changing, listed };

/// An entry of the list. It has a fixed address, so a signal handler can read the name even if other threads change the
/// list.
struct Place {
  std::atomic<State> state = State::free;
  std::array<char, 4096> name{};
};
static_assert(std::atomic<State>::is_always_lock_free);

std::array<Place, 64> places;

}  // namespace

Leftover::Leftover(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (name.size() >= places[0].name.size()) return;
  for (std::size_t i = 0; i < places.size() && place_ == kNone; ++i) {
    State expected = State::free;
    if (!places[i].state.compare_exchange_strong(expected, State::changing)) continue;
    std::memcpy(places[i].name.data(), name.c_str(), name.size() + 1);
    places[i].state = State::listed;
    place_ = i;
  }
}

void Leftover::forget() noexcept {
  if (place_ != kNone) places[place_].state = State::free;
  place_ = kNone;
}

/// Removes files first, so that folders are empty.
void remove_leftovers() noexcept {
  const int before = errno;
  for (const auto remove : {::unlink, ::rmdir})
    for (const Place& place : places)
      if (place.state == State::listed) remove(place.name.data());
  errno = before;
}

}  // namespace pointsweep

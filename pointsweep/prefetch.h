// SPDX-License-Identifier: MIT
/// Objects that are made in the background, a few before they are used.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "pointsweep/threads.h"

namespace pointsweep {

/// A queue of the objects make(i) for i in [first, end), in order, of which up to `depth` are made ahead in the
/// background.
template <class Thing>
class Prefetch {
 public:
  Prefetch(std::function<Thing(std::size_t)> make, std::size_t first, std::size_t end, std::size_t depth)
      : make_(std::move(make)), next_(first), end_(end), depth_(depth) {
    fill();
  }

  /// Returns the next object, and starts to make another. Throws the exception with which make() ended for the object.
  Thing next() {
    pending_.front()->task->wait();
    Thing thing = std::move(*pending_.front()->thing);
    pending_.pop_front();
    fill();
    return thing;
  }

 private:
  struct Pending {
    std::optional<Thing> thing;
    std::optional<BackgroundTask> task;  // last, so that it ends before the members that it uses
  };

  void fill() {
    while (next_ < end_ && pending_.size() < depth_) {
      pending_.push_back(std::make_unique<Pending>());
      pending_.back()->task.emplace([this, &p = *pending_.back(), i = next_++] { p.thing.emplace(make_(i)); });
    }
  }

  std::function<Thing(std::size_t)> make_;
  std::size_t next_, end_, depth_;
  std::deque<std::unique_ptr<Pending>> pending_;
};

}  // namespace pointsweep

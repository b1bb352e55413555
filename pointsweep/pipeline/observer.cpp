// SPDX-License-Identifier: MIT
#include "pointsweep/run.h"

namespace pointsweep {

Observer::~Observer() = default;
void Observer::on_progress(const Progress&) {}
void Observer::on_warning(const std::string&) {}
void Observer::on_note(const std::string& sentence) { on_warning(sentence); }
const CancellationToken& Observer::token() const noexcept { return own_; }

}  // namespace pointsweep

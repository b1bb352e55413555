// SPDX-License-Identifier: MIT
/// Ctrl-C and similar signals: the first signal asks the run to stop cleanly, a second one of the same number has the
/// system's default effect and ends the process.
#pragma once

#include "pointsweep/cancellation.h"

namespace pointsweep {

/// After this call, the first SIGINT, SIGTERM or SIGHUP (unless ignored, as under nohup) cancels interrupt_token(). If
/// the process still runs 0.7 s later, because it waits for a disk or an operator of the user does not return,
/// unfinished files are removed and the process ends with status 128 + signal.
void catch_interrupts();
/// Returns the number of the last signal that came; 0 if none has come.
int interrupting_signal();
inline bool interrupted() { return interrupting_signal() != 0; }
/// Returns the token that the first signal cancels.
const CancellationToken& interrupt_token();

}  // namespace pointsweep

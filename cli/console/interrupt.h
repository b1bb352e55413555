// SPDX-License-Identifier: MIT
/// Ctrl-C and similar signals: the first asks the run to stop cleanly, the second ends it as the system does.
#pragma once

#include "pointsweep/cancellation.h"

namespace pointsweep {

/// After this call, the first SIGINT, SIGTERM or SIGHUP (unless ignored, as under nohup) cancels interrupt_token(). If
/// the process still runs 0.7 s later, because it waits for a disk or an operator of the user does not return,
/// unfinished files are removed and the process ends with status 128 + signal.
void catch_interrupts();
/// The signal that came, 0 if none.
int interrupting_signal();
inline bool interrupted() { return interrupting_signal() != 0; }
/// Cancelled by the first signal.
const CancellationToken& interrupt_token();

}  // namespace pointsweep

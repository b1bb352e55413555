// SPDX-License-Identifier: MIT
/// Ctrl-C and its like: the first asks the run to stop cleanly, the second ends it as the system does.
#pragma once

namespace pointsweep {

/// From now on SIGINT, SIGTERM and SIGHUP (unless ignored, as under nohup) only set a flag, once.
void catch_interrupts();
/// The signal that came, 0 if none.
int interrupting_signal();
inline bool interrupted() { return interrupting_signal() != 0; }
/// Throws Cancelled if a signal came. To be called between pieces of work.
void stop_if_interrupted();

}  // namespace pointsweep

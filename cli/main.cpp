// SPDX-License-Identifier: MIT
#include "cli/tool.h"

int main(int argc, char** argv) { return pointsweep::run_tool(argc, argv); }

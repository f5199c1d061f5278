// Refuses surfaces that no shell can be put on, before anything is computed.
#pragma once

#include "mesoshell/shell.h"

namespace mesoshell {

// Throws as build_shell does.
void check_surface(const Surface& surface, const ShellOptions& options);

}  // namespace mesoshell

// Refuses surfaces that no shell can be put on, before anything is computed.
#pragma once

#include "mesoshell/shell.h"

namespace mesoshell {

// Throws as build_shell does.
void check_surface(const Surface& surface, const ShellOptions& options);

// Throws as update_shell does; `vertices` are those of the surface.
void check_pose(const Pose& pose, std::size_t vertices);

}  // namespace mesoshell

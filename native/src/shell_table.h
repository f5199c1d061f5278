// The prism table and the hulls: what the draw program reads, from a shell's shared vertices.
#pragma once

#include "mesoshell/shell.h"

namespace mesoshell {

// Makes prisms, indices and bounds from the topology and what each vertex has.
void make_table(Shell& shell, Job& job);

}  // namespace mesoshell

// The ways to find where a ray meets the mesostructure: mode.x of the uniform block, and their names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mesoshell {

// As TRAVERSAL_* of shaders/lib/traverse.glsl; `exact` is the CPU's alone.
enum class Traversal { gdm = 0, sdf = 1, refined = 2, march = 3, slices = 4, exact = 5 };

// Throws InvalidArgument, with the names to choose from, for one that does not exist.
Traversal traversal_named(std::string_view name);
void check_traversal(int traversal);

// Those that exist, in the order of the enumeration.
std::vector<std::string> traversal_names();

}  // namespace mesoshell

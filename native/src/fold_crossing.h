// Which pieces of a shell's boundary cross: triangles of its base and top, and fins along its borders.
#pragma once

#include <array>

#include <glm/glm.hpp>

namespace mesoshell {

using Triangle = std::array<glm::vec3, 3>;

// A fin: corners in turn, counterclockwise seen from outside the shell; bilinear between them.
using Patch = std::array<glm::vec3, 4>;

// On which side of a triangle the shell is: on that from which it is seen counterclockwise, or on the other.
enum class Inside { front, back };

// Whether two triangles have a point in common that lies in the inside of both, not on an edge: triangles that share a
// vertex or an edge, or only touch, do not cross, and one without area crosses nothing. Coplanar ones cross if they overlap
// and both have the shell on the same side. Exact (orientation; Guigue and Devillers 2003 with strict comparisons).
bool crossing(const Triangle& a, Inside inside_a, const Triangle& b, Inside inside_b);

// The same for a fin, which is held by the tetrahedron of its corners: exact where the fin is plane. Where that is crossed,
// `refined` halves the fin thrice each way (corners rounded to single precision), so that its parts bulge 64 times less:
// what comes closer than a 64th of the fin's bulge, or a 1e-5th of its size, may count as crossing. Not for pieces that
// share a vertex.
bool crossing(const Patch& a, const Triangle& b, Inside inside_b, bool refined);
bool crossing(const Patch& a, const Patch& b, bool refined);

}  // namespace mesoshell

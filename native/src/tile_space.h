// The infinite periodic tile as every bake asks about it: where rays may end, what lies inside.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "embree_scene.h"
#include "mesoshell/bake.h"

namespace mesoshell {

// The copies of the tile that anything within `reach` tile widths, sideways, of the unit tile may meet.
TriangleScene::Lattice lattice_within(const Sample& sample, float reach);

// The same for some other mesh with the tile's periods.
TriangleScene::Lattice lattice_within(std::span<const glm::vec3> positions, float aspect, float reach);

// Distance from z along a direction with vertical part dir_z to where it leaves the slab; at most horizon_distance.
float slab_exit(float z, float dir_z, float height);

// How far sideways a ray of a GDM bake can go, tile widths.
float farthest_reach(const GdmResolution& resolution, float height);

// Throws InvalidArgument where `what` would take more bytes than the machine has: better a sentence than the system's killer.
void check_memory(const std::string& what, double bytes, const std::string& remedy);

// 1 where a node (x, y, z) of an [nz, ny, nx] grid lies in the solid.
std::vector<std::uint8_t> classify_inside(const Sample& sample, const glm::ivec3& nodes, Job& job);

}  // namespace mesoshell

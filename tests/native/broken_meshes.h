// Meshes as artists and importers break them, each with the oriented mesh that says what is inside.
#pragma once

#include <string>
#include <vector>

#include "check.h"
#include "meshes.h"

namespace mesoshell {

enum class Solid { ball, box, torus, strands, hollow_ball, overlapping_balls, terrain, ball_at_corner };
constexpr Solid all_solids[] = {Solid::ball,        Solid::box,               Solid::torus,   Solid::strands,
                                Solid::hollow_ball, Solid::overlapping_balls, Solid::terrain, Solid::ball_at_corner};
std::string name_of(Solid solid);

enum class Damage {
    scattered_holes, torn_off, flips, inside_out, duplicates, crumpled, unwelded, cracked, slivers, fins, huge_triangles,
    all
};
constexpr Damage all_damages[] = {Damage::scattered_holes, Damage::torn_off, Damage::flips,    Damage::inside_out,
                                  Damage::duplicates,      Damage::crumpled, Damage::unwelded, Damage::cracked,
                                  Damage::slivers,         Damage::fins,     Damage::huge_triangles, Damage::all};
std::string name_of(Damage damage);

struct BrokenMesh {
    Mesh mesh;   // as it is given to Mesoshell
    Mesh truth;  // its faces, once each, with the sides that they had before they were broken
    float height = 0.0f;
    float aspect = 1.0f;
    int covering = 0;    // sheets that span the tile: one for a terrain
    double moved = 0.0;  // how far a repair may move the surface, tile widths
};

// A solid of some 150 to 300 triangles with random place, size and proportions.
BrokenMesh random_solid(Solid solid, Random& random);

BrokenMesh broken(BrokenMesh solid, Damage damage, Random& random);

// Triangles anywhere, none of which touch on purpose.
Mesh triangle_soup(int count, double size, float height, float aspect, Random& random);

}  // namespace mesoshell

// The traversal `refined` from chord to chord of a curve: what it keeps, and how it bends, against one whole segment and
// against a closed form.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "mesoshell/facets.h"
#include "meshes.h"
#include "render_with.h"
#include "shader_text.h"

namespace mesoshell {
namespace {

constexpr float height = 0.5f;

Map map_of(const Sample& sample)
{
    Job job;
    Map map = sdf_map(sample, {24, 24, 13});
    const Facets facets = bake_facets(sample, 32, job);
    attach(map, &facets, nullptr);
    return map;
}

shader::Tile tile_of_map(const Map& map)
{
    ShellParams params;
    params.sdf_nodes = glm::vec4(glm::vec3(map.sdf_nodes), 0.0f);
    params.facet_cells = glm::vec4(glm::vec3(map.facets.cells), 0.0f);
    params.tile = glm::vec4(map.height, map.aspect, 0.0f, 0.0f);
    return shader::tile_of(params);
}

struct Answer {
    bool hit = false;
    float along = 0.0f;  // of the whole
    int fetches = 0;
};

Answer in_pieces(const Map& map, const glm::vec3& entry, const glm::vec3& exit, int pieces, bool keep)
{
    Answer answer;
    shader::KeptFacets kept = shader::nothing_kept();
    for (int i = 0; i < pieces && !answer.hit; ++i) {
        const glm::vec3 first = glm::mix(entry, exit, static_cast<float>(i) / pieces);
        const glm::vec3 last = glm::mix(entry, exit, static_cast<float>(i + 1) / pieces);
        const shader::SegmentHit found =
            shader::traverse_refined(tile_of_map(map), first, last, glm::vec3(0.0f), keep ? kept : shader::nothing_kept());
        kept = found.kept;
        answer.hit = found.hit;
        answer.along = (i + found.along) / pieces;
        answer.fetches += found.fetches;
    }
    return answer;
}

// Balls leave empty boxes, cells of planes and split cells; segments cross the tile's borders at any copy.
TEST(RefinedChords, PiecesFetchAsOftenAsTheWhole)
{
    const Sample sample = merged(sphere({0.3f, 0.35f, 0.2f}, 0.17f, 16, 24), sphere({0.62f, 0.6f, 0.26f}, 0.14f, 12, 16))
                              .sample(height);
    const Map map = map_of(sample);
    const MapVolumes volumes;
    const shader::FetchScope scope(map, volumes);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> any(-3.0f, 3.0f);
    std::uniform_real_distribution<float> step(-0.7f, 0.7f);
    int whole_fetches = 0;
    int kept_fetches = 0;
    int fresh_fetches = 0;
    int hits = 0;
    int other_hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 entry(any(random), any(random), 1.0f);
        const glm::vec3 exit(entry.x + step(random), entry.y + step(random), 0.0f);
        const Answer whole = in_pieces(map, entry, exit, 1, true);
        const Answer kept = in_pieces(map, entry, exit, 9, true);
        const Answer fresh = in_pieces(map, entry, exit, 9, false);
        whole_fetches += whole.fetches;
        kept_fetches += kept.fetches;
        fresh_fetches += fresh.fetches;
        hits += whole.hit ? 1 : 0;
        const bool same = whole.hit == kept.hit && (!whole.hit || std::abs(whole.along - kept.along) < 1e-4f);
        other_hits += same ? 0 : 1;
        EXPECT_EQ(kept.hit, fresh.hit) << i;
    }
    EXPECT_GT(hits, 300);
    // Pieces round their ends: one in a thousand may pass an edge on the other side.
    EXPECT_LE(other_hits, 2);
    EXPECT_NEAR(kept_fetches, whole_fetches, 0.005 * whole_fetches);
    EXPECT_GT(fresh_fetches, 1.5 * kept_fetches);
}

// A slab's top, which planes hold up to their 8 bits: the parabola meets it where a quadratic is zero. It bulges by no more
// than a tenth of a cell, as curves do beside their chords; the segment itself is off by up to 8e-3.
TEST(RefinedChords, AParabolaMeetsAPlaneWhereItsQuadraticIsZero)
{
    const float top = 0.26f;  // metric
    const Map map = map_of(slab(0.05f, top).sample(height));
    const MapVolumes volumes;
    const shader::FetchScope scope(map, volumes);
    const double plane = top / height;
    for (const double bend : {-0.02, -0.005, 0.0, 0.005, 0.02}) {
        const glm::vec3 entry(0.2f, 0.3f, 0.9f);
        const glm::vec3 exit(1.3f, 0.9f, 0.3f);
        const shader::SegmentHit found = shader::traverse_refined(
            tile_of_map(map), entry, exit, glm::vec3(0.0f, 0.0f, bend), shader::nothing_kept());
        // 0.9 - 0.6 a + bend a (1 - a) = plane
        const double linear = bend - 0.6;
        const double root = std::sqrt(linear * linear + 4.0 * bend * (0.9 - plane));
        const double met = bend == 0.0 ? (0.9 - plane) / 0.6 : (linear + root) / (2.0 * bend);
        ASSERT_TRUE(found.hit) << bend;
        EXPECT_NEAR(found.along, met, 1e-3) << bend;
        EXPECT_NEAR(found.aside.z, bend * found.along * (1.0 - found.along), 1e-4) << bend;
        EXPECT_GT(found.normal.z, 0.999f) << bend;
    }
}

}  // namespace
}  // namespace mesoshell

#include "mesoshell/leaps.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "direction_bins.h"
#include "parallel.h"
#include "surface_voxels.h"
#include "tile_space.h"

namespace mesoshell {
namespace shader_leap {

using namespace glm;  // NOLINT: the shader text speaks GLSL
#include "../../shaders/lib/leap.glsl"

}  // namespace shader_leap

namespace {

constexpr int block_voxels = voxels_a_side * voxels_a_side * voxels_a_side;
constexpr int most_cells_away = 128;

// A cell some cells away from that where rays start: which of its voxels they can reach, and after how many leap units at
// least.
struct Block {
    std::uint64_t reach = 0;
    glm::ivec3 offset{0};  // along u and v modulo the cells of the tile
    std::uint8_t nearest = 0;
    std::uint8_t distances[block_voxels];
};

// A block as the cells of one layer see it.
struct Step {
    std::uint64_t reach;
    int column;
    int row;
    std::size_t layer;  // index of the layer's first cell
    const Block* block;
};

// What all bins share.
struct Tile {
    glm::ivec3 cells;
    int directions;
    glm::dvec3 side;  // of a cell, tile widths
    int limit;        // no bound is larger, leap units
};

int quantized(double distance, int limit)
{
    return std::clamp(static_cast<int>(std::floor(distance / leap_unit)), 0, limit);
}

// Where vectors from a point of a cell to a point of a box end: the box less the cell. `from` and `to` are counted in voxels
// from the cell's lower corner. Places are only known up to rounding, so it is larger by the slack.
Bounds difference(const Tile& tile, const glm::ivec3& from, const glm::ivec3& to)
{
    const glm::dvec3 voxel = tile.side / double(voxels_a_side);
    return {glm::dvec3(from) * voxel - tile.side - bin_slack, glm::dvec3(to) * voxel + bin_slack};
}

void measure_block(const Tile& tile, const BinCone& cone, Block& block)
{
    const double limit = tile.limit * double(leap_unit);
    int nearest = tile.limit;
    for (int bit = 0; bit < block_voxels; ++bit) {
        const glm::ivec3 voxel = block.offset * voxels_a_side + glm::ivec3(bit, bit / 4, bit / 16) % 4;
        const int distance = quantized(cone.distance(difference(tile, voxel, voxel + 1), limit), tile.limit);
        block.distances[bit] = static_cast<std::uint8_t>(distance);
        if (distance < tile.limit) {
            block.reach |= std::uint64_t(1) << bit;
            nearest = std::min(nearest, distance);
        }
    }
    block.nearest = static_cast<std::uint8_t>(nearest);
}

// A counting sort, which leaves equally near ones in order.
std::vector<Block> nearest_first(std::span<const Block> blocks)
{
    std::array<std::size_t, 257> place{};
    for (const Block& block : blocks) {
        place[block.nearest + 1] += 1;
    }
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<Block> sorted(blocks.size());
    for (const Block& block : blocks) {
        sorted[place[block.nearest]++] = block;
    }
    return sorted;
}

// The blocks that a bin's rays can reach, nearest first; some of them where the job was cancelled.
std::vector<Block> blocks_within_reach(const Tile& tile, int bin, const Job& job)
{
    const BinCone cone(bin, tile.directions);
    const auto misses = [&](const glm::ivec3& first, const glm::ivec3& last) {
        return cone.misses(difference(tile, first * voxels_a_side, (last + 1) * voxels_a_side));
    };
    const glm::ivec3 most(static_cast<int>(tile.limit * double(leap_unit) / tile.side.x) + 2,
                          static_cast<int>(tile.limit * double(leap_unit) / tile.side.y) + 2, tile.cells.z - 1);
    std::vector<Block> blocks;
    for (int z = -most.z; z <= most.z && !job.cancelled(); ++z) {
        if (misses({-most.x, -most.y, z}, {most.x, most.y, z})) {
            continue;
        }
        for (int y = -most.y; y <= most.y; ++y) {
            if (misses({-most.x, y, z}, {most.x, y, z})) {
                continue;
            }
            for (int x = -most.x; x <= most.x; ++x) {
                Block block;
                block.offset = glm::ivec3(x, y, z);
                if (misses(block.offset, block.offset)) {
                    continue;
                }
                measure_block(tile, cone, block);
                if (block.reach != 0) {
                    block.offset.x = (x % tile.cells.x + tile.cells.x) % tile.cells.x;
                    block.offset.y = (y % tile.cells.y + tile.cells.y) % tile.cells.y;
                    blocks.push_back(block);
                }
            }
        }
    }
    return nearest_first(blocks);
}

// The blocks that lie in the slab, seen from a layer of cells, and hold anything that can be reached in any place of theirs.
std::vector<Step> steps_from(const Tile& tile, int z, std::span<const Block> blocks, std::span<const std::uint64_t> layers)
{
    std::vector<Step> steps;
    for (const Block& block : blocks) {
        const int layer = z + block.offset.z;
        if (layer >= 0 && layer < tile.cells.z && (layers[layer] & block.reach) != 0) {
            steps.push_back({block.reach, block.offset.x, block.offset.y,
                             static_cast<std::size_t>(layer) * tile.cells.y * tile.cells.x, &block});
        }
    }
    return steps;
}

int bound_of_cell(const Tile& tile, int x, int y, std::span<const Step> steps, const std::uint64_t* marks)
{
    int bound = tile.limit;
    for (const Step& step : steps) {
        if (step.block->nearest >= bound) {
            break;
        }
        const int column = x + step.column < tile.cells.x ? x + step.column : x + step.column - tile.cells.x;
        const int row = y + step.row < tile.cells.y ? y + step.row : y + step.row - tile.cells.y;
        std::uint64_t met = marks[step.layer + static_cast<std::size_t>(row) * tile.cells.x + column] & step.reach;
        for (; met != 0; met &= met - 1) {
            bound = std::min(bound, static_cast<int>(step.block->distances[std::countr_zero(met)]));
        }
    }
    return bound;
}

void bake_bin(const Tile& tile, int bin, const SurfaceVoxels& voxels, Leaps& leaps, Job& job)
{
    const std::vector<Block> blocks = blocks_within_reach(tile, bin, job);
    const std::vector<std::uint64_t> marks = voxels.of_bin(bin);
    const std::size_t layer_size = static_cast<std::size_t>(tile.cells.y) * tile.cells.x;
    std::vector<std::uint64_t> layers(tile.cells.z, 0);  // the marks of all cells of a layer
    for (std::size_t cell = 0; cell < marks.size(); ++cell) {
        layers[cell / layer_size] |= marks[cell];
    }
    for (int z = 0; z < tile.cells.z && !job.cancelled(); ++z) {
        const std::vector<Step> steps = steps_from(tile, z, blocks, layers);
        for (int y = 0; y < tile.cells.y; ++y) {
            std::uint8_t* const row = leaps.values.data() + leaps.index(bin, {0, y, z});
            for (int x = 0; x < tile.cells.x && !job.cancelled(); ++x) {
                row[x] = static_cast<std::uint8_t>(bound_of_cell(tile, x, y, steps, marks.data()));
            }
        }
    }
}

void check_resolution(const LeapResolution& r)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (r.cells[axis] < 1 || r.cells[axis] > 64) {
            throw InvalidArgument("the leap table has " + std::to_string(r.cells[axis]) + " cells on a side; give 1 to 64");
        }
    }
    if (r.directions < 2 || r.directions > 16 || r.directions % 2 != 0) {
        throw InvalidArgument("the side of the leap table's octahedral map is " + std::to_string(r.directions) +
                              "; give an even number from 2 to 16");
    }
    check_memory("the leap table", SurfaceVoxels::bytes(r.cells, r.directions), "lower its resolution");
}

}  // namespace

Leaps bake_leaps(const Sample& sample, const LeapResolution& resolution, Job& job)
{
    check_resolution(resolution);
    Leaps leaps;
    leaps.cells = resolution.cells;
    leaps.directions = resolution.directions;
    leaps.height = sample.height();
    leaps.aspect = sample.aspect();
    const int bins = resolution.directions * resolution.directions;
    leaps.values.resize(leaps.index(bins, glm::ivec3(0)));

    job.stage(0.0f, 0.1f);
    const SurfaceVoxels voxels(sample, resolution.cells, resolution.directions, job);
    job.stage(0.1f, 1.0f);
    Tile tile;
    tile.cells = resolution.cells;
    tile.directions = resolution.directions;
    tile.side = glm::dvec3(1.0, sample.aspect(), sample.height()) / glm::dvec3(resolution.cells);
    tile.limit = quantized(most_cells_away * std::min(tile.side.x, tile.side.y), 255);
    parallel_for(job, bins, [&](int bin) { bake_bin(tile, bin, voxels, leaps, job); });
    return leaps;
}

int octahedral_bin(const glm::vec3& dir_metric, int directions)
{
    return shader_leap::octahedral_bin(dir_metric, directions);
}

float lookup_leap(const Leaps& leaps, const glm::vec3& pos_texture, const glm::vec3& dir_metric)
{
    const glm::ivec3 cell(shader_leap::leap_cell(pos_texture, glm::vec3(leaps.cells)));
    const int bin = octahedral_bin(dir_metric, leaps.directions);
    return leap_unit * static_cast<float>(leaps.values[leaps.index(bin, cell)]);
}

float leap_length(const Leaps& leaps, const glm::vec3& pos_texture, const glm::vec3& dir_metric)
{
    const glm::vec3 scale(1.0f, leaps.aspect, leaps.height);
    return shader_leap::leap_length(pos_texture, dir_metric, glm::vec3(leaps.cells), scale,
                                    lookup_leap(leaps, pos_texture, dir_metric));
}

std::vector<float> leap_lengths(const Leaps& leaps, std::span<const glm::vec3> pos_texture,
                                std::span<const glm::vec3> dir_metric)
{
    if (pos_texture.size() != dir_metric.size()) {
        throw InvalidArgument("there are " + std::to_string(pos_texture.size()) + " positions and " +
                              std::to_string(dir_metric.size()) + " directions; give one direction for each position");
    }
    std::vector<float> lengths(pos_texture.size());
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const float length = glm::length(dir_metric[i]);
        if (!(length > 0.0f) || !std::isfinite(length) || !std::isfinite(glm::length(pos_texture[i]))) {
            throw InvalidArgument("ray " + std::to_string(i) + " is not finite or has no direction; leave it out");
        }
        lengths[i] = leap_length(leaps, pos_texture[i], dir_metric[i] / length);
    }
    return lengths;
}

}  // namespace mesoshell

// Folders and files of the store's tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "check.h"
#include "mesoshell/compress.h"

namespace mesoshell {

// A folder of its own for the life of a test.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "mesoshell-test-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) {
            throw std::runtime_error("no temporary folder: " + pattern);
        }
        path_ = pattern;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string file(const std::string& name) const { return (path_ / name).string(); }

    // Names of what lies in it, sorted.
    std::vector<std::string> content() const
    {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path_)) {
            names.push_back(entry.path().filename().string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

private:
    std::filesystem::path path_;
};

inline std::string read_bytes(const std::string& path)
{
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes)
{
    std::ofstream(path, std::ios::binary) << bytes;
}

// A small map with every array of another size.
inline Map small_map(Precision precision, bool with_sdf, std::uint32_t seed = 1)
{
    Random random(seed);
    Map map;
    map.resolution.nodes = glm::ivec3(6, 5, 4);
    map.resolution.ntheta = 3;
    map.resolution.nphi = 7;
    map.height = 0.61f;
    map.aspect = 1.37f;
    map.terms = 2;
    map.rmse = 0.0123f;
    map.max_error = 0.456f;
    map.precision = precision;
    map.weights.resize(2 * 7 * 5 * 6);
    map.eigenmaps.resize(2 * 3 * 4);
    if (with_sdf) {
        map.sdf_nodes = glm::ivec3(9, 8, 10);
        map.sdf.resize(9 * 8 * 10);
    }
    for (std::vector<float>* values : {&map.weights, &map.eigenmaps, &map.sdf}) {
        for (float& value : *values) {
            // Multiples of 2^-10 below 1 are half floats; the tenth of one is none.
            const double whole = std::floor(random.uniform(-1023.0, 1023.0));
            value = static_cast<float>(precision == Precision::half ? whole / 1024.0 : whole / 10.0);
        }
    }
    return map;
}

// The same with facets and attributes.
inline Map map_with_all_parts(Precision precision, std::uint32_t seed = 1)
{
    Random random(seed + 1000);
    Map map = small_map(precision, true, seed);
    map.facets.cells = facet_cells(4, map.height, map.aspect);
    map.facets.height = map.height;
    map.facets.aspect = map.aspect;
    map.facets.texels.resize(std::size_t(4) * map.facets.cells.x * map.facets.cells.y * (map.facets.cells.z + 1));
    for (float& word : map.facets.texels) {
        word = static_cast<float>(random.below(1 << 20)) / 3.0f;  // no half
    }
    map.attributes.nodes = glm::ivec3(4, 3, 6);
    map.attributes.color.resize(72 * 3);
    map.attributes.surface.resize(72 * 2);
    map.attributes.normal.resize(72 * 3);
    for (std::vector<float>* values : {&map.attributes.color, &map.attributes.surface, &map.attributes.normal}) {
        for (float& value : *values) {
            value = static_cast<float>(random.below(1024)) / (precision == Precision::half ? 1024.0f : 1023.0f);
        }
    }
    return map;
}

// Every number the same, bit for bit.
inline void expect_same_map(const Map& a, const Map& b)
{
    EXPECT_EQ(a.resolution.nodes, b.resolution.nodes);
    EXPECT_EQ(a.resolution.ntheta, b.resolution.ntheta);
    EXPECT_EQ(a.resolution.nphi, b.resolution.nphi);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.aspect, b.aspect);
    EXPECT_EQ(a.terms, b.terms);
    EXPECT_EQ(a.weights, b.weights);
    EXPECT_EQ(a.eigenmaps, b.eigenmaps);
    EXPECT_EQ(a.sdf_nodes, b.sdf_nodes);
    EXPECT_EQ(a.sdf, b.sdf);
    EXPECT_EQ(a.facets.cells, b.facets.cells);
    EXPECT_EQ(a.facets.height, b.facets.height);
    EXPECT_EQ(a.facets.aspect, b.facets.aspect);
    EXPECT_EQ(a.facets.texels, b.facets.texels);
    EXPECT_EQ(a.attributes.nodes, b.attributes.nodes);
    EXPECT_EQ(a.attributes.color, b.attributes.color);
    EXPECT_EQ(a.attributes.surface, b.attributes.surface);
    EXPECT_EQ(a.attributes.normal, b.attributes.normal);
    EXPECT_EQ(a.rmse, b.rmse);
    EXPECT_EQ(a.max_error, b.max_error);
    EXPECT_EQ(a.precision, b.precision);
}

}  // namespace mesoshell

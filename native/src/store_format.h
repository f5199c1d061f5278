// What writing and reading a map share: how an array becomes a picture, which arrays there are, and their checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mesoshell/compress.h"

namespace mesoshell::store {

// 2: leap tables and surface attributes. 3: facets instead of leap tables. Files of all versions are read; what versions before
// 3 have as "leaps" nothing uses.
constexpr int format_version = 3;
constexpr int oldest_version = 1;

// In the order of Layout and Precision. Files that do not say theirs have the paper's layout, and the precision of their channels.
constexpr const char* layout_names[] = {"paper", "share", "nodes"};
constexpr const char* precision_names[] = {"byte", "half", "float"};

// An array's dimensions, with leading ones: [rows of slices, columns of slices, slice height, slice width].
struct Shape {
    int rows = 1;
    int columns = 1;
    int height = 1;
    int width = 1;

    std::size_t count() const { return std::size_t(rows) * columns * height * width; }
    std::int64_t picture_width() const { return std::int64_t(columns) * width; }
    std::int64_t picture_height() const { return std::int64_t(rows) * height; }
    std::string text() const;
};

// One array as one part of the file.
struct Part {
    const char* name;
    const char* channels;  // a letter each, in the order of the array's last axis; "Y" where it has none
    const char* units;
    Shape shape;
    const std::vector<float>& values;  // those of the map, which outlives the part
    bool all_bits = false;             // 32-bit floats whatever the map's precision
};

// All that parts are called.
constexpr const char* part_names[] = {"gdm.weights", "gdm.eigenmaps", "sdf", "leaps", "facets", "color", "surface", "normal"};

// The parts that a map has, first the GDM's.
std::vector<Part> parts_of(const Map& map);

// Calls copy(array index, picture index, length) for every row of every slice; in pixels, whatever the channels.
template <typename Copy>
void for_each_row(const Shape& shape, const Copy& copy)
{
    std::size_t array_index = 0;
    for (int row = 0; row < shape.rows; ++row) {
        for (int column = 0; column < shape.columns; ++column) {
            for (int y = 0; y < shape.height; ++y, array_index += shape.width) {
                copy(array_index,
                     (std::size_t(row) * shape.height + y) * shape.picture_width() + std::size_t(column) * shape.width,
                     shape.width);
            }
        }
    }
}

// FNV-1a of the map's settings and an array's values, as 16 hexadecimal digits.
std::string checksum(const Map& map, const std::vector<float>& values);

}  // namespace mesoshell::store

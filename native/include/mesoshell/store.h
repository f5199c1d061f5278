// A map as a multi-part OpenEXR file.
//
// Each array is one part, "gdm.weights", "gdm.eigenmaps" and, where there are such, "sdf", "facets" (channels R, G, B, A: 128
// bits as four 32-bit floats, whatever the precision) and the attributes "color" (channels R, G, B), "surface" (R roughness, M
// metallic) and "normal" (X, Y, Z): a flat picture, channel Y where no others are named, half or float, ZIP. The last two dimensions of the array are a slice's rows and
// columns; slices stand side by side along the dimension before them and below one another along the one before that. Header
// attributes: `mesoshell:shape` (the array's dimensions), `mesoshell:version` (3; files of versions 1 and 2 are read),
// `mesoshell:checksum` (FNV-1a, 64 bits, of height, aspect, rmse, maxError and the values in the array's order, all as
// 32-bit floats), `mesoshell:units`, `mesoshell:layout` and `mesoshell:precision` (store_format.h), and the tile's and the
// bake's settings. Bytes of a byte map are whole numbers in halves, which ZIP packs to less than a byte.
#pragma once

#include <string>

#include "mesoshell/compress.h"

namespace mesoshell {

// Writes a temporary file beside `path`, flushes it and renames it: an interrupted or failed save leaves what was there.
// What a killed one wrote (`path`.part-...) is removed by the next save to the same path. Throws FileError; InvalidArgument
// for arrays that do not fit the map's numbers of nodes and terms.
void save_map(const Map& map, const std::string& path);

// Throws FileError where the file cannot be read, Error where it is truncated, damaged or no map.
Map load_map(const std::string& path);

}  // namespace mesoshell

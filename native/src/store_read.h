// A map from any stream of bytes.
#pragma once

#include <cstdint>
#include <string>

#include <OpenEXR/ImfIO.h>

#include "mesoshell/compress.h"

namespace mesoshell::store {

// path: what errors call it; size: of the whole stream, bytes. Throws Error where it is truncated, damaged or no map.
Map read_map(const std::string& path, Imf::IStream& stream, std::uintmax_t size);

}  // namespace mesoshell::store

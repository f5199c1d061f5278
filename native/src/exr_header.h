// A look at an OpenEXR file's headers before OpenEXR reads them.
#pragma once

#include <cstdint>
#include <string>

#include <OpenEXR/ImfIO.h>

namespace mesoshell::store {

// Why these cannot be the headers of a map, or an empty string. OpenEXR believes what a header says: it takes memory for
// attributes and tables larger than the file, and has codecs and attribute types that no map uses. So this wants several
// flat parts of scan lines, uncompressed or by RLE or deflate, attributes of known types and of their types' sizes, and
// tables that fit in the file (openexr.com, "OpenEXR File Layout"). Leaves the stream at its beginning.
std::string doubt_about_headers(Imf::IStream& stream, std::uint64_t size);

}  // namespace mesoshell::store

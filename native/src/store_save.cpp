#include <climits>
#include <string>

#include <OpenEXR/IexBaseExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <Imath/ImathBox.h>

#include "half.h"
#include "mesoshell/store.h"
#include "store_format.h"
#include "temporary_file.h"

namespace mesoshell {
namespace store {
namespace {

void check_parts(const std::vector<Part>& parts)
{
    for (const Part& part : parts) {
        const std::size_t channels = std::string(part.channels).size();
        if (part.values.empty() || part.values.size() != part.shape.count() * channels) {
            throw InvalidArgument(std::string(part.name) + " has " + std::to_string(part.values.size()) + " values, but " +
                                  part.shape.text() + " nodes; compress the map again");
        }
        if (part.shape.picture_width() > INT_MAX || part.shape.picture_height() > INT_MAX) {
            throw InvalidArgument(std::string(part.name) + " is too large for one picture; use fewer terms or nodes");
        }
    }
}

bool is_half(const Map& map, const Part& part)
{
    return map.precision != Precision::single && !part.all_bits;
}

// OpenEXR wants one display window for all parts; the data windows differ.
Imath::Box2i display_window_of(const std::vector<Part>& parts)
{
    Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(0, 0));
    for (const Part& part : parts) {
        window.extendBy(Imath::V2i(static_cast<int>(part.shape.picture_width()) - 1,
                                   static_cast<int>(part.shape.picture_height()) - 1));
    }
    return window;
}

Imf::Header make_header(const Map& map, const Part& part, const Imath::Box2i& display_window)
{
    Imf::Header header(static_cast<int>(part.shape.picture_width()), static_cast<int>(part.shape.picture_height()));
    header.displayWindow() = display_window;
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char channel : std::string(part.channels)) {
        header.channels().insert(std::string(1, channel),
                                 Imf::Channel(is_half(map, part) ? Imf::HALF : Imf::FLOAT));
    }
    header.insert("mesoshell:version", Imf::IntAttribute(format_version));
    header.insert("mesoshell:shape", Imf::StringAttribute(part.shape.text()));
    header.insert("mesoshell:checksum", Imf::StringAttribute(checksum(map, part.values)));
    header.insert("mesoshell:units", Imf::StringAttribute(part.units));
    header.insert("mesoshell:height", Imf::FloatAttribute(map.height));
    header.insert("mesoshell:aspect", Imf::FloatAttribute(map.aspect));
    header.insert("mesoshell:rmse", Imf::FloatAttribute(map.rmse));
    header.insert("mesoshell:maxError", Imf::FloatAttribute(map.max_error));
    header.insert("mesoshell:layout", Imf::StringAttribute(layout_names[static_cast<int>(map.layout)]));
    header.insert("mesoshell:precision", Imf::StringAttribute(precision_names[static_cast<int>(map.precision)]));
    return header;
}

void write_part(Imf::MultiPartOutputFile& file, int index, const Map& map, const Part& part)
{
    const bool half = is_half(map, part);
    const std::string channels = part.channels;
    const std::size_t size = half ? sizeof(Imath::half) : sizeof(float);
    const std::size_t pixel = size * channels.size();
    std::vector<char> picture(part.shape.count() * pixel);
    for_each_row(part.shape, [&](std::size_t from, std::size_t to, int length) {
        for (std::size_t i = 0; i < length * channels.size(); ++i) {
            const float value = part.values[from * channels.size() + i];
            if (half) {
                reinterpret_cast<Imath::half*>(picture.data())[to * channels.size() + i] = Imath::half(value);
            } else {
                reinterpret_cast<float*>(picture.data())[to * channels.size() + i] = value;
            }
        }
    });
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        buffer.insert(std::string(1, channels[c]),
                      Imf::Slice(half ? Imf::HALF : Imf::FLOAT, picture.data() + c * size, pixel,
                                 pixel * part.shape.picture_width()));
    }
    Imf::OutputPart output(file, index);
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(part.shape.picture_height()));
}

}  // namespace
}  // namespace store

void save_map(const Map& map, const std::string& path)
{
    const std::vector<store::Part> parts = store::parts_of(map);
    store::check_parts(parts);
    const Imath::Box2i display_window = store::display_window_of(parts);
    std::vector<Imf::Header> headers;
    for (const store::Part& part : parts) {
        headers.push_back(store::make_header(map, part, display_window));
    }
    TemporaryFile temporary(path);
    try {
        Imf::MultiPartOutputFile file(temporary, headers.data(), static_cast<int>(headers.size()), false, 0);
        for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
            store::write_part(file, i, map, parts[i]);
        }
    } catch (const Iex::BaseExc& problem) {
        throw Error(path + " could not be written: " + problem.what() + "; save it elsewhere");
    }
    temporary.keep();
}

}  // namespace mesoshell

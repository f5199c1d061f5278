#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <fcntl.h>
#include <unistd.h>

#include <OpenEXR/IexBaseExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "exr_header.h"
#include "facet_texels.h"
#include "mesoshell/store.h"
#include "store_format.h"
#include "store_read.h"

namespace mesoshell {
namespace store {
namespace {

// A file that is being read. Every doubt about it ends with a sentence that names it.
class Reader {
public:
    Reader(const std::string& path, Imf::IStream& stream, std::uintmax_t size)
        : path_(path), file_(stream, 0), file_size_(size)
    {
    }

    Map read() const
    {
        check_names();
        const std::optional<int> weights_part = find("gdm.weights");
        const std::optional<int> eigenmaps_part = find("gdm.eigenmaps");
        if (!weights_part || !eigenmaps_part) {
            refuse("it has no parts gdm.weights and gdm.eigenmaps");
        }
        const Imf::Header& header = file_.header(*weights_part);
        Map map = read_settings(header);
        const Imf::Channel* channel = header.channels().findChannel("Y");
        const bool is_half = channel != nullptr && channel->type == Imf::HALF;
        map.layout = static_cast<Layout>(choice(header, "mesoshell:layout", layout_names, 0));
        map.precision = static_cast<Precision>(choice(header, "mesoshell:precision", precision_names, is_half ? 1 : 2));
        if ((map.precision == Precision::single) == is_half) {
            refuse("its precision does not fit its channels");
        }
        const bool by_nodes = map.layout == Layout::nodes;
        const Shape weights = read_shape(*weights_part);
        Shape eigenmaps = read_shape(*eigenmaps_part);
        const Shape eigenmaps_in_file = eigenmaps;
        if (!by_nodes) {
            std::swap(eigenmaps.rows, eigenmaps.columns);
        }
        if (weights.rows != eigenmaps.rows || (by_nodes ? weights : eigenmaps).columns != 1 ||
            std::min(eigenmaps.height, eigenmaps.width) < 2 || std::min(weights.height, weights.width) < 2) {
            refuse("its weights and eigenmaps do not belong together");
        }
        map.terms = weights.rows;
        map.resolution.nphi = by_nodes ? eigenmaps.columns : weights.columns;
        map.resolution.nodes = glm::ivec3(weights.width, weights.height, eigenmaps.width);
        map.resolution.ntheta = eigenmaps.height;
        map.weights = read_part(*weights_part, weights, "Y", map);
        map.eigenmaps = read_part(*eigenmaps_part, eigenmaps_in_file, "Y", map);
        if (const std::optional<int> part = find("sdf")) {
            const Shape sdf = read_shape(*part);
            if (sdf.rows != 1 || std::min(sdf.columns, std::min(sdf.height, sdf.width)) < 2) {
                refuse("its distance field has too few nodes");
            }
            map.sdf_nodes = glm::ivec3(sdf.width, sdf.height, sdf.columns);
            map.sdf = read_part(*part, sdf, "Y", map);
        }
        if (find("color") || find("surface") || find("normal")) {
            map.attributes = read_attributes(map);
        }
        if (const std::optional<int> part = find("facets")) {
            map.facets = read_facets(*part, map);
        }
        return map;
    }

private:
    [[noreturn]] void refuse(const std::string& why) const
    {
        throw Error(path_ + " is not a usable map: " + why + "; bake it again");
    }

    // A part of another name is a damaged one: what may be missing must not be lost by a letter.
    void check_names() const
    {
        for (int i = 0; i < file_.parts(); ++i) {
            const std::string name = file_.header(i).hasName() ? file_.header(i).name() : "";
            if (std::find(std::begin(part_names), std::end(part_names), name) == std::end(part_names)) {
                refuse("it has an unknown part '" + name + "'");
            }
        }
    }

    template <typename Attribute>
    auto attribute(const Imf::Header& header, const char* name) const
    {
        const auto* found = header.findTypedAttribute<Attribute>(name);
        if (found == nullptr) {
            refuse(std::string("it has no attribute ") + name);
        }
        return found->value();
    }

    // Index of the name that an attribute holds; `otherwise` where there is no such attribute.
    template <std::size_t count>
    int choice(const Imf::Header& header, const char* attribute, const char* const (&names)[count], int otherwise) const
    {
        const auto* found = header.findTypedAttribute<Imf::StringAttribute>(attribute);
        if (found == nullptr) {
            return otherwise;
        }
        const auto* name = std::find_if(names, names + count, [&](const char* known) { return found->value() == known; });
        if (name == names + count) {
            refuse(std::string(attribute) + " is '" + found->value() + "'");
        }
        return static_cast<int>(name - names);
    }

    std::optional<int> find(const std::string& name) const
    {
        for (int i = 0; i < file_.parts(); ++i) {
            if (file_.header(i).hasName() && file_.header(i).name() == name) {
                return i;
            }
        }
        return std::nullopt;
    }

    Map read_settings(const Imf::Header& header) const
    {
        const int version = attribute<Imf::IntAttribute>(header, "mesoshell:version");
        if (version < oldest_version || version > format_version) {
            refuse("it has format version " + std::to_string(version) + ", this build reads versions " +
                   std::to_string(oldest_version) + " to " + std::to_string(format_version));
        }
        Map map;
        map.height = attribute<Imf::FloatAttribute>(header, "mesoshell:height");
        map.aspect = attribute<Imf::FloatAttribute>(header, "mesoshell:aspect");
        map.rmse = attribute<Imf::FloatAttribute>(header, "mesoshell:rmse");
        map.max_error = attribute<Imf::FloatAttribute>(header, "mesoshell:maxError");
        if (!(map.height > 0.0f && map.height < 1e6f && map.aspect > 0.0f && map.aspect < 1e6f)) {
            refuse("its height or aspect makes no sense");
        }
        return map;
    }

    Facets read_facets(int part, const Map& map) const
    {
        const Shape shape = read_shape(part, 4);
        Facets facets;
        facets.height = map.height;
        facets.aspect = map.aspect;
        facets.cells = facet_cells(shape.width, map.height, map.aspect);
        if (shape.rows != 1 || shape.width > 128 || shape.height != facets.cells.y || shape.columns < facets.cells.z) {
            refuse("its facets have a number of cells that makes no sense");
        }
        facets.texels = read_part(part, shape, "RGBA", map);
        if (!facets_make_sense(facets)) {
            refuse("its facets name parts of cells that it does not have");
        }
        return facets;
    }

    Attributes read_attributes(const Map& map) const
    {
        const auto whole = [&](const char* name, const std::string& channels, glm::ivec3& nodes) {
            const std::optional<int> part = find(name);
            if (!part) {
                refuse("it has only some of the parts color, surface and normal");
            }
            const Shape shape = read_shape(*part, static_cast<int>(channels.size()));
            const glm::ivec3 found(shape.width, shape.height, shape.columns);
            if (shape.rows != 1 || std::min(found.x, std::min(found.y, found.z)) < 2 ||
                (nodes != glm::ivec3(0) && nodes != found)) {
                refuse("its attributes have too few nodes or do not belong together");
            }
            nodes = found;
            return read_part(*part, shape, channels, map);
        };
        Attributes attributes;
        attributes.color = whole("color", "RGB", attributes.nodes);
        attributes.surface = whole("surface", "RM", attributes.nodes);
        attributes.normal = whole("normal", "XYZ", attributes.nodes);
        return attributes;
    }

    Shape read_shape(int part, int channels = 1) const
    {
        const Imf::Header& header = file_.header(part);
        const std::string text = attribute<Imf::StringAttribute>(header, "mesoshell:shape");
        Shape shape;
        int used = 0;
        const int found =
            std::sscanf(text.c_str(), "%d %d %d %d%n", &shape.rows, &shape.columns, &shape.height, &shape.width, &used);
        if (found != 4 || static_cast<std::size_t>(used) != text.size() || std::min(shape.rows, shape.columns) < 1 ||
            std::min(shape.height, shape.width) < 1 || shape.picture_width() > INT_MAX || shape.picture_height() > INT_MAX) {
            refuse("the shape '" + text + "' makes no sense");
        }
        const auto& window = header.dataWindow();
        if (window.min.x != 0 || window.min.y != 0 || window.max.x + std::int64_t(1) != shape.picture_width() ||
            window.max.y + std::int64_t(1) != shape.picture_height()) {
            refuse("the shape '" + text + "' does not fit its picture");
        }
        // Deflate packs at most about 1030 to 1, and every 16 lines take 20 bytes beside: a small file cannot ask for much
        // memory.
        const double overhead = 20.0 * std::ceil(static_cast<double>(shape.picture_height()) / 16.0);
        const double values =
            static_cast<double>(shape.picture_width()) * static_cast<double>(shape.picture_height()) * channels;
        if (values * sizeof(std::uint16_t) > 1100.0 * (static_cast<double>(file_size_) - overhead)) {
            refuse("it promises more data than it can hold");
        }
        return shape;
    }

    std::vector<float> read_part(int index, const Shape& shape, const std::string& channels, const Map& map) const
    {
        const Imf::Header& header = file_.header(index);
        if (!file_.partComplete(index)) {
            refuse("part " + header.name() + " is not complete");
        }
        const std::size_t pixel = channels.size();
        std::vector<float> picture(shape.count() * pixel);
        Imf::FrameBuffer buffer;
        for (std::size_t c = 0; c < pixel; ++c) {
            const std::string channel(1, channels[c]);
            if (header.channels().findChannel(channel) == nullptr) {
                refuse("part " + header.name() + " has no channel " + channel);
            }
            buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(picture.data() + c), sizeof(float) * pixel,
                                              sizeof(float) * pixel * shape.picture_width()));
        }
        Imf::InputPart input(file_, index);
        input.setFrameBuffer(buffer);
        input.readPixels(0, static_cast<int>(shape.picture_height()) - 1);
        std::vector<float> values(picture.size());
        for_each_row(shape, [&](std::size_t to, std::size_t from, int length) {
            std::copy_n(picture.begin() + from * pixel, length * pixel, values.begin() + to * pixel);
        });
        if (checksum(map, values) != attribute<Imf::StringAttribute>(header, "mesoshell:checksum")) {
            refuse("part " + header.name() + " does not match its checksum");
        }
        if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) {
            refuse("part " + header.name() + " holds values that are not finite");
        }
        return values;
    }

    std::string path_;
    mutable Imf::MultiPartInputFile file_;  // Imf::InputPart takes it as one that changes
    std::uintmax_t file_size_;
};

}  // namespace

Map read_map(const std::string& path, Imf::IStream& stream, std::uintmax_t size)
{
    try {
        if (const std::string doubt = doubt_about_headers(stream, size); !doubt.empty()) {
            throw Error(path + " is not a usable map: " + doubt + "; bake it again");
        }
        return Reader(path, stream, size).read();
    } catch (const Iex::BaseExc& problem) {
        throw Error(path + " is not a usable map: " + problem.what() + "; bake it again");
    }
}

}  // namespace store

Map load_map(const std::string& path)
{
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        throw FileError(errno, path);
    }
    close(file);
    try {
        const std::uintmax_t size = std::filesystem::file_size(path);
        Imf::StdIFStream stream(path.c_str());
        return store::read_map(path, stream, size);
    } catch (const Iex::BaseExc& problem) {
        throw Error(path + " is not a usable map: " + problem.what() + "; bake it again");
    } catch (const std::filesystem::filesystem_error& problem) {
        throw FileError(problem.code().value(), path);
    }
}

}  // namespace mesoshell

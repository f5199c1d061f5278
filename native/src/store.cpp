#include "mesoshell/store.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <climits>
#include <cmath>
#include <cstdint>
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
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <Imath/ImathBox.h>

#include "half.h"

namespace mesoshell {
namespace {

constexpr int format_version = 1;

// An array's dimensions, with leading ones: [rows of slices, columns of slices, slice height, slice width].
struct Shape {
    int rows = 1;
    int columns = 1;
    int height = 1;
    int width = 1;

    std::size_t count() const { return std::size_t(rows) * columns * height * width; }
    std::int64_t picture_width() const { return std::int64_t(columns) * width; }
    std::int64_t picture_height() const { return std::int64_t(rows) * height; }
    std::string text() const
    {
        return std::to_string(rows) + " " + std::to_string(columns) + " " + std::to_string(height) + " " +
               std::to_string(width);
    }
};

struct Part {
    const char* name;
    Shape shape;
    const std::vector<float>* values;
};

Shape weights_shape(const Map& map)
{
    return {map.terms, map.resolution.nphi, map.resolution.nodes.y, map.resolution.nodes.x};
}

Shape eigenmaps_shape(const Map& map)
{
    return {1, map.terms, map.resolution.ntheta, map.resolution.nodes.z};
}

Shape sdf_shape(const Map& map)
{
    return {1, map.sdf_nodes.z, map.sdf_nodes.y, map.sdf_nodes.x};
}

// Calls copy(array index, picture index, length) for every row of every slice.
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

std::string checksum(const Map& map, const std::vector<float>& values)
{
    std::uint64_t hash = 0xCBF29CE484222325u;
    const auto add = [&](const float* numbers, std::size_t count) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(numbers);
        for (std::size_t i = 0; i < count * sizeof(float); ++i) {
            hash = (hash ^ bytes[i]) * 0x100000001B3u;
        }
    };
    const float settings[4] = {map.height, map.aspect, map.rmse, map.max_error};
    add(settings, 4);
    add(values.data(), values.size());
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

// --- Writing ---

// OpenEXR wants one display window for all parts; the data windows differ.
Imf::Header make_header(const Map& map, const Part& part, const Imath::Box2i& display_window)
{
    Imf::Header header(static_cast<int>(part.shape.picture_width()), static_cast<int>(part.shape.picture_height()));
    header.displayWindow() = display_window;
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.channels().insert("Y", Imf::Channel(map.precision == Precision::half ? Imf::HALF : Imf::FLOAT));
    header.insert("mesoshell:version", Imf::IntAttribute(format_version));
    header.insert("mesoshell:shape", Imf::StringAttribute(part.shape.text()));
    header.insert("mesoshell:checksum", Imf::StringAttribute(checksum(map, *part.values)));
    header.insert("mesoshell:units", Imf::StringAttribute("tile widths"));
    header.insert("mesoshell:height", Imf::FloatAttribute(map.height));
    header.insert("mesoshell:aspect", Imf::FloatAttribute(map.aspect));
    header.insert("mesoshell:rmse", Imf::FloatAttribute(map.rmse));
    header.insert("mesoshell:maxError", Imf::FloatAttribute(map.max_error));
    return header;
}

void write_part(Imf::MultiPartOutputFile& file, int index, const Map& map, const Part& part)
{
    const bool half = map.precision == Precision::half;
    const std::size_t size = half ? sizeof(Imath::half) : sizeof(float);
    std::vector<char> picture(part.shape.count() * size);
    for_each_row(part.shape, [&](std::size_t from, std::size_t to, int length) {
        for (int i = 0; i < length; ++i) {
            const float value = (*part.values)[from + i];
            if (half) {
                reinterpret_cast<Imath::half*>(picture.data())[to + i] = Imath::half(value);
            } else {
                reinterpret_cast<float*>(picture.data())[to + i] = value;
            }
        }
    });
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(half ? Imf::HALF : Imf::FLOAT, picture.data(), size, size * part.shape.picture_width()));
    Imf::OutputPart output(file, index);
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(part.shape.picture_height()));
}

[[noreturn]] void throw_errno(const std::string& path)
{
    throw FileError(errno != 0 ? errno : EIO, path);
}

// What OpenEXR writes to, beside the target; removed unless it was kept. OpenEXR writes its last bytes in a destructor, which
// cannot say that the disk is full, so the first failure of all is remembered here.
class TemporaryFile : public Imf::OStream {
public:
    explicit TemporaryFile(const std::string& target)
        : OStream(target.c_str()), target_(target)
    {
        // A link stays one, and what it points to is replaced.
        std::error_code problem;
        const std::filesystem::path resolved = std::filesystem::canonical(target, problem);
        if (!problem) {
            target_ = resolved.string();
        }
        // A name of its own for every save, so that two to one path never share a file.
        static std::atomic<unsigned> saves = 0;
        for (int attempt = 0; attempt < 100 && file_ == nullptr; ++attempt) {
            path_ = target_ + ".part-" + std::to_string(getpid()) + "-" + std::to_string(++saves);
            file_ = std::fopen(path_.c_str(), "wbxe");
            if (file_ == nullptr && errno != EEXIST) {
                break;
            }
        }
        if (file_ == nullptr) {
            path_.clear();
            throw_errno(target);
        }
    }
    ~TemporaryFile() override
    {
        if (file_ != nullptr) {
            std::fclose(file_);
        }
        if (!path_.empty()) {
            unlink(path_.c_str());
        }
    }
    void write(const char bytes[], int count) override
    {
        check(std::fwrite(bytes, 1, static_cast<std::size_t>(count), file_) == static_cast<std::size_t>(count));
    }
    std::uint64_t tellp() override { return static_cast<std::uint64_t>(ftello(file_)); }
    void seekp(std::uint64_t position) override { check(fseeko(file_, static_cast<off_t>(position), SEEK_SET) == 0); }

    // Throws FileError if anything was not written.
    void keep()
    {
        check(std::fflush(file_) == 0 && fsync(fileno(file_)) == 0);
        const bool closed = std::fclose(file_) == 0;
        file_ = nullptr;
        check(closed && std::rename(path_.c_str(), target_.c_str()) == 0);
        path_.clear();
    }

private:
    void check(bool done)
    {
        if (!done && code_ == 0) {
            code_ = errno != 0 ? errno : EIO;
        }
        if (code_ != 0) {
            throw FileError(code_, target_);
        }
    }

    std::string target_;
    std::string path_;
    std::FILE* file_ = nullptr;
    int code_ = 0;
};

// --- Reading ---

[[noreturn]] void refuse(const std::string& path, const std::string& why)
{
    throw Error(path + " is not a usable map: " + why + "; bake it again");
}

template <typename Attribute>
typename std::remove_reference_t<decltype(std::declval<Attribute>().value())> attribute(const Imf::Header& header,
                                                                                        const char* name,
                                                                                        const std::string& path)
{
    const auto* found = header.findTypedAttribute<Attribute>(name);
    if (found == nullptr) {
        refuse(path, std::string("it has no attribute ") + name);
    }
    return found->value();
}

Shape read_shape(const Imf::Header& header, const std::string& path, std::uintmax_t file_size)
{
    const std::string text = attribute<Imf::StringAttribute>(header, "mesoshell:shape", path);
    Shape shape;
    int used = 0;
    if (std::sscanf(text.c_str(), "%d %d %d %d%n", &shape.rows, &shape.columns, &shape.height, &shape.width, &used) != 4 ||
        static_cast<std::size_t>(used) != text.size() || std::min(shape.rows, shape.columns) < 1 ||
        std::min(shape.height, shape.width) < 1 || shape.picture_width() > INT_MAX || shape.picture_height() > INT_MAX) {
        refuse(path, "the shape '" + text + "' makes no sense");
    }
    const auto& window = header.dataWindow();
    if (window.min.x != 0 || window.min.y != 0 || window.max.x + std::int64_t(1) != shape.picture_width() ||
        window.max.y + std::int64_t(1) != shape.picture_height()) {
        refuse(path, "the shape '" + text + "' does not fit its picture");
    }
    // Deflate packs at most about 1030 to 1, and every 16 lines take 20 bytes beside: a small file cannot ask for much memory.
    const double overhead = 20.0 * std::ceil(static_cast<double>(shape.picture_height()) / 16.0);
    if (static_cast<double>(shape.picture_width()) * static_cast<double>(shape.picture_height()) * sizeof(std::uint16_t) >
        1100.0 * (static_cast<double>(file_size) - overhead)) {
        refuse(path, "it promises more data than it can hold");
    }
    return shape;
}

std::vector<float> read_part(Imf::MultiPartInputFile& file, int index, const Shape& shape, const Map& map,
                             const std::string& path)
{
    const Imf::Header& header = file.header(index);
    if (!file.partComplete(index)) {
        refuse(path, "part " + header.name() + " is not complete");
    }
    if (header.channels().findChannel("Y") == nullptr) {
        refuse(path, "part " + header.name() + " has no channel Y");
    }
    std::vector<float> picture(shape.count());
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(picture.data()), sizeof(float),
                                  sizeof(float) * shape.picture_width()));
    Imf::InputPart input(file, index);
    input.setFrameBuffer(buffer);
    input.readPixels(0, static_cast<int>(shape.picture_height()) - 1);
    std::vector<float> values(shape.count());
    for_each_row(shape, [&](std::size_t to, std::size_t from, int length) {
        std::copy_n(picture.begin() + from, length, values.begin() + to);
    });
    if (checksum(map, values) != attribute<Imf::StringAttribute>(header, "mesoshell:checksum", path)) {
        refuse(path, "part " + header.name() + " does not match its checksum");
    }
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) {
        refuse(path, "part " + header.name() + " holds values that are not finite");
    }
    return values;
}

Map read_map(const std::string& path)
{
    Imf::MultiPartInputFile file(path.c_str(), 0);
    const std::uintmax_t file_size = std::filesystem::file_size(path);
    std::optional<int> parts[3];
    const char* names[3] = {"gdm.weights", "gdm.eigenmaps", "sdf"};
    for (int i = 0; i < file.parts(); ++i) {
        for (int k = 0; k < 3; ++k) {
            if (file.header(i).hasName() && file.header(i).name() == names[k]) {
                parts[k] = i;
            }
        }
    }
    if (!parts[0] || !parts[1]) {
        refuse(path, "it has no parts gdm.weights and gdm.eigenmaps");
    }
    const Imf::Header& header = file.header(*parts[0]);
    const int version = attribute<Imf::IntAttribute>(header, "mesoshell:version", path);
    if (version != format_version) {
        refuse(path, "it has format version " + std::to_string(version) + ", this build reads version " +
                         std::to_string(format_version));
    }
    Map map;
    map.height = attribute<Imf::FloatAttribute>(header, "mesoshell:height", path);
    map.aspect = attribute<Imf::FloatAttribute>(header, "mesoshell:aspect", path);
    map.rmse = attribute<Imf::FloatAttribute>(header, "mesoshell:rmse", path);
    map.max_error = attribute<Imf::FloatAttribute>(header, "mesoshell:maxError", path);
    if (!(map.height > 0.0f && map.height < 1e6f && map.aspect > 0.0f && map.aspect < 1e6f)) {
        refuse(path, "its height or aspect makes no sense");
    }
    const Shape weights = read_shape(header, path, file_size);
    const Shape eigenmaps = read_shape(file.header(*parts[1]), path, file_size);
    if (weights.rows != eigenmaps.columns || eigenmaps.rows != 1 || std::min(eigenmaps.height, eigenmaps.width) < 2 ||
        std::min(weights.height, weights.width) < 2) {
        refuse(path, "its weights and eigenmaps do not belong together");
    }
    map.terms = weights.rows;
    map.resolution.nphi = weights.columns;
    map.resolution.nodes = glm::ivec3(weights.width, weights.height, eigenmaps.width);
    map.resolution.ntheta = eigenmaps.height;
    const Imf::Channel* channel = header.channels().findChannel("Y");
    map.precision = channel != nullptr && channel->type == Imf::HALF ? Precision::half : Precision::single;
    map.weights = read_part(file, *parts[0], weights, map, path);
    map.eigenmaps = read_part(file, *parts[1], eigenmaps, map, path);
    if (parts[2]) {
        const Shape sdf = read_shape(file.header(*parts[2]), path, file_size);
        if (sdf.rows != 1 || std::min(sdf.columns, std::min(sdf.height, sdf.width)) < 2) {
            refuse(path, "its distance field has too few nodes");
        }
        map.sdf_nodes = glm::ivec3(sdf.width, sdf.height, sdf.columns);
        map.sdf = read_part(file, *parts[2], sdf, map, path);
    }
    return map;
}

}  // namespace

void save_map(const Map& map, const std::string& path)
{
    std::vector<Part> parts{{"gdm.weights", weights_shape(map), &map.weights},
                            {"gdm.eigenmaps", eigenmaps_shape(map), &map.eigenmaps}};
    if (!map.sdf.empty()) {
        parts.push_back({"sdf", sdf_shape(map), &map.sdf});
    }
    Imath::Box2i display_window(Imath::V2i(0, 0), Imath::V2i(0, 0));
    for (const Part& part : parts) {
        if (part.values->empty() || part.values->size() != part.shape.count()) {
            throw InvalidArgument(std::string(part.name) + " has " + std::to_string(part.values->size()) + " values, but " +
                                  part.shape.text() + " nodes; compress the map again");
        }
        if (part.shape.picture_width() > INT_MAX || part.shape.picture_height() > INT_MAX) {
            throw InvalidArgument(std::string(part.name) + " is too large for one picture; use fewer terms or nodes");
        }
        display_window.extendBy(Imath::V2i(static_cast<int>(part.shape.picture_width()) - 1,
                                           static_cast<int>(part.shape.picture_height()) - 1));
    }
    std::vector<Imf::Header> headers;
    for (const Part& part : parts) {
        headers.push_back(make_header(map, part, display_window));
    }
    TemporaryFile temporary(path);
    try {
        Imf::MultiPartOutputFile file(temporary, headers.data(), static_cast<int>(headers.size()), false, 0);
        for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
            write_part(file, i, map, parts[i]);
        }
    } catch (const Iex::BaseExc& problem) {
        throw Error(path + " could not be written: " + problem.what() + "; save it elsewhere");
    }
    temporary.keep();
}

Map load_map(const std::string& path)
{
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        throw_errno(path);
    }
    close(file);
    try {
        return read_map(path);
    } catch (const Iex::BaseExc& problem) {
        refuse(path, problem.what());
    } catch (const std::filesystem::filesystem_error& problem) {
        throw FileError(problem.code().value(), path);
    }
}

}  // namespace mesoshell

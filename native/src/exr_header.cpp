#include "exr_header.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

namespace mesoshell::store {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t largest_headers = 1 << 20;  // bytes of all of them
constexpr std::size_t longest_name = 255;
constexpr std::uint32_t magic = 20000630;
constexpr std::uint32_t version_2_of_parts = 2 | 0x1000;
constexpr std::uint32_t long_names = 0x400;
constexpr int any_size = -1;
constexpr int last_simple_compression = 3;  // none, RLE, deflate of one line, deflate of 16 lines

const std::map<std::string, int> sizes_of_types{
    {"box2f", 16},    {"box2i", 16}, {"chlist", any_size}, {"compression", 1},   {"double", 8},
    {"float", 4},     {"int", 4},    {"lineOrder", 1},     {"m33f", 36},         {"m44f", 64},
    {"string", any_size}, {"v2f", 8}, {"v2i", 8},          {"v3f", 12},          {"v3i", 12}};

class Headers {
public:
    Headers(std::vector<char> bytes, std::uint64_t file_size) : bytes_(std::move(bytes)), file_size_(file_size) {}

    std::string doubt()
    {
        std::uint32_t version = 0;
        std::uint32_t number = 0;
        if (!read(number) || !read(version) || number != magic) {
            return "it is no OpenEXR file";
        }
        if ((version & ~long_names) != version_2_of_parts) {
            return "it is not an OpenEXR file of flat parts";
        }
        std::uint64_t tables = 0;
        while (at_ < bytes_.size() && bytes_[at_] != '\0') {
            if (const std::string doubt = of_part(tables); !doubt.empty()) {
                return doubt;
            }
        }
        return at_ < bytes_.size() ? "" : "its headers do not end";
    }

private:
    template <typename Value>
    bool read(Value& value)
    {
        if (bytes_.size() - at_ < sizeof value) {
            return false;
        }
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return true;
    }

    // Up to a zero, which is skipped.
    bool read(std::string& name)
    {
        const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
        const auto end = std::find(begin, bytes_.end(), '\0');
        name.assign(begin, end);
        at_ += name.size() + 1;
        return end != bytes_.end() && name.size() <= longest_name;
    }

    // Names of at least one character, each with its type, a flag, three bytes and two steps between samples; then a zero.
    static bool are_channels(const char* at, const char* end)
    {
        while (at < end && *at != '\0') {
            at = std::find(at, end, '\0');
            std::int32_t numbers[4];
            if (end - at < static_cast<std::ptrdiff_t>(1 + sizeof numbers)) {
                return false;
            }
            std::memcpy(numbers, at + 1, sizeof numbers);
            at += 1 + sizeof numbers;
            if (numbers[0] < 0 || numbers[0] > 2 || numbers[2] != 1 || numbers[3] != 1) {
                return false;
            }
        }
        return end - at == 1;
    }

    // tables: bytes of the tables of chunks, of all parts so far.
    std::string of_part(std::uint64_t& tables)
    {
        std::int64_t lines = 0;
        int lines_of_chunk = 1;
        while (at_ < bytes_.size() && bytes_[at_] != '\0') {
            std::string name;
            std::string type;
            std::int32_t size = 0;
            if (!read(name) || !read(type) || !read(size)) {
                return "an attribute is cut off";
            }
            const auto known = sizes_of_types.find(type);
            if (known == sizes_of_types.end()) {
                return "its attribute " + name + " has the unknown type " + type;
            }
            if (size < 0 || static_cast<std::size_t>(size) > bytes_.size() - at_ ||
                (known->second != any_size && size != known->second)) {
                return "its attribute " + name + " has the wrong size";
            }
            const char* const value = bytes_.data() + at_;
            // OpenEXR reads channels to their own end, wherever that is.
            if (type == "chlist" && !are_channels(value, value + size)) {
                return "its channels make no sense";
            }
            at_ += static_cast<std::size_t>(size);
            if (name == "type" && std::string(value, static_cast<std::size_t>(size)) != "scanlineimage") {
                return "a part is not of scan lines";
            }
            if (type == "compression") {
                if (*value < 0 || *value > last_simple_compression) {
                    return "a part is compressed as no map is";
                }
                lines_of_chunk = *value == last_simple_compression ? 16 : 1;
            }
            if (name == "dataWindow" && type == "box2i") {
                std::int32_t corners[4];
                std::memcpy(corners, value, sizeof corners);
                lines = std::int64_t(corners[3]) - corners[1] + 1;
                if (lines < 1 || corners[0] > corners[2] || lines > std::numeric_limits<std::int32_t>::max()) {
                    return "a part has no lines";
                }
            }
            if (name == "chunkCount" && type == "int") {
                std::int32_t count = 0;
                std::memcpy(&count, value, sizeof count);
                if (count < 1 || static_cast<std::uint64_t>(count) > file_size_ / 8) {
                    return "it promises more data than it can hold";
                }
            }
        }
        at_ += 1;
        tables += 8 * static_cast<std::uint64_t>((lines + lines_of_chunk - 1) / lines_of_chunk);
        return tables > file_size_ ? "it promises more data than it can hold" : "";
    }

    std::vector<char> bytes_;
    std::uint64_t file_size_;
    std::size_t at_ = 0;
};

}  // namespace

std::string doubt_about_headers(Imf::IStream& stream, std::uint64_t size)
{
    std::vector<char> bytes(std::min(size, largest_headers));
    stream.seekg(0);
    if (!bytes.empty()) {
        stream.read(bytes.data(), static_cast<int>(bytes.size()));
    }
    stream.seekg(0);
    return Headers(std::move(bytes), size).doubt();
}

}  // namespace mesoshell::store

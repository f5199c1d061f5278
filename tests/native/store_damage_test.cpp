// Files that are no maps, or no longer: refused in a sentence, never a crash, never a changed number, never gigabytes.
#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>

#include <sys/resource.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "files.h"
#include "mesoshell/error.h"
#include "mesoshell/store.h"

namespace mesoshell {
namespace {

enum class Outcome { refused, loaded };

// Refused with Error or FileError, or loaded with every number as it was saved.
Outcome load_damaged(const std::string& path, const Map& truth)
{
    try {
        expect_same_map(load_map(path), truth);
        return Outcome::loaded;
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    } catch (const FileError&) {
    }
    return Outcome::refused;
}

void expect_no_map(const std::string& path)
{
    expect_refusal<Error>([&] { load_map(path); }, {path.c_str(), "not a usable map"});
}

TEST(StoreDamage, Truncated)
{
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        const Map map = map_with_all_parts(precision);
        save_map(map, folder.file("whole.exr"));
        const std::string bytes = read_bytes(folder.file("whole.exr"));
        for (std::size_t i = 0; i < 50; ++i) {
            write_bytes(folder.file("part.exr"), bytes.substr(0, bytes.size() * i / 50));
            EXPECT_EQ(load_damaged(folder.file("part.exr"), map), Outcome::refused) << i << " fiftieths";
        }
        write_bytes(folder.file("part.exr"), bytes.substr(0, bytes.size() - 1));
        EXPECT_EQ(load_damaged(folder.file("part.exr"), map), Outcome::refused);
    }
}

TEST(StoreDamage, FlippedBytes)
{
    const TemporaryFolder folder;
    const Map map = map_with_all_parts(Precision::half);
    save_map(map, folder.file("whole.exr"));
    const std::string whole = read_bytes(folder.file("whole.exr"));
    Random random(2);
    int refused = 0;
    for (int i = 0; i < 1200; ++i) {
        std::string bytes = whole;
        char& byte = bytes[static_cast<std::size_t>(random.below(static_cast<int>(whole.size())))];
        byte = static_cast<char>(byte ^ (i % 2 == 0 ? 1 << random.below(8) : 1 + random.below(255)));
        write_bytes(folder.file("flipped.exr"), bytes);
        refused += load_damaged(folder.file("flipped.exr"), map) == Outcome::refused ? 1 : 0;
    }
    EXPECT_GT(refused, 600);
}

TEST(StoreDamage, EveryByteOfTheHeaders)
{
    const TemporaryFolder folder;
    const Map map = small_map(Precision::half, false);
    save_map(map, folder.file("whole.exr"));
    const std::string whole = read_bytes(folder.file("whole.exr"));
    // The headers come first; they hold the settings that no checksum of pixels covers.
    const std::size_t headers = whole.rfind("mesoshell:version") + 32;
    ASSERT_LT(headers, whole.size());
    for (std::size_t i = 0; i < headers; ++i) {
        std::string bytes = whole;
        bytes[i] = static_cast<char>(bytes[i] ^ 1);
        write_bytes(folder.file("flipped.exr"), bytes);
        load_damaged(folder.file("flipped.exr"), map);
        ASSERT_FALSE(HasFailure()) << "byte " << i << " of the headers, near '" << whole.substr(i > 24 ? i - 24 : 0, 40)
                                   << "'";
    }
}

// The bytes of a small map with those behind every place of `name` replaced.
std::string patched(const std::string& name, const std::string& bytes)
{
    const TemporaryFolder folder;
    save_map(small_map(Precision::half, true), folder.file("whole.exr"));
    std::string whole = read_bytes(folder.file("whole.exr"));
    std::size_t count = 0;
    for (std::size_t at = whole.find(name); at != std::string::npos; at = whole.find(name, at + 1), ++count) {
        whole.replace(at + name.size(), bytes.size(), bytes);
    }
    EXPECT_GE(count, 3u) << name;
    return whole;
}

TEST(StoreDamage, HeadersThatOpenExrWouldBelieve)
{
    using namespace std::string_literals;
    const TemporaryFolder folder;
    const auto expect_doubt = [&](const std::string& bytes, const char* words) {
        write_bytes(folder.file("lie.exr"), bytes);
        expect_refusal<Error>([&] { load_map(folder.file("lie.exr")); }, {"not a usable map", words});
    };
    // Attributes of half a gigabyte and more, for which OpenEXR takes memory at once; and of less than nothing.
    for (const std::string& size : {"\0\0\0\x20"s, "\xFF\xFF\xFF\x7F"s, "\xFF\xFF\xFF\xFF"s}) {
        expect_doubt(patched("mesoshell:units\0string\0"s, size), "wrong size");
        expect_doubt(patched("channels\0chlist\0"s, size), "wrong size");
    }
    expect_doubt(patched("mesoshell:height\0float\0"s, "\5\0\0\0"s), "wrong size");
    expect_doubt(patched("mesoshell:units\0"s, "strong"s), "unknown type");
    // Channels without an end, which OpenEXR looks for in what follows.
    expect_doubt(patched("channels\0chlist\0"s, "\x12\0\0\0Y\0\1\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0\7"s), "channels");
    expect_doubt(patched("compression\0compression\0\1\0\0\0"s, "\4"s), "compressed as no map is");
    expect_doubt(patched("type\0string\0\x0D\0\0\0"s, "scanlineimagf"s), "scan lines");
    expect_doubt(patched("chunkCount\0int\0\4\0\0\0"s, "\0\0\0\x20"s), "more data than it can hold");
    expect_doubt(patched("dataWindow\0box2i\0\x10\0\0\0"s, "\0\0\0\0\0\0\0\0\5\0\0\0\0\0\0\x70"s),
                 "more data than it can hold");
}

TEST(StoreDamage, MissingFile)
{
    const TemporaryFolder folder;
    try {
        load_map(folder.file("missing.exr"));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.code, ENOENT);
        EXPECT_EQ(error.path, folder.file("missing.exr"));
    }
}

TEST(StoreDamage, FileBelowAFile)
{
    const TemporaryFolder folder;
    write_bytes(folder.file("plain"), "text");
    try {
        load_map(folder.file("plain/tile.exr"));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.code, ENOTDIR);
    }
}

TEST(StoreDamage, Folder)
{
    const TemporaryFolder folder;
    try {
        load_map(folder.file(""));
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.code, EISDIR);
    } catch (const Error&) {
    }
}

TEST(StoreDamage, EmptyFile)
{
    const TemporaryFolder folder;
    write_bytes(folder.file("empty.exr"), "");
    expect_no_map(folder.file("empty.exr"));
}

TEST(StoreDamage, TextFile)
{
    const TemporaryFolder folder;
    write_bytes(folder.file("text.exr"), "Mesoshell bakes mesostructure.\n");
    expect_no_map(folder.file("text.exr"));
    std::string magic = "\x76\x2f\x31\x01";
    write_bytes(folder.file("magic.exr"), magic);
    expect_no_map(folder.file("magic.exr"));
    write_bytes(folder.file("magic.exr"), magic + std::string(5000, '\xff'));
    expect_no_map(folder.file("magic.exr"));
}

TEST(StoreDamage, ForeignPicture)
{
    const TemporaryFolder folder;
    Imf::Header header(8, 4);
    for (const char* channel : {"R", "G", "B", "Y"}) {
        header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    }
    const std::vector<float> pixels(32, 0.5f);
    Imf::FrameBuffer buffer;
    for (const char* channel : {"R", "G", "B", "Y"}) {
        char* base = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
        buffer.insert(channel, Imf::Slice(Imf::FLOAT, base, sizeof(float), 8 * sizeof(float)));
    }
    {
        Imf::OutputFile file(folder.file("foreign.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(4);
    }
    expect_no_map(folder.file("foreign.exr"));
}

// Parts with a map's names and attributes, each as `change` leaves it; without pixels unless `pixels`.
void write_parts(const std::string& path, int width, int height, bool pixels,
                 const std::function<void(Imf::Header&, int part)>& change, const std::string& without = "")
{
    std::vector<Imf::Header> headers;
    for (int part = 0; part < 2; ++part) {
        Imf::Header header(width, height);
        header.setName(part == 0 ? "gdm.weights" : "gdm.eigenmaps");
        header.setType(Imf::SCANLINEIMAGE);
        header.compression() = Imf::ZIP_COMPRESSION;
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        // Left out from the start: what Header::erase takes out is never freed.
        const auto insert = [&](const char* name, const Imf::Attribute& attribute) {
            if (name != without) {
                header.insert(name, attribute);
            }
        };
        insert("mesoshell:version", Imf::IntAttribute(1));
        insert("mesoshell:shape", Imf::StringAttribute("1 1 " + std::to_string(height) + " " + std::to_string(width)));
        insert("mesoshell:checksum", Imf::StringAttribute("0123456789abcdef"));
        insert("mesoshell:units", Imf::StringAttribute("tile widths"));
        for (const char* name : {"mesoshell:height", "mesoshell:aspect", "mesoshell:rmse", "mesoshell:maxError"}) {
            insert(name, Imf::FloatAttribute(0.5f));
        }
        change(header, part);
        headers.push_back(header);
    }
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
    if (pixels) {
        std::vector<float> values(static_cast<std::size_t>(width) * height, 0.25f);
        for (int part = 0; part < 2; ++part) {
            Imf::FrameBuffer buffer;
            const char* channel = headers[static_cast<std::size_t>(part)].channels().begin().name();
            buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                              sizeof(float) * static_cast<std::size_t>(width)));
            Imf::OutputPart output(file, part);
            output.setFrameBuffer(buffer);
            output.writePixels(height);
        }
    }
}

std::size_t peak_bytes()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

TEST(StoreDamage, ChecksumThatDoesNotFit)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    write_parts(path, 4, 4, true, [](Imf::Header&, int) {});
    expect_refusal<Error>([&] { load_map(path); }, {"gdm.weights", "checksum"});
}

TEST(StoreDamage, ShapesThatLie)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    for (const char* shape :
         {"1 1 4 5", "1 1 5 4", "2 1 4 4", "1 1 4", "", "1 1 4 4 1", "1 1 4 4x", "0 1 4 4", "1 -1 4 -4", "-1 -1 -4 -4",
          "1000000 1000000 1000 1000", "2147483647 2147483647 2147483647 2147483647", "99999999999999999999 1 4 4",
          "nan nan nan nan", "1 65536 4 65536"}) {
        for (int liar = 0; liar < 2; ++liar) {
            write_parts(path, 4, 4, true, [&](Imf::Header& header, int part) {
                if (part == liar) {
                    header.insert("mesoshell:shape", Imf::StringAttribute(shape));
                }
            });
            expect_refusal<Error>([&] { load_map(path); }, {"not a usable map", "shape"});
        }
    }
}

TEST(StoreDamage, PromisesOfGigabytes)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    const std::size_t before = peak_bytes();
    for (const glm::ivec2 size : {glm::ivec2(40000, 40000), {2000000, 1000}, {1000, 2000000}}) {
        write_parts(path, size.x, size.y, false, [](Imf::Header&, int) {});
        EXPECT_LT(std::filesystem::file_size(path), 4000000u);
        expect_refusal<Error>([&] { load_map(path); }, {"not a usable map"});
    }
    // The picture itself would take 6 GB; its table of lines some megabytes.
    EXPECT_LT(peak_bytes() - before, 200u << 20);
}

TEST(StoreDamage, AttributesThatAreMissingOrOfAnotherType)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    for (const char* name : {"mesoshell:version", "mesoshell:shape", "mesoshell:checksum", "mesoshell:height",
                             "mesoshell:aspect", "mesoshell:rmse", "mesoshell:maxError"}) {
        write_parts(path, 4, 4, true, [](Imf::Header&, int) {}, name);
        expect_refusal<Error>([&] { load_map(path); }, {"not a usable map", name});
        write_parts(path, 4, 4, true, [&](Imf::Header& header, int) {
            if (std::strcmp(name, "mesoshell:version") == 0) {
                header.insert(name, Imf::FloatAttribute(1.0f));
            } else {
                header.insert(name, Imf::IntAttribute(1));
            }
        }, name);
        expect_refusal<Error>([&] { load_map(path); }, {"not a usable map", name});
    }
}

TEST(StoreDamage, SettingsThatMakeNoSense)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    for (const char* name : {"mesoshell:height", "mesoshell:aspect"}) {
        for (const float bad :
             {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            write_parts(path, 4, 4, true,
                        [&](Imf::Header& header, int) { header.insert(name, Imf::FloatAttribute(bad)); });
            expect_refusal<Error>([&] { load_map(path); }, {"height or aspect"});
        }
    }
    for (const int version : {0, 4, -1}) {
        write_parts(path, 4, 4, true,
                    [&](Imf::Header& header, int) { header.insert("mesoshell:version", Imf::IntAttribute(version)); });
        expect_refusal<Error>([&] { load_map(path); }, {"format version", std::to_string(version).c_str()});
    }
}

TEST(StoreDamage, ValuesThatAreNotFinite)
{
    const TemporaryFolder folder;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (int i = 0; i < 6; ++i) {
            Map map = map_with_all_parts(Precision::single);
            std::vector<float>* const arrays[6] = {&map.weights,          &map.eigenmaps,          &map.sdf,
                                                   &map.attributes.color, &map.attributes.surface, &map.attributes.normal};
            arrays[i]->back() = bad;
            save_map(map, folder.file("tile.exr"));
            expect_refusal<Error>([&] { load_map(folder.file("tile.exr")); }, {"not a usable map", "not finite"});
        }
    }
}

// Whole files, whose checksums are right, of facets that no bake makes.
TEST(StoreDamage, FacetsThatMakeNoSense)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    Map map = map_with_all_parts(Precision::half);
    const auto refuse = [&](const Facets& facets, const char* words) {
        map.facets = facets;
        save_map(map, path);
        expect_refusal<Error>([&] { load_map(path); }, {"facets", words});
    };
    const Facets good = map.facets;
    const std::size_t layer = std::size_t(4) * good.cells.x * good.cells.y;
    Facets bad = good;
    bad.texels.resize(layer * (good.cells.z - 1));  // not a texel for each cell
    refuse(bad, "cells");
    bad = good;
    bad.cells.y += 1;
    bad.texels.resize(std::size_t(4) * bad.cells.x * bad.cells.y * bad.cells.z);
    refuse(bad, "cells");
    // A cell that is split, of which the first part would be the texel behind the last: signs 0101, the bit of one part.
    bad = good;
    const auto count = static_cast<std::uint32_t>(good.texel_count());
    bad.texels[0] = std::bit_cast<float>(1u << 29 | 1u | count << 16);
    bad.texels[1] = std::bit_cast<float>(1u << 31 | 1u << 29);
    bad.texels[2] = std::bit_cast<float>(1u << 29);
    bad.texels[3] = std::bit_cast<float>(1u << 31 | 1u << 29);
    refuse(bad, "parts");
    bad.texels[0] = std::bit_cast<float>(1u << 29 | 1u | (count - 1) << 16);
    map.facets = bad;
    save_map(map, path);
    EXPECT_EQ(load_map(path).facets.texels, bad.texels);
}

// The file's bytes with the name of a part changed in its header to one as long.
std::string with_part_renamed(std::string bytes, const std::string& name, const std::string& other)
{
    std::string attribute("name\0string\0", 12);
    attribute += std::string{static_cast<char>(name.size()), '\0', '\0', '\0'};
    const std::size_t at = bytes.find(attribute + name);
    if (at == std::string::npos) {
        throw std::runtime_error("no part " + name);
    }
    return bytes.replace(at + attribute.size(), name.size(), other);
}

TEST(StoreDamage, PartsWithAnotherName)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    save_map(map_with_all_parts(Precision::half), path);
    const std::string whole = read_bytes(path);
    for (const std::string name : {"gdm.weights", "gdm.eigenmaps", "sdf", "facets", "color", "surface", "normal"}) {
        std::string other = name;
        other.back() = 'X';
        write_bytes(path, with_part_renamed(whole, name, other));
        expect_refusal<Error>([&] { load_map(path); }, {"not a usable map", other.c_str()});
    }
}

TEST(StoreDamage, AttributesThatAreNotAllThere)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    Map map = map_with_all_parts(Precision::half);
    map.facets = {};
    save_map(map, path);
    const std::string whole = read_bytes(path);
    // "color" goes by the name of a part that this map does not have.
    write_bytes(path, with_part_renamed(whole, "color", "leaps"));
    expect_refusal<Error>([&] { load_map(path); }, {"only some of the parts"});
}

TEST(StoreDamage, PartsThatAreMissingOrHaveOtherChannels)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    write_parts(path, 4, 4, true,
                [](Imf::Header& header, int part) { header.setName(part == 0 ? "gdm.weights" : "sdf"); });
    expect_refusal<Error>([&] { load_map(path); }, {"gdm.eigenmaps"});
    write_parts(path, 4, 4, true, [](Imf::Header& header, int) {
        header.channels() = Imf::ChannelList();
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    });
    expect_refusal<Error>([&] { load_map(path); }, {"channel Y"});
    write_parts(path, 4, 4, true, [](Imf::Header& header, int part) {
        header.insert("mesoshell:shape", Imf::StringAttribute(part == 0 ? "2 1 2 4" : "1 1 4 4"));
    });
    expect_refusal<Error>([&] { load_map(path); }, {"belong together"});
}

}  // namespace
}  // namespace mesoshell

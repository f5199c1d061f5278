// Saving and loading: bit-equal, and all or nothing.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Imath/ImathBox.h>
#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "files.h"
#include "mesoshell/error.h"
#include "mesoshell/store.h"
#include "meshes.h"

namespace mesoshell {
namespace {

TEST(Store, LoadsWhatWasSaved)
{
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        for (const bool with_sdf : {true, false}) {
            const Map map = small_map(precision, with_sdf);
            save_map(map, folder.file("tile.exr"));
            expect_same_map(load_map(folder.file("tile.exr")), map);
        }
    }
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
}

TEST(Store, LoadsABakedMap)
{
    GdmResolution r;
    r.nodes = glm::ivec3(5, 6, 4);
    r.ntheta = 4;
    r.nphi = 3;
    Job job;
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 8, 12).sample(0.6f, 1.2f);
    const Gdm gdm = bake_gdm(sample, r, job);
    const Sdf sdf = bake_sdf(sample, {8, 8, 5}, job);
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        CompressOptions options;
        options.terms = 5;
        options.precision = precision;
        const Map map = compress(gdm, &sdf, options, job);
        save_map(map, folder.file("tile.exr"));
        expect_same_map(load_map(folder.file("tile.exr")), map);
    }
}

TEST(Store, LoadsAllPartsThatWereSaved)
{
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        const Map map = map_with_all_parts(precision);
        save_map(map, folder.file("tile.exr"));
        expect_same_map(load_map(folder.file("tile.exr")), map);
        // Facets without attributes, and the other way round.
        Map other = map;
        other.attributes = {};
        save_map(other, folder.file("tile.exr"));
        expect_same_map(load_map(folder.file("tile.exr")), other);
        other = map;
        other.facets = {};
        save_map(other, folder.file("tile.exr"));
        expect_same_map(load_map(folder.file("tile.exr")), other);
    }
}

TEST(Store, LoadsBakedFacets)
{
    Job job;
    const Sample sample = sphere({0.5f, 0.5f, 0.3f}, 0.25f, 8, 12).sample(0.61f, 1.37f);
    const Facets facets = bake_facets(sample, 9, job);
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        Map map = small_map(precision, true);
        map.height = facets.height;
        map.aspect = facets.aspect;
        attach(map, &facets, nullptr);
        save_map(map, folder.file("tile.exr"));
        EXPECT_EQ(load_map(folder.file("tile.exr")).facets.texels, facets.texels);
    }
}

TEST(Store, AttachedAttributesHaveThePrecisionOfTheMap)
{
    Attributes attributes = map_with_all_parts(Precision::single).attributes;
    attributes.color[0] = 1.0f / 3.0f;
    Map half = small_map(Precision::half, true);
    attach(half, nullptr, &attributes);
    EXPECT_EQ(half.attributes.color[0], 0.333251953125f);
    Map single = small_map(Precision::single, true);
    attach(single, nullptr, &attributes);
    EXPECT_EQ(single.attributes.color, attributes.color);
    const TemporaryFolder folder;
    save_map(half, folder.file("tile.exr"));
    expect_same_map(load_map(folder.file("tile.exr")), half);
}

TEST(Store, AttachRefusesWhatDoesNotBelongToTheMap)
{
    const Map all = map_with_all_parts(Precision::half);
    Facets facets = all.facets;
    facets.height *= 2.0f;
    Map map = small_map(Precision::half, true);
    expect_refusal<InvalidArgument>([&] { attach(map, &facets, nullptr); }, {"facets", "one sample"});
    for (int i = 0; i < 3; ++i) {
        for (const float bad : {1e6f, std::numeric_limits<float>::quiet_NaN()}) {
            Attributes attributes = all.attributes;
            std::vector<float>* const arrays[3] = {&attributes.color, &attributes.surface, &attributes.normal};
            arrays[i]->back() = bad;
            expect_refusal<InvalidArgument>([&] { attach(map, nullptr, &attributes); }, {"not finite"});
            arrays[i]->pop_back();
            expect_refusal<InvalidArgument>([&] { attach(map, nullptr, &attributes); }, {"values"});
        }
    }
    Attributes attributes = all.attributes;
    attributes.nodes.z = 1;
    expect_refusal<InvalidArgument>([&] { attach(map, nullptr, &attributes); }, {"2 nodes"});
    EXPECT_TRUE(map.facets.texels.empty());
    EXPECT_TRUE(map.attributes.color.empty());
}

TEST(Store, ExtremeValuesSurvive)
{
    const TemporaryFolder folder;
    Map map = small_map(Precision::single, false);
    map.weights[0] = -0.0f;
    map.weights[1] = 0x1p-149f;
    map.weights[2] = 3.0e38f;
    save_map(map, folder.file("tile.exr"));
    const Map loaded = load_map(folder.file("tile.exr"));
    EXPECT_EQ(loaded.weights, map.weights);
    EXPECT_TRUE(std::signbit(loaded.weights[0]));
    Map half = small_map(Precision::half, false);
    half.weights[0] = 65504.0f;
    half.weights[1] = 0x1p-24f;
    save_map(half, folder.file("tile.exr"));
    EXPECT_EQ(load_map(folder.file("tile.exr")).weights, half.weights);
}

TEST(Store, ReplacesAnOldFile)
{
    const TemporaryFolder folder;
    save_map(small_map(Precision::half, true, 1), folder.file("tile.exr"));
    const Map other = small_map(Precision::single, false, 2);
    save_map(other, folder.file("tile.exr"));
    expect_same_map(load_map(folder.file("tile.exr")), other);
    EXPECT_EQ(folder.content().size(), 1u);
}

TEST(Store, FileOfVersionOne)
{
    // Such a file has the same parts and attributes, and 1 for its version.
    const TemporaryFolder folder;
    const Map map = small_map(Precision::half, true);
    save_map(map, folder.file("tile.exr"));
    std::string bytes = read_bytes(folder.file("tile.exr"));
    const std::string name("mesoshell:version\0int\0\4\0\0\0", 26);
    int found = 0;
    for (std::size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1), ++found) {
        ASSERT_EQ(bytes[at + name.size()], 3);
        bytes[at + name.size()] = 1;
    }
    EXPECT_EQ(found, 3);
    write_bytes(folder.file("tile.exr"), bytes);
    expect_same_map(load_map(folder.file("tile.exr")), map);
}

// Adds a part to a file, and makes all its parts such of version 2.
void add_leaps(const std::string& path, const std::string& to)
{
    Imf::MultiPartInputFile file(path.c_str());
    std::vector<Imf::Header> headers;
    for (int part = 0; part < file.parts(); ++part) {
        headers.push_back(file.header(part));
    }
    // [16, 3, 3, 4]: 4 x 4 directions of 4 x 3 x 3 cells, a picture of 12 x 48.
    Imf::Header leaps(headers[0].displayWindow(), Imath::Box2i({0, 0}, {11, 47}));
    leaps.setName("leaps");
    leaps.setType(Imf::SCANLINEIMAGE);
    leaps.compression() = Imf::ZIP_COMPRESSION;
    leaps.channels().insert("Y", Imf::Channel(Imf::HALF));
    leaps.insert("mesoshell:shape", Imf::StringAttribute("16 3 3 4"));
    leaps.insert("mesoshell:checksum", Imf::StringAttribute("0123456789abcdef"));
    leaps.insert("mesoshell:units", Imf::StringAttribute("tile widths"));
    headers.insert(headers.begin() + 3, leaps);
    for (Imf::Header& header : headers) {
        header.insert("mesoshell:version", Imf::IntAttribute(2));
    }
    Imf::MultiPartOutputFile copy(to.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (int part = 0; part < copy.parts(); ++part) {
        Imf::OutputPart output(copy, part);
        if (part != 3) {
            Imf::InputPart input(file, part < 3 ? part : part - 1);
            output.copyPixels(input);
            continue;
        }
        const std::vector<half> values(12 * 48, half(0.25f));
        char* const base = const_cast<char*>(reinterpret_cast<const char*>(values.data()));
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice(Imf::HALF, base, sizeof(half), 12 * sizeof(half)));
        output.setFrameBuffer(buffer);
        output.writePixels(48);
    }
}

TEST(Store, FileOfVersionTwoWithLeaps)
{
    // Such a file has a table of leaps, which nothing uses, between the distance field and the attributes, and no facets.
    const TemporaryFolder folder;
    for (const Precision precision : {Precision::half, Precision::single}) {
        Map map = map_with_all_parts(precision);
        map.facets = {};
        save_map(map, folder.file("plain.exr"));
        add_leaps(folder.file("plain.exr"), folder.file("leaps.exr"));
        const std::string bytes = read_bytes(folder.file("leaps.exr"));
        ASSERT_NE(bytes.find("leaps"), std::string::npos);
        const Map loaded = load_map(folder.file("leaps.exr"));
        expect_same_map(loaded, map);
        // Saved again it is a file of this version.
        save_map(loaded, folder.file("again.exr"));
        EXPECT_EQ(read_bytes(folder.file("again.exr")), read_bytes(folder.file("plain.exr")));
    }
}

TEST(Store, SavingTwiceGivesTheSameBytes)
{
    const TemporaryFolder folder;
    save_map(map_with_all_parts(Precision::half), folder.file("a.exr"));
    save_map(map_with_all_parts(Precision::half), folder.file("b.exr"));
    EXPECT_EQ(read_bytes(folder.file("a.exr")), read_bytes(folder.file("b.exr")));
}

void expect_file_error(const std::string& path, int code)
{
    try {
        save_map(small_map(Precision::half, true), path);
        ADD_FAILURE() << "saved to " << path;
    } catch (const FileError& error) {
        EXPECT_EQ(error.code, code) << path;
        EXPECT_EQ(error.path, path);
    }
}

TEST(Store, FolderThatIsMissing)
{
    const TemporaryFolder folder;
    expect_file_error(folder.file("missing/tile.exr"), ENOENT);
    EXPECT_TRUE(folder.content().empty());
}

TEST(Store, FolderThatIsAFile)
{
    const TemporaryFolder folder;
    write_bytes(folder.file("plain"), "text");
    expect_file_error(folder.file("plain/tile.exr"), ENOTDIR);
    EXPECT_EQ(read_bytes(folder.file("plain")), "text");
    EXPECT_EQ(folder.content().size(), 1u);
}

TEST(Store, TargetThatIsAFolder)
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.file("tile.exr"));
    expect_file_error(folder.file("tile.exr"), EISDIR);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
}

TEST(Store, FolderThatMayNotBeWritten)
{
    const TemporaryFolder folder;
    const uid_t user = geteuid();
    if (user == 0) {
        // Root may write everywhere, so be nobody for a moment: the folder is root's alone.
        if (seteuid(65534) != 0) {
            GTEST_SKIP() << "this process is root and cannot be anyone else";
        }
        expect_file_error(folder.file("tile.exr"), EACCES);
        ASSERT_EQ(seteuid(user), 0);
    } else {
        std::filesystem::permissions(folder.file(""),
                                     std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
        expect_file_error(folder.file("tile.exr"), EACCES);
        std::filesystem::permissions(folder.file(""), std::filesystem::perms::owner_all);
    }
    EXPECT_TRUE(folder.content().empty());
}

// While it lives, no file of this process grows beyond `bytes`: what a full disk does, with EFBIG for ENOSPC.
class FileSizeLimit {
public:
    explicit FileSizeLimit(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN))
    {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit()
    {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    void (*handler_)(int);
    rlimit before_{};
};

void check_full_disk(const Map& map)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    save_map(map, path);
    const std::size_t size = read_bytes(path).size();
    save_map(small_map(Precision::single, false, 9), path);
    const std::string old = read_bytes(path);
    // Full at the first byte, at the last, and anywhere between.
    std::vector<std::size_t> limits{0, 1, size - 1};
    for (std::size_t i = 1; i < 20; ++i) {
        limits.push_back(size * i / 20);
    }
    for (const std::size_t limit : limits) {
        int code = 0;
        {
            const FileSizeLimit full(limit);
            try {
                save_map(map, path);
            } catch (const FileError& error) {
                code = error.code;
                EXPECT_EQ(error.path, path);
            }
        }
        EXPECT_EQ(code, EFBIG) << "a disk full after " << limit << " of " << size << " bytes";
        EXPECT_TRUE(read_bytes(path) == old) << "a disk full after " << limit << " of " << size << " bytes";
        EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
    }
    save_map(map, path);
    expect_same_map(load_map(path), map);
}

TEST(Store, FullDiskLeavesTheOldFile)
{
    check_full_disk(map_with_all_parts(Precision::half));
}

TEST(Store, FullDiskLeavesTheOldFileOfALargerMap)
{
    Random random(4);
    Map map = small_map(Precision::single, false);
    map.resolution.nodes = glm::ivec3(40, 30, 4);
    map.weights.resize(2 * 7 * 30 * 40);
    for (float& value : map.weights) {
        value = static_cast<float>(random.uniform(-1.0, 1.0));
    }
    check_full_disk(map);
}

TEST(Store, ArraysThatDoNotFitTheNodes)
{
    const TemporaryFolder folder;
    for (int i = 0; i < 6; ++i) {
        Map map = map_with_all_parts(Precision::half);
        std::vector<float>* const arrays[6] = {&map.weights,          &map.eigenmaps,          &map.sdf,
                                               &map.attributes.color, &map.attributes.surface, &map.attributes.normal};
        arrays[i]->pop_back();
        expect_refusal<InvalidArgument>([&] { save_map(map, folder.file("tile.exr")); }, {"values"});
    }
    Map map = map_with_all_parts(Precision::half);
    map.facets.texels.pop_back();
    expect_refusal<InvalidArgument>([&] { save_map(map, folder.file("tile.exr")); }, {"facets", "values"});
    expect_refusal<InvalidArgument>([&] { save_map(Map{}, folder.file("tile.exr")); }, {"values"});
    EXPECT_TRUE(folder.content().empty());
}

TEST(Store, TwoSaversToOnePathLeaveAWholeFile)
{
    const TemporaryFolder folder;
    const Map map = small_map(Precision::single, true);
    std::vector<std::thread> savers;
    for (int i = 0; i < 4; ++i) {
        savers.emplace_back([&] {
            for (int round = 0; round < 25; ++round) {
                save_map(map, folder.file("tile.exr"));
                load_map(folder.file("tile.exr"));
            }
        });
    }
    for (std::thread& saver : savers) {
        saver.join();
    }
    expect_same_map(load_map(folder.file("tile.exr")), map);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
}

TEST(Store, LinkStaysALink)
{
    const TemporaryFolder folder;
    const Map map = small_map(Precision::single, true);
    save_map(map, folder.file("kept.exr"));
    std::filesystem::create_symlink("kept.exr", folder.file("link.exr"));
    Map other = map;
    other.weights[0] += 1.0f;
    save_map(other, folder.file("link.exr"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.exr")));
    expect_same_map(load_map(folder.file("kept.exr")), other);
}

}  // namespace
}  // namespace mesoshell

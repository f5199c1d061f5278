// Every layout and precision of a compressed GDM: as good as Eckart and Young allow, honest about its error, and the same
// whatever the threads and the memory.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <Eigen/Dense>

#include "check.h"
#include "gdm_source.h"
#include "gram.h"
#include "mesoshell/compress.h"
#include "meshes.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr Layout all_layouts[] = {Layout::paper, Layout::share, Layout::nodes};
constexpr Precision all_precisions[] = {Precision::byte, Precision::half, Precision::single};

// Some balls on 11 x 9 x 16 nodes and 8 x 6 directions: 128 columns, enough for the eigenvectors to be found by iteration.
class CompressLayouts : public testing::Test {
protected:
    static constexpr int nodes = 11 * 9;
    static constexpr int columns = 8 * 16;
    static constexpr int azimuths = 6;
    static constexpr double count = double(nodes) * columns * azimuths;

    static void SetUpTestSuite()
    {
        resolution.nodes = glm::ivec3(11, 9, 16);
        resolution.ntheta = 8;
        resolution.nphi = azimuths;
        Random random(3);
        Mesh balls;
        for (int i = 0; i < 6; ++i) {
            const glm::vec3 center(random.in_box({0.0, 0.0, 0.1}, {1.0, 0.8, 0.5}));
            balls = merged(balls, sphere(center, static_cast<float>(random.uniform(0.05, 0.2)), 8, 12));
        }
        sample = std::make_unique<Sample>(balls.sample(0.6f, 0.8f));
        Job job;
        gdm = bake_gdm(*sample, resolution, job);
    }

    static void TearDownTestSuite() { sample.reset(); }

    // Rows and columns as the layout has them; columns of `share` as it weighs them.
    static Eigen::MatrixXd raw(Layout layout)
    {
        const bool by_nodes = layout == Layout::nodes;
        Eigen::MatrixXd matrix(by_nodes ? nodes : azimuths * nodes, by_nodes ? azimuths * columns : columns);
        for (int phi = 0; phi < azimuths; ++phi) {
            for (int node = 0; node < nodes; ++node) {
                for (int column = 0; column < columns; ++column) {
                    const double value = gdm.values[(std::size_t(phi) * nodes + node) * columns + column];
                    const double weight = layout == Layout::share && exit_of(column) > 0.0 ? 1.0 / std::sqrt(exit_of(column)) : 1.0;
                    (by_nodes ? matrix(node, phi * columns + column) : matrix(phi * nodes + node, column)) = value * weight;
                }
            }
        }
        return matrix;
    }

    static double exit_of(int column)
    {
        const auto vertical = static_cast<float>(gdm_direction(resolution, column / 16, 0).z);
        return slab_exit(0.6f * static_cast<float>(column % 16) / 15.0f, vertical, 0.6f);
    }

    // Distances as the stored terms have them, [nphi, node, column].
    static std::vector<double> distances(const Map& map)
    {
        const bool by_nodes = map.layout == Layout::nodes;
        std::vector<double> sums(gdm.values.size(), 0.0);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const std::size_t column = i % columns;
            const std::size_t node = i / columns % nodes;
            const std::size_t phi = i / columns / nodes;
            for (std::size_t k = 0; k < std::size_t(map.terms); ++k) {
                const std::size_t weight = by_nodes ? k * nodes + node : (k * azimuths + phi) * nodes + node;
                const std::size_t eigenmap = by_nodes ? (k * azimuths + phi) * columns + column : k * columns + column;
                sums[i] += double(map.weights[weight]) * double(map.eigenmaps[eigenmap]);
            }
            sums[i] *= map.layout == Layout::share ? exit_of(static_cast<int>(column)) : 1.0;
        }
        return sums;
    }

    static Map compressed(Layout layout, Precision precision, int terms, int threads = 0, float max_rmse = 0.0f)
    {
        Job job(threads);
        return compress(gdm, nullptr, options(layout, precision, terms, max_rmse), job);
    }

    static CompressOptions options(Layout layout, Precision precision, int terms, float max_rmse = 0.0f)
    {
        CompressOptions options;
        options.layout = layout;
        options.precision = precision;
        options.terms = terms;
        options.max_rmse = max_rmse;
        return options;
    }

    static inline GdmResolution resolution;
    static inline Gdm gdm;
    static inline std::unique_ptr<Sample> sample;
};

TEST_F(CompressLayouts, GramMatrixOfDoubles)
{
    GdmInMemory source(gdm);
    Job job;
    const Eigen::MatrixXd found = gram_matrix(source, job, 0.0f, 1.0f, 0.0f);
    const Eigen::MatrixXd truth = raw(Layout::paper).transpose() * raw(Layout::paper);
    // Single-precision sums over up to 256 rows, of positive numbers.
    EXPECT_LT(((found - truth).array() / (truth.array() + 1e-9)).abs().maxCoeff(), 256 * 0x1p-24);
    EXPECT_GT(truth.minCoeff(), -1e-12);
}

// No terms leave less than Eckart and Young (1936) say; the exact layouts leave hardly more, the iteration a hundredth.
TEST_F(CompressLayouts, EckartYoung)
{
    for (const Layout layout : all_layouts) {
        const Eigen::VectorXd singular = raw(layout).bdcSvd().singularValues();
        for (const int terms : {1, 4, 12}) {
            const Map map = compressed(layout, Precision::single, terms);
            const std::vector<double> found = distances(map);
            double squared = 0.0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                const double exit = exit_of(static_cast<int>(i % columns));
                const double weight = layout == Layout::share ? (exit > 0.0 ? 1.0 / std::sqrt(exit) : 0.0) : 1.0;
                squared += std::pow((found[i] - gdm.values[i]) * weight, 2);
            }
            const double best = singular.tail(singular.size() - terms).squaredNorm();
            EXPECT_GE(squared, best * 0.9999) << static_cast<int>(layout) << " " << terms;
            EXPECT_LE(squared, best * (layout == Layout::nodes ? 1.02 : 1.0005)) << static_cast<int>(layout) << " " << terms;
        }
    }
}

TEST_F(CompressLayouts, ReportedErrorsAreThoseOfTheStoredTerms)
{
    for (const Layout layout : all_layouts) {
        for (const Precision precision : all_precisions) {
            const Map map = compressed(layout, precision, 9);
            EXPECT_EQ(map.layout, layout);
            EXPECT_EQ(map.precision, precision);
            const std::vector<double> found = distances(map);
            double squared = 0.0;
            double largest = 0.0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                squared += std::pow(found[i] - gdm.values[i], 2);
                largest = std::max(largest, std::abs(found[i] - gdm.values[i]));
            }
            EXPECT_NEAR(map.rmse, std::sqrt(squared / count), 1e-5);
            EXPECT_NEAR(map.max_error, largest, 1e-5);
            EXPECT_GT(map.rmse, 1e-3);
        }
    }
}

// A byte's worth of numbers in the larger factor, each within half a step of what it was.
TEST_F(CompressLayouts, BytesAreBytes)
{
    for (const Layout layout : all_layouts) {
        const Map bytes = compressed(layout, Precision::byte, 9);
        const std::vector<float>& larger = layout == Layout::nodes ? bytes.eigenmaps : bytes.weights;
        const std::vector<float>& smaller = layout == Layout::nodes ? bytes.weights : bytes.eigenmaps;
        ASSERT_GT(larger.size(), smaller.size());
        for (std::size_t term = 0; term < 9; ++term) {
            float most = 0.0f;
            for (std::size_t i = 0; i < larger.size() / 9; ++i) {
                const float value = larger[term * (larger.size() / 9) + i];
                ASSERT_EQ(value, std::rint(value));
                most = std::max(most, std::abs(value));
            }
            EXPECT_EQ(most, 127.0f);
        }
        // Rounding errors of 9 terms, independent of one another: half a step of 1 / 127 each at most, a third of that on average.
        const Map exact = compressed(layout, Precision::single, 9);
        EXPECT_GE(bytes.rmse, exact.rmse - 1e-5);
        EXPECT_LT(bytes.rmse - exact.rmse, 0.1 * exact.rmse);
    }
}

TEST_F(CompressLayouts, MaxRmseIsHonored)
{
    for (const Layout layout : all_layouts) {
        for (const Precision precision : {Precision::byte, Precision::single}) {
            for (const float wanted : {0.1f, 0.03f}) {
                const Map map = compressed(layout, precision, 3, 0, wanted);
                EXPECT_LE(map.rmse, wanted);
                ASSERT_GT(map.terms, 1);
                if (layout != Layout::share) {
                    EXPECT_GT(compressed(layout, precision, map.terms - 1).rmse, wanted) << static_cast<int>(layout);
                }
            }
        }
    }
    expect_refusal<InvalidArgument>([&] { compressed(Layout::paper, Precision::byte, 3, 0, 1e-6f); }, {"max_rmse", "precision"});
}

TEST_F(CompressLayouts, ThreadsChangeNoBit)
{
    for (const Layout layout : all_layouts) {
        const Map one = compressed(layout, Precision::single, 9, 1);
        for (const int threads : {2, 5}) {
            const Map more = compressed(layout, Precision::single, 9, threads);
            EXPECT_EQ(one.weights, more.weights);
            EXPECT_EQ(one.eigenmaps, more.eigenmaps);
            EXPECT_EQ(one.rmse, more.rmse);
        }
    }
}

TEST_F(CompressLayouts, BlocksOfAzimuthsGiveTheSameMap)
{
    const CompressOptions wanted = options(Layout::paper, Precision::byte, 9);
    const Map whole = compressed(Layout::paper, Precision::byte, 9);
    const std::vector<double> expected = distances(whole);
    const double azimuth = 4.0 * nodes * columns;
    const double least = plan_bake(resolution, wanted, 1.0).needed;
    for (const auto& [memory, blocks] : {std::pair(least, 6), {least + azimuth, 3}, {least + 2 * azimuth, 2}, {1e9, 1}}) {
        const BakePlan plan = plan_bake(resolution, wanted, memory);
        EXPECT_EQ(plan.blocks, blocks);
        EXPECT_LE(plan.used, memory);
        Job job;
        const Map map = bake_map(*sample, resolution, Engine::automatic, nullptr, wanted, memory, job);
        EXPECT_NEAR(map.rmse, whole.rmse, 1e-6);
        const std::vector<double> found = distances(map);
        double largest = 0.0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            largest = std::max(largest, std::abs(found[i] - expected[i]));
        }
        EXPECT_LT(largest, 0.02);  // two bytes' steps, should one fall on the other side
    }
}

TEST_F(CompressLayouts, TooLittleMemory)
{
    Job job;
    expect_refusal<InvalidArgument>(
        [&] { bake_map(*sample, resolution, Engine::automatic, nullptr, options(Layout::paper, Precision::byte, 9), 1000.0, job); },
        {"MB of memory", "raise the limit"});
    expect_refusal<InvalidArgument>(
        [&] { bake_map(*sample, resolution, Engine::automatic, nullptr, options(Layout::nodes, Precision::byte, 9), 1000.0, job); },
        {"MB of memory", "paper's layout"});
}

TEST_F(CompressLayouts, CancelledAtOnce)
{
    for (const Layout layout : all_layouts) {
        Job job;
        job.cancel();
        EXPECT_THROW(bake_map(*sample, resolution, Engine::automatic, nullptr, options(layout, Precision::byte, 9), 1e9, job),
                     Cancelled);
        EXPECT_THROW(compress(gdm, nullptr, options(layout, Precision::byte, 9), job), Cancelled);
    }
}

TEST_F(CompressLayouts, TermsOfEachLayout)
{
    expect_refusal<InvalidArgument>([&] { compressed(Layout::paper, Precision::half, columns + 1); }, {"terms", "128"});
    expect_refusal<InvalidArgument>([&] { compressed(Layout::nodes, Precision::half, nodes + 1); }, {"terms", "99"});
    const GdmResolution& r = resolution;
    EXPECT_EQ(term_bytes(r, options(Layout::paper, Precision::half, 3)), 2.0 * 3 * (nodes * azimuths + columns));
    EXPECT_EQ(term_bytes(r, options(Layout::paper, Precision::byte, 3)), 3.0 * (nodes * azimuths + 2 * columns));
    EXPECT_EQ(term_bytes(r, options(Layout::nodes, Precision::byte, 3)), 3.0 * (2 * nodes + azimuths * columns));
    EXPECT_EQ(term_bytes(r, options(Layout::nodes, Precision::single, 3)), 4.0 * 3 * (nodes + azimuths * columns));
}

// What is left open: the layout whose errors are smallest, as many terms as the paper's 16 have bytes, textures of 2048 layers.
TEST_F(CompressLayouts, Defaults)
{
    Job job;
    const Map map = compress(gdm, nullptr, CompressOptions{}, job);
    EXPECT_EQ(map.layout, Layout::nodes);
    EXPECT_EQ(map.precision, Precision::byte);
    GdmResolution paper;
    const double bytes = term_bytes(paper, options(Layout::paper, Precision::byte, 16));
    const int terms = default_terms(paper, Layout::nodes, Precision::byte);
    EXPECT_LE(term_bytes(paper, options(Layout::nodes, Precision::byte, terms)), bytes);
    EXPECT_GT(term_bytes(paper, options(Layout::nodes, Precision::byte, terms + 1)), bytes);
    EXPECT_EQ(default_terms(paper, Layout::paper, Precision::half), 16);
    GdmResolution many = paper;
    many.nphi = 200;
    many.nodes = glm::ivec3(256, 256, 32);
    EXPECT_LE(default_terms(many, Layout::nodes, Precision::byte) / 4 * 201, 2048);
    EXPECT_EQ(default_terms(many, Layout::nodes, Precision::byte), 40);
}

// Where memory does not hold a raw GDM, the paper's layout streams.
TEST_F(CompressLayouts, DefaultsUnderALimit)
{
    GdmResolution r;
    r.nodes = glm::ivec3(32, 32, 8);
    r.ntheta = 4;
    r.nphi = 64;  // 8.4 MB
    for (const auto& [memory, layout] : {std::pair(1e8, Layout::nodes), {1.2e7, Layout::paper}}) {
        Job job;
        EXPECT_EQ(bake_map(*sample, r, Engine::automatic, nullptr, CompressOptions{}, memory, job).layout, layout);
    }
}

}  // namespace
}  // namespace mesoshell

// The truncated SVD against Eigen's own: optimal, honest about its error, and what it rounds it says.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "check.h"
#include "mesoshell/compress.h"
#include "meshes.h"

namespace mesoshell {
namespace {

// A raw GDM of 13 x 11 x 8 = 1144 rows and 6 x 4 = 24 columns, of some balls, and its exact singular values. More rows
// than the code sums up at a time.
class Compress : public testing::Test {
protected:
    static void SetUpTestSuite()
    {
        GdmResolution r;
        r.nodes = glm::ivec3(13, 11, 4);
        r.ntheta = 6;
        r.nphi = 8;
        Job job;
        Random random(1);
        Mesh balls;
        for (int i = 0; i < 6; ++i) {
            const glm::vec3 center(random.in_box({0.0, 0.0, 0.1}, {1.0, 0.8, 0.5}));
            balls = merged(balls, sphere(center, static_cast<float>(random.uniform(0.05, 0.2)), 8, 12));
        }
        const Sample sample = balls.sample(0.6f, 0.8f);
        gdm = bake_gdm(sample, r, job);
        sdf = bake_sdf(sample, {5, 4, 3}, job);
        singular = raw().bdcSvd().singularValues();
    }

    static Eigen::MatrixXd raw()
    {
        using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        return Eigen::Map<const RowMajor>(gdm.values.data(), rows, columns).cast<double>();
    }

    static Map compressed(int terms, Precision precision, float max_rmse = 0.0f)
    {
        CompressOptions options;
        options.layout = Layout::paper;
        options.terms = terms;
        options.max_rmse = max_rmse;
        options.precision = precision;
        Job job;
        return compress(gdm, &sdf, options, job);
    }

    // The terms as they are stored, multiplied out.
    static Eigen::MatrixXd product(const Map& map)
    {
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rows, columns);
        for (int k = 0; k < map.terms; ++k) {
            for (int row = 0; row < rows; ++row) {
                for (int column = 0; column < columns; ++column) {
                    sum(row, column) += double(map.weights[std::size_t(k) * rows + row]) *
                                        double(map.eigenmaps[std::size_t(k) * columns + column]);
                }
            }
        }
        return sum;
    }

    // Root mean square of what k terms leave at best (Eckart and Young 1936).
    static double optimal_rmse(int terms)
    {
        return std::sqrt(singular.tail(columns - terms).squaredNorm() / (rows * columns));
    }

    // The Gram matrix is summed in single precision, its error spreads like a random walk over the rows: relative to
    // the largest eigenvalue about 2^-24 sqrt(rows). k wrong eigenvectors lose at most 2k times that of the captured
    // squares.
    static double worst_rmse(int terms)
    {
        const double lost = 2.0 * terms * 0x1p-24 * std::sqrt(rows) * singular[0] * singular[0];
        return std::sqrt(optimal_rmse(terms) * optimal_rmse(terms) + lost / (rows * columns)) + rounding;
    }

    static constexpr int rows = 8 * 11 * 13;
    static constexpr int columns = 6 * 4;
    // A value is a sum of up to 24 products, none larger than the row's norm, which is below 6 tile widths here.
    static constexpr double rounding = 24 * 6 * 0x1p-24;
    static inline Gdm gdm;
    static inline Sdf sdf;
    static inline Eigen::VectorXd singular;
};

TEST_F(Compress, TheTestTileIsWorthCompressing)
{
    EXPECT_LT(raw().rowwise().norm().maxCoeff(), 6.0);
    EXPECT_GT(optimal_rmse(8), 0.03);
    EXPECT_GT(optimal_rmse(16), 0.002);
}

TEST_F(Compress, AllTermsGiveTheRawValuesBack)
{
    const Map map = compressed(columns, Precision::single);
    ASSERT_EQ(map.weights.size(), std::size_t(columns) * rows);
    ASSERT_EQ(map.eigenmaps.size(), std::size_t(columns) * columns);
    EXPECT_LT((product(map) - raw()).cwiseAbs().maxCoeff(), rounding);
    EXPECT_LT(map.rmse, rounding);
    EXPECT_LT(map.max_error, rounding);
}

TEST_F(Compress, EckartYoung)
{
    for (const int terms : {1, 2, 3, 5, 8, 13, 20, 23}) {
        const Map map = compressed(terms, Precision::single);
        EXPECT_EQ(map.terms, terms);
        EXPECT_GE(map.rmse, optimal_rmse(terms) - rounding) << terms << " terms";
        EXPECT_LE(map.rmse, worst_rmse(terms)) << terms << " terms";
    }
}

TEST_F(Compress, TheBoundOfEckartYoungIsNarrow)
{
    for (const int terms : {1, 2, 3, 5, 8, 10}) {
        EXPECT_LT(worst_rmse(terms), 1.01 * optimal_rmse(terms)) << terms << " terms";
        EXPECT_LT(worst_rmse(terms + 1), optimal_rmse(terms)) << terms << " terms";
    }
}

TEST_F(Compress, MoreTermsAreNoWorse)
{
    double before = std::numeric_limits<double>::infinity();
    for (int terms = 1; terms <= columns; ++terms) {
        const double rmse = compressed(terms, Precision::single).rmse;
        EXPECT_LE(rmse, before + rounding) << terms << " terms";
        before = rmse;
    }
}

TEST_F(Compress, ReportedErrorsAreThoseOfTheStoredTerms)
{
    for (const Precision precision : {Precision::single, Precision::half}) {
        for (const int terms : {1, 6, 24}) {
            const Map map = compressed(terms, precision);
            const Eigen::MatrixXd error = product(map) - raw();
            EXPECT_NEAR(map.max_error, error.cwiseAbs().maxCoeff(), rounding);
            EXPECT_NEAR(map.rmse, std::sqrt(error.squaredNorm() / (rows * columns)), rounding);
        }
    }
}

TEST_F(Compress, MaxRmseIsHonoredWithTheFewestTerms)
{
    for (const float wanted : {0.2f, 0.1f, 0.05f, 0.02f, 0.01f}) {
        const Map map = compressed(3, Precision::single, wanted);
        EXPECT_LE(map.rmse, wanted);
        ASSERT_GT(map.terms, 1);
        EXPECT_GT(compressed(map.terms - 1, Precision::single).rmse, wanted);
    }
    EXPECT_EQ(compressed(3, Precision::single, 100.0f).terms, 1);
    EXPECT_EQ(compressed(3, Precision::single, std::numeric_limits<float>::infinity()).terms, 1);
}

TEST_F(Compress, MaxRmseIsHonoredInHalfPrecision)
{
    // What rounding to 16 bits costs counts too: just above what n terms leave unrounded, n rounded terms are too few.
    for (const int terms : {4, 8, 12, 16}) {
        const float wanted = static_cast<float>(optimal_rmse(terms) * 1.000001);
        const Map map = compressed(3, Precision::half, wanted);
        EXPECT_LE(map.rmse, wanted) << map.terms << " terms";
        EXPECT_GT(compressed(map.terms - 1, Precision::half).rmse, wanted) << map.terms << " terms";
    }
}

bool is_half(float value)
{
    // 11 significant bits, in steps of no less than 2^-24, up to 65504.
    if (!(std::abs(value) <= 65504.0f)) {
        return false;
    }
    int exponent = 0;
    std::frexp(value, &exponent);
    const double step = std::max(std::ldexp(1.0, exponent - 11), 0x1p-24);
    return value == 0.0f || std::remainder(static_cast<double>(value), step) == 0.0;
}

TEST_F(Compress, HalfValuesAreHalf)
{
    const Map map = compressed(16, Precision::half);
    EXPECT_EQ(map.precision, Precision::half);
    for (const std::vector<float>* values : {&map.weights, &map.eigenmaps, &map.sdf}) {
        ASSERT_FALSE(values->empty());
        for (const float value : *values) {
            ASSERT_TRUE(is_half(value)) << value;
        }
    }
    const Map single = compressed(16, Precision::single);
    EXPECT_EQ(single.precision, Precision::single);
    EXPECT_FALSE(std::all_of(single.weights.begin(), single.weights.end(), is_half));
}

TEST_F(Compress, DistanceFieldComesAlong)
{
    const Map single = compressed(2, Precision::single);
    EXPECT_EQ(single.sdf, sdf.values);
    EXPECT_EQ(single.sdf_nodes, sdf.nodes);
    EXPECT_EQ(single.height, gdm.height);
    EXPECT_EQ(single.aspect, gdm.aspect);
    const Map half = compressed(2, Precision::half);
    for (std::size_t i = 0; i < sdf.values.size(); ++i) {
        // Half an ulp of 11 bits.
        EXPECT_LE(std::abs(half.sdf[i] - sdf.values[i]), std::max(std::abs(sdf.values[i]) * 0x1p-11f, 0x1p-25f));
    }
    Job job;
    const Map without = compress(gdm, nullptr, CompressOptions{}, job);
    EXPECT_TRUE(without.sdf.empty());
    EXPECT_EQ(without.sdf_nodes, glm::ivec3(0));
}

TEST_F(Compress, OptionsOutOfRange)
{
    for (const int terms : {-2, -1, columns + 1}) {
        expect_refusal<InvalidArgument>([&] { compressed(terms, Precision::single); }, {"terms", "1 to 24"});
    }
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -0.1f}) {
        expect_refusal<InvalidArgument>([&] { compressed(16, Precision::single, bad); }, {"max_rmse"});
    }
}

TEST_F(Compress, DistanceFieldOfAnotherTile)
{
    for (const bool height : {true, false}) {
        Sdf other = sdf;
        (height ? other.height : other.aspect) *= 1.5f;
        Job job;
        expect_refusal<InvalidArgument>([&] { compress(gdm, &other, CompressOptions{}, job); }, {"SDF", "one sample"});
    }
}

}  // namespace
}  // namespace mesoshell

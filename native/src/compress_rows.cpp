#include "compress_rows.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "gram.h"
#include "instruction_set.h"
#include "map_terms.h"
#include "parallel.h"
#include "spectrum.h"

namespace mesoshell {
namespace {

constexpr int rows_per_block = 512;

// What a sample costs, in nanoseconds on one thread: only the progress depends on these.
constexpr float bake_cost = 12.0f;
constexpr float gram_cost = 0.0105f;  // and for each column
constexpr float products_cost = 1.0f;

class RowCompression {
public:
    RowCompression(GdmSource& source, const CompressOptions& options, Map& map, Job& job, float begin, float end)
        : source_(source), options_(options), map_(map), job_(job), begin_(begin), end_(end),
          columns_(map.resolution.ntheta * map.resolution.nodes.z), nodes_(map.resolution.nodes.x * map.resolution.nodes.y),
          exits_(exit_distances(map.resolution, map.height))
    {
        // Errors of a share count as much as those of the share's square root of a distance: between misjudged hits, which
        // depend on shares, and distances.
        scale_ = Eigen::VectorXd::Ones(columns_);
        for (int column = 0; map.layout == Layout::share && column < columns_; ++column) {
            scale_[column] = exits_[column] > 0.0f ? 1.0 / std::sqrt(static_cast<double>(exits_[column])) : 0.0;
        }
    }

    void run()
    {
        const float baking = source_.bakes() ? bake_cost : 0.0f;
        const float gram = gram_cost * static_cast<float>(columns_);
        const float again = source_.always_bakes() ? bake_cost : 0.0f;
        const float whole = baking + gram + 2.0f * (again + products_cost);
        weights_begin_ = (baking + gram) / whole;
        errors_begin_ = 1.0f - (again + products_cost) / whole;
        baking_beside_products_ = again / (again + products_cost);
        gram_ = gram_matrix(source_, job_, begin_, at(weights_begin_), baking / (baking + gram));
        energy_ = gram_.trace();
        gram_ = scale_.asDiagonal() * gram_ * scale_.asDiagonal();
        if (options_.max_rmse > 0.0f) {
            fit(options_.max_rmse);
        } else {
            spectrum_ = largest_eigenpairs(gram_, options_.terms, job_);
            project(options_.terms);
        }
    }

private:
    float at(float share) const { return begin_ + (end_ - begin_) * share; }
    double count() const { return static_cast<double>(nodes_) * map_.resolution.nphi * columns_; }

    // Mean square, over the grid, of what the first terms leave of the raw GDM.
    double mean_square_left(int terms) const
    {
        // With scaled columns, distances are not what the eigenvalues sum; then this is only a first guess.
        const double whole = map_.layout == Layout::share ? gram_.trace() : energy_;
        return std::max(whole - spectrum_.values.head(terms).sum(), 0.0) / count();
    }

    void extend_spectrum(int terms)
    {
        if (spectrum_.values.size() < terms) {
            spectrum_ = largest_eigenpairs(gram_, std::min(columns_, std::max(terms, 16)), job_);
        }
    }

    // Of the first terms; looks at ever more eigenvalues.
    int fewest_terms(double mean_square)
    {
        int terms = 1;
        for (extend_spectrum(1); terms < columns_ && mean_square_left(terms) > mean_square; ++terms) {
            if (terms == spectrum_.values.size()) {
                extend_spectrum(2 * terms);
            }
        }
        return terms;
    }

    // The fewest terms whose error, with that of rounding them, is at most max_rmse.
    void fit(double max_rmse)
    {
        const double allowed = max_rmse * max_rmse;
        project(fewest_terms(allowed));
        while (map_.rmse > max_rmse) {
            weights_begin_ = errors_begin_ = 1.0f;  // the progress never falls
            // Rounding costs nearly the same whatever the number of terms: leave room for it.
            const double rounding = static_cast<double>(map_.rmse) * map_.rmse - mean_square_left(map_.terms);
            if (map_.layout != Layout::share && (rounding >= allowed || map_.terms == columns_)) {
                refuse(max_rmse, rounding);
            }
            if (map_.terms == columns_) {
                refuse(max_rmse, static_cast<double>(map_.rmse) * map_.rmse);
            }
            const int next = map_.layout == Layout::share ? map_.terms + std::max(1, map_.terms / 8)
                                                          : std::max(map_.terms + 1, fewest_terms(allowed - rounding));
            extend_spectrum(std::min(next, columns_));
            project(std::min(next, columns_));
        }
    }

    [[noreturn]] void refuse(double max_rmse, double mean_square) const
    {
        static const char* const names[] = {"byte", "half", "single"};
        throw InvalidArgument("max_rmse is " + std::to_string(max_rmse) + ", but " +
                              names[static_cast<int>(map_.precision)] + " precision alone costs " +
                              std::to_string(std::sqrt(std::max(mean_square, 0.0))) + "; give a larger max_rmse" +
                              (map_.precision == Precision::single ? "" : ", or a finer precision"));
    }

    // Fills in the first terms, as they are stored, and their errors.
    void project(int terms)
    {
        map_.terms = terms;
        map_.eigenmaps.resize(static_cast<std::size_t>(terms) * columns_);
        std::vector<float> basis(map_.eigenmaps.size());
        for (int term = 0; term < terms; ++term) {
            for (int column = 0; column < columns_; ++column) {
                const double value = spectrum_.vectors(column, term);
                const std::size_t i = static_cast<std::size_t>(term) * columns_ + column;
                basis[i] = static_cast<float>(value * scale_[column]);
                map_.eigenmaps[i] = static_cast<float>(map_.layout == Layout::share ? value * scale_[column] : value);
            }
        }
        if (map_.layout == Layout::share) {
            continue_shares();
        }
        round_eigenmaps(map_);
        if (map_.layout == Layout::paper) {
            basis = map_.eigenmaps;
        }
        find_weights(basis);
        round_terms(map_);
        find_errors();
    }

    // Where a ray leaves the slab at once, any share will do: the next slice's, so that lookups between the two see no step.
    void continue_shares()
    {
        const int nz = map_.resolution.nodes.z;
        for (int row = 0; row < map_.terms * map_.resolution.ntheta; ++row) {
            float* const line = map_.eigenmaps.data() + static_cast<std::size_t>(row) * nz;
            const float* const exits = exits_.data() + static_cast<std::size_t>(row % map_.resolution.ntheta) * nz;
            line[0] = exits[0] > 0.0f ? line[0] : line[1];
            line[nz - 1] = exits[nz - 1] > 0.0f ? line[nz - 1] : line[nz - 2];
        }
    }

    void find_weights(const std::vector<float>& basis)
    {
        const int terms = map_.terms;
        const std::size_t rows = static_cast<std::size_t>(nodes_) * map_.resolution.nphi;
        map_.weights.resize(terms * rows);
        source_.walk(job_, at(weights_begin_), at(errors_begin_), baking_beside_products_, [&](int first, int count, const float* values) {
            for_blocks(count, [&](int row, int height) {
                std::vector<float> block(static_cast<std::size_t>(height) * terms);
                kernels().project(values + static_cast<std::size_t>(row) * columns_, height, columns_, basis.data(), terms,
                                  block.data());
                float* const to = map_.weights.data() + static_cast<std::size_t>(first) * nodes_ + row;
                for (int term = 0; term < terms; ++term) {
                    for (int i = 0; i < height; ++i) {
                        to[static_cast<std::size_t>(term) * rows + i] = block[static_cast<std::size_t>(i) * terms + term];
                    }
                }
            });
        });
    }

    void find_errors()
    {
        const int terms = map_.terms;
        const std::size_t rows = static_cast<std::size_t>(nodes_) * map_.resolution.nphi;
        const std::vector<float> basis = distance_basis(map_, 0);
        double squared = 0.0;
        float largest = 0.0f;
        source_.walk(job_, at(errors_begin_), end_, baking_beside_products_, [&](int first, int count, const float* values) {
            std::vector<simd::Residual> of_block((static_cast<std::size_t>(count) * nodes_ + rows_per_block - 1) / rows_per_block);
            for_blocks(count, [&](int row, int height) {
                std::vector<float> block(static_cast<std::size_t>(height) * terms);
                const float* const from = map_.weights.data() + static_cast<std::size_t>(first) * nodes_ + row;
                for (int term = 0; term < terms; ++term) {
                    for (int i = 0; i < height; ++i) {
                        block[static_cast<std::size_t>(i) * terms + term] = from[static_cast<std::size_t>(term) * rows + i];
                    }
                }
                of_block[row / rows_per_block] = kernels().residual(values + static_cast<std::size_t>(row) * columns_, height,
                                                                    columns_, block.data(), basis.data(), terms);
            });
            for (const simd::Residual& residual : of_block) {  // in one order, whatever the number of threads
                squared += residual.squared;
                largest = std::max(largest, residual.largest);
            }
        });
        map_.rmse = static_cast<float>(std::sqrt(squared / this->count()));
        map_.max_error = largest;
    }

    // Calls visit(first row, number of rows) for the rows of `azimuths` azimuths.
    template <typename Visit>
    void for_blocks(int azimuths, const Visit& visit)
    {
        const int rows = azimuths * nodes_;
        parallel_for(job_, (rows + rows_per_block - 1) / rows_per_block, [&](int block) {
            visit(block * rows_per_block, std::min(rows_per_block, rows - block * rows_per_block));
        });
    }

    GdmSource& source_;
    const CompressOptions& options_;
    Map& map_;
    Job& job_;
    float begin_;
    float end_;
    // Shares of the whole after which weights and errors are looked for, and what baking is of a block there.
    float weights_begin_ = 0.0f;
    float errors_begin_ = 0.0f;
    float baking_beside_products_ = 0.0f;
    int columns_;
    int nodes_;
    std::vector<float> exits_;  // of the columns, tile widths
    Eigen::VectorXd scale_;     // of the columns, before the SVD
    Eigen::MatrixXd gram_;      // of the scaled columns
    double energy_ = 0.0;       // sum of squares of the raw GDM
    Spectrum spectrum_;
};

}  // namespace

void compress_rows(GdmSource& source, const CompressOptions& options, Map& map, Job& job, float begin, float end)
{
    RowCompression(source, options, map, job, begin, end).run();
}

}  // namespace mesoshell

#include "scene_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "parallel.h"

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

// Rows that a small image is read at, at least: a function as smooth as the harmonics is then summed to 1e-4.
constexpr int fewest_rows = 128;

// The real spherical harmonics of degrees 0 to 2.
std::array<float, 9> harmonics_at(const glm::vec3& d)
{
    return {0.282095f,
            0.488603f * d.y,
            0.488603f * d.z,
            0.488603f * d.x,
            1.092548f * d.x * d.y,
            1.092548f * d.y * d.z,
            0.315392f * (3.0f * d.z * d.z - 1.0f),
            1.092548f * d.x * d.z,
            0.546274f * (d.x * d.x - d.y * d.y)};
}

// What a clamped cosine leaves of each degree, over pi.
constexpr std::array<float, 9> cosine_shares{1.0f,        2.0f / 3.0f, 2.0f / 3.0f, 2.0f / 3.0f, 0.25f,
                                             0.25f,       0.25f,       0.25f,       0.25f};

}  // namespace

Sky::Sky(const SceneWorld& world, Job& job) : world_(world)
{
    if (!world_.image.empty()) {
        project(job);
    }
}

glm::vec3 Sky::pixel(int x, int y) const
{
    const glm::ivec2& size = world_.image_size;
    return world_.image[static_cast<std::size_t>(std::clamp(y, 0, size.y - 1)) * size.x + (x + size.x) % size.x];
}

glm::vec3 Sky::radiance(const glm::dvec3& dir) const
{
    if (world_.image.empty()) {
        return world_.color;
    }
    const double u = 0.5 - std::atan2(dir.y, dir.x) / (2.0 * pi);
    const double v = 0.5 + std::asin(std::clamp(dir.z, -1.0, 1.0)) / pi;
    const glm::dvec2 place = glm::dvec2(u, v) * glm::dvec2(world_.image_size) - 0.5;
    const glm::ivec2 low(glm::floor(place));
    const glm::vec2 share(place - glm::dvec2(low));
    return glm::mix(glm::mix(pixel(low.x, low.y), pixel(low.x + 1, low.y), share.x),
                    glm::mix(pixel(low.x, low.y + 1), pixel(low.x + 1, low.y + 1), share.x), share.y);
}

void Sky::project(Job& job)
{
    const int rows = std::max(world_.image_size.y, fewest_rows);
    const int columns = std::max(world_.image_size.x, 2 * fewest_rows);
    std::vector<std::array<glm::dvec3, 9>> sums(static_cast<std::size_t>(rows));
    parallel_for(
        job, rows,
        [&](int row) {
            std::array<glm::dvec3, 9>& sum = sums[row];
            sum.fill(glm::dvec3(0.0));
            const double below = std::sin((static_cast<double>(row) / rows - 0.5) * pi);
            const double above = std::sin((static_cast<double>(row + 1) / rows - 0.5) * pi);
            const double angle = (above - below) * 2.0 * pi / columns;  // solid angle of a place of this row
            const double elevation = ((row + 0.5) / rows - 0.5) * pi;
            for (int column = 0; column < columns; ++column) {
                const double azimuth = (0.5 - (column + 0.5) / columns) * 2.0 * pi;
                const glm::dvec3 dir(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                     std::sin(elevation));
                const glm::dvec3 light = glm::dvec3(radiance(dir)) * angle;
                const std::array<float, 9> values = harmonics_at(glm::vec3(dir));
                for (int i = 0; i < 9; ++i) {
                    sum[i] += light * static_cast<double>(values[i]);
                }
            }
        },
        0.0f);
    for (int i = 0; i < 9; ++i) {
        glm::dvec3 whole(0.0);
        for (const auto& sum : sums) {
            whole += sum[i];
        }
        harmonics_[i] = glm::vec3(whole) * cosine_shares[i];
    }
}

glm::vec3 Sky::ambient(const glm::vec3& normal) const
{
    if (world_.image.empty()) {
        return world_.color;
    }
    const std::array<float, 9> values = harmonics_at(normal);
    glm::vec3 sum(0.0f);
    for (int i = 0; i < 9; ++i) {
        sum += harmonics_[i] * values[i];
    }
    // A lamp in the image is sharper than nine harmonics: behind it they may fall below nothing.
    return glm::max(sum, glm::vec3(0.0f));
}

}  // namespace mesoshell

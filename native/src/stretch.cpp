#include "mesoshell/stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "parallel.h"
#include "prism_stretch.h"

namespace mesoshell {
namespace {

constexpr std::size_t prisms_per_task = 4096;

double given_or(double given, const char* name, double found)
{
    if (!(given >= 0.0) || !std::isfinite(given)) {
        throw InvalidArgument(std::string(name) + " is " + std::to_string(given) +
                              "; give the tile's in tile widths, or 0 for the shell's");
    }
    return given > 0.0 ? given : found;
}

}  // namespace

Stretch stretch(const Shell& shell, const Proportions& proportions, Job& job)
{
    const std::size_t count = shell.topology->triangles.size();
    const std::size_t tasks = (count + prisms_per_task - 1) / prisms_per_task;
    Stretch result;
    result.rms.resize(count);
    result.angle.resize(count);
    std::vector<StretchIntegrals> integrals(count);
    std::vector<StretchIntegrals> parts(tasks);
    std::vector<std::size_t> infinite(tasks, 0);
    parallel_for(job, static_cast<int>(tasks), [&](int task) {
        const std::size_t first = static_cast<std::size_t>(task) * prisms_per_task;
        for (std::size_t p = first; p < std::min(count, first + prisms_per_task); ++p) {
            const PrismStretch prism(shell, p);
            if (prism.area(0.5) != 0.0) {
                const glm::dmat2x3 axes = prism.axes(0.5);
                result.angle[p] = static_cast<float>(
                    std::atan2(glm::length(glm::cross(axes[0], axes[1])), glm::dot(axes[0], axes[1])));
            }
            if (prism.keeps_winding()) {
                integrals[p] = prism.integrals();
                parts[static_cast<std::size_t>(task)] += integrals[p];
            } else {
                result.rms[p] = std::numeric_limits<float>::infinity();
                infinite[static_cast<std::size_t>(task)] += 1;
            }
        }
    });
    StretchIntegrals all;
    for (std::size_t task = 0; task < tasks; ++task) {
        all += parts[task];
        result.infinite += infinite[task];
    }
    // Scales u : v / aspect^2 : w / height^2 of a given product have the least sum where they are equal, and with a given
    // aspect where w / height^2 is the mean of the other two.
    const auto ratio = [](double a, double b) { return a > 0.0 && b > 0.0 ? std::sqrt(a / b) : 1.0; };
    const double aspect = given_or(proportions.aspect, "aspect", ratio(all.v, all.u));
    const double flat = 0.5 * (all.u + all.v / (aspect * aspect));
    const double height = given_or(proportions.height, "height", ratio(all.w, flat));
    result.proportions = {aspect, height};
    const double scale_2 = std::pow(all.volume / (all.tiles * aspect * height), 2.0 / 3.0);
    const auto rms = [&](const StretchIntegrals& part) {
        const double sum = part.u + part.v / (aspect * aspect) + part.w / (height * height);
        return part.volume > 0.0 ? std::sqrt(sum / (3.0 * part.volume * scale_2)) : 0.0;
    };
    for (std::size_t p = 0; p < count; ++p) {
        if (std::isfinite(result.rms[p])) {
            result.rms[p] = static_cast<float>(rms(integrals[p]));
        }
    }
    result.total = rms(all);
    return result;
}

}  // namespace mesoshell

// What it costs to find where a ray runs in a prism, three ways, and what each loses. For ./dev bench mapping.
//
// Ways: "exact" (shaders/lib/prism_path.glsl), "cool" (cool_patches.glsl) and "paper" (shaders/lib/prism_planes.glsl).
// Prints, a line each, words and numbers:
//     time WAY ns                         of a ray that may meet a prism, least of five rounds
//     inverse ns                          of a position to its place
//     lost WAY KIND rays lost             rays through points of fins and prisms that no span holds within 1e-4
//     paper TWIST max mean                entry and exit against exact fins, shares of a prism's edge
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "embree_scene.h"
#include "meshes.h"
#include "prism_truth.h"
#include "shader_text.h"

namespace mesoshell::shader {
#include "cool_patches.glsl"
}  // namespace mesoshell::shader

namespace {

using namespace mesoshell;
using Clock = std::chrono::steady_clock;

std::mt19937 engine(1);

double uniform(double low, double high)
{
    return low + (high - low) * (engine() * 0x1p-32);
}

glm::dvec3 direction()
{
    const double z = uniform(-1.0, 1.0);
    const double azimuth = uniform(0.0, 6.283185307179586);
    return {std::sqrt(1.0 - z * z) * std::cos(azimuth), std::sqrt(1.0 - z * z) * std::sin(azimuth), z};
}

enum class Way { exact, cool, paper };
constexpr const char* way_names[] = {"exact", "cool", "paper"};

shader::PrismSpan first_span(Way way, const shader::Prism& prism, const glm::vec3& origin, const glm::vec3& dir, float t_after)
{
    if (way == Way::cool) {
        return shader::cool_span(shader::make_cool_path(prism, origin, dir), t_after);
    }
    if (way == Way::paper) {
        return shader::plane_span(prism, origin, dir, t_after);
    }
    const shader::PrismPath path = shader::make_prism_path(prism, origin, dir);
    if (path.level) {
        shader::PrismSpan span = shader::level_span(prism, origin, dir, path.level_height);
        span.found = span.found && span.t_out > t_after;
        return span;
    }
    return shader::next_span(path, t_after);
}

// A torus whose directors lean by `twist` along its surface, otherwise at every vertex.
Shell twisted_torus(float thickness, double twist)
{
    SurfaceMesh mesh = torus(1.0f, 0.42f, 48, 24, 10.0f, 5.0f);
    for (glm::vec3& normal : mesh.normals) {
        const glm::dvec3 side = glm::normalize(glm::cross(glm::dvec3(normal), direction()));
        normal = glm::vec3(glm::normalize(glm::dvec3(normal) + twist * uniform(0.0, 1.0) * side));
    }
    return mesh.shell(thickness);
}

struct Task {
    shader::Prism prism;
    glm::vec3 origin;
    glm::vec3 dir;
    glm::vec3 point;
};

void print_times()
{
    const Shell shell = twisted_torus(0.1f, 0.3);
    std::vector<Task> tasks(100'000);
    for (Task& task : tasks) {
        const PrismTexels& texels = shell.prisms[engine() % shell.prisms.size()];
        const glm::dvec3 target = PrismTruth(texels).position({uniform(-0.3, 1.1), uniform(-0.3, 1.1), uniform(-0.2, 1.2)});
        const glm::dvec3 dir = direction();
        const double q1 = uniform(0.0, 1.0);
        const glm::dvec3 q(q1, uniform(0.0, 1.0 - q1), uniform(0.0, 1.0));
        task = {shader::prism_of(texels), glm::vec3(target - 3.0 * dir), glm::vec3(dir), glm::vec3(PrismTruth(texels).position(q))};
    }
    double least[4] = {1e30, 1e30, 1e30, 1e30};
    volatile float kept = 0.0f;
    for (int round = 0; round < 5; ++round) {
        for (int what = 0; what < 4; ++what) {
            float sum = 0.0f;
            const Clock::time_point start = Clock::now();
            for (const Task& task : tasks) {
                if (what == 3) {
                    sum += shader::place_of_position(task.prism, task.point).q.x;
                } else {
                    const shader::PrismSpan span = first_span(static_cast<Way>(what), task.prism, task.origin, task.dir, -3e38f);
                    sum += span.found ? span.q_in.x + span.q_out.y : 0.0f;
                }
            }
            const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
            kept = kept + sum;
            least[what] = std::min(least[what], seconds / static_cast<double>(tasks.size()) * 1e9);
        }
    }
    for (int way = 0; way < 3; ++way) {
        std::printf("time %s %.1f\n", way_names[way], least[way]);
    }
    std::printf("inverse %.1f\n", least[3]);
}

// Rays through points of the shell: in prisms and in fins in any direction, level with the triangle there, and along fins.
void print_lost(int rays)
{
    const Shell shell = twisted_torus(0.15f, 0.3);
    std::vector<BoxScene::Box> boxes;
    for (const PrismTexels& prism : shell.prisms) {
        BoxScene::Box box{glm::vec3(prism[0]), glm::vec3(prism[0])};
        for (std::size_t corner = 1; corner < 6; ++corner) {
            box.lower = glm::min(box.lower, glm::vec3(prism[corner]));
            box.upper = glm::max(box.upper, glm::vec3(prism[corner]));
        }
        boxes.push_back({box.lower - 1e-4f, box.upper + 1e-4f});
    }
    const BoxScene scene(boxes);
    const char* kinds[] = {"prism", "fin", "level", "along-fin"};
    for (int kind = 0; kind < 4; ++kind) {
        int lost[3] = {0, 0, 0};
        for (int i = 0; i < rays; ++i) {
            const PrismTexels& texels = shell.prisms[engine() % shell.prisms.size()];
            const PrismTruth truth(texels);
            const double q1 = uniform(0.02, 0.9);
            const glm::dvec3 q(q1, kind == 1 || kind == 3 ? 0.0 : uniform(0.01, 0.98 - q1), uniform(0.02, 0.98));
            const glm::dvec3 point = truth.position(q);
            const glm::dvec3 edge = truth.column(1, q.z) - truth.column(0, q.z);
            const glm::dvec3 rise = truth.position({q.x, q.y, 1.0}) - truth.position({q.x, q.y, 0.0});
            glm::dvec3 dir = direction();
            if (kind == 2) {
                const glm::dvec3 normal = glm::normalize(glm::cross(edge, truth.column(2, q.z) - truth.column(0, q.z)));
                dir = glm::normalize(dir - glm::dot(dir, normal) * normal);
            } else if (kind == 3) {
                const double angle = uniform(0.0, 6.283185307179586);
                dir = std::cos(angle) * glm::normalize(edge) + std::sin(angle) * glm::normalize(rise);
                dir = glm::normalize(dir);
            }
            const glm::vec3 origin(point - 4.0 * dir);
            const glm::vec3 dir_float(dir);
            const double t = glm::dot(point - glm::dvec3(origin), glm::dvec3(dir_float));
            for (int way = 0; way < 3; ++way) {
                bool held = false;
                scene.visit_along(origin, dir_float, 0.0f, [&](std::uint32_t prism, float tfar) {
                    float t_after = -3e38f;
                    for (int k = 0; k < 4 && !held; ++k) {
                        const shader::PrismSpan span = first_span(static_cast<Way>(way), shader::prism_of(shell.prisms[prism]),
                                                                  origin, dir_float, t_after);
                        held = span.found && span.t_in <= t + 1e-4 && span.t_out >= t - 1e-4;
                        t_after = span.t_out;
                        if (!span.found) {
                            break;
                        }
                    }
                    return tfar;
                });
                lost[way] += held ? 0 : 1;
            }
        }
        for (int way = 0; way < 3; ++way) {
            std::printf("lost %s %s %d %d\n", way_names[way], kinds[kind], rays, lost[way]);
        }
    }
}

void print_paper()
{
    for (const double twist : {0.0, 0.1, 0.3, 0.6}) {
        const Shell shell = twisted_torus(0.1f, twist);
        double worst = 0.0;
        double sum = 0.0;
        int ends = 0;
        for (int i = 0; i < 200'000; ++i) {
            const PrismTexels& texels = shell.prisms[engine() % shell.prisms.size()];
            const shader::Prism prism = shader::prism_of(texels);
            const double q1 = uniform(0.0, 1.0);
            const glm::dvec3 target = PrismTruth(texels).position({q1, uniform(0.0, 1.0 - q1), uniform(0.0, 1.0)});
            const glm::dvec3 dir = direction();
            const glm::vec3 origin(target - 3.0 * dir);
            const shader::PrismSpan exact = first_span(Way::exact, prism, origin, glm::vec3(dir), -3e38f);
            const shader::PrismSpan paper = first_span(Way::paper, prism, origin, glm::vec3(dir), -3e38f);
            if (exact.found && paper.found) {
                const double edge = glm::length(prism.base[1] - prism.base[0]);
                for (const double error : {exact.t_in - paper.t_in, exact.t_out - paper.t_out}) {
                    worst = std::max(worst, std::abs(error) / edge);
                    sum += std::abs(error) / edge;
                    ends += 1;
                }
            }
        }
        std::printf("paper %.1f %.4f %.5f\n", twist, worst, sum / ends);
    }
}

}  // namespace

int main()
{
    print_times();
    print_lost(20'000);
    print_paper();
    return 0;
}

// One shell, ready for rays: the nearest place where a traversal meets its mesostructure.
#pragma once

#include <cstdint>
#include <memory>

#include <glm/glm.hpp>

#include "mesoshell/compress.h"
#include "mesoshell/interface.h"
#include "mesoshell/shell.h"

namespace mesoshell {

class Sample;

struct ShellTraceHit {
    bool hit = false;
    float t = 0.0f;                // ray parameter, object units
    glm::vec3 normal{0.0f};        // object space, unit length, out of the solid
    glm::vec3 pos_texture{0.0f};   // texture space
    std::uint32_t prism = 0;
    int fetches = 0;               // texture instructions of the whole ray, whether it hits or not
    float clearance = 0.0f;        // object units along the normal: a ray that starts there leaves the surface it was at
};

struct ShellOcclusion {
    bool hit = false;
    int fetches = 0;
};

class ShellTracer {
public:
    // params are complete_params'; mode.x is the traversal, mode.z the fins. `sample` is the tile, which the traversal `exact`
    // alone asks. Shell, map and sample must live as long. Throws InvalidArgument for `exact` without a sample.
    ShellTracer(const Shell& shell, const Map& map, const ShellParams& params, const Sample* sample);
    ~ShellTracer();
    ShellTracer(const ShellTracer&) = delete;
    ShellTracer& operator=(const ShellTracer&) = delete;

    // The nearest hit with t in [t_near, t_far). origin and dir, which has unit length, are in object space. Any thread.
    ShellTraceHit nearest(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;
    // Whether there is any hit at all there: for shadow rays.
    ShellOcclusion any(const glm::vec3& origin, const glm::vec3& dir, float t_near, float t_far) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace mesoshell

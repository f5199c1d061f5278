// What the renderer's tests share: a map with nothing but a distance field, and a call of the renderer.
#pragma once

#include "mesoshell/bake.h"
#include "mesoshell/render.h"

namespace mesoshell {

constexpr int gdm_traversal = 0;
constexpr int sdf_traversal = 1;

inline ShellParams settings(int traversal)
{
    ShellParams params;
    params.mode.x = traversal;
    return params;
}

inline Rendering render_with(const Shell& shell, const Map& map, const View& view, int traversal)
{
    Job job;
    return render(shell, map, view, settings(traversal), job);
}

// A field alone: all that the traversal `sdf` asks.
inline Map sdf_map(const Sample& sample, const glm::ivec3& nodes)
{
    Job job;
    const Sdf sdf = bake_sdf(sample, nodes, job);
    Map map;
    map.height = sdf.height;
    map.aspect = sdf.aspect;
    map.sdf_nodes = sdf.nodes;
    map.sdf = sdf.values;
    map.precision = Precision::single;
    return map;
}

}  // namespace mesoshell

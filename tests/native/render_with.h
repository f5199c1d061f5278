// What the renderer's tests share: a map with nothing but a distance field, and a call of the renderer.
#pragma once

#include "mesoshell/bake.h"
#include "mesoshell/render.h"

namespace mesoshell {

constexpr int gdm_traversal = 0;
constexpr int sdf_traversal = 1;
constexpr int exact_traversal = 5;

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

// By the traversal `exact`, which asks the tile and reads of a map only what it is a map of.
inline Rendering render_exactly(const Shell& shell, const Sample& sample, const View& view)
{
    Map map;
    map.height = sample.height();
    map.aspect = sample.aspect();
    map.sdf_nodes = glm::ivec3(2);
    map.sdf.assign(8, 1.0f);
    Job job;
    return render(shell, map, view, settings(exact_traversal), job, &sample);
}

}  // namespace mesoshell

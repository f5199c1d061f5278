#include "limit_refiner.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>
#include <unordered_map>

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <opensubdiv/vtr/types.h>

namespace mesoshell {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

Sdc::SchemeType osd_scheme(Scheme scheme)
{
    switch (scheme) {
    case Scheme::catmark:
        return Sdc::SCHEME_CATMARK;
    case Scheme::loop:
        return Sdc::SCHEME_LOOP;
    case Scheme::bilinear:
        break;
    }
    return Sdc::SCHEME_BILINEAR;
}

Sdc::Options::VtxBoundaryInterpolation osd_boundary(Boundary boundary)
{
    return boundary == Boundary::edges ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER;
}

Sdc::Options::FVarLinearInterpolation osd_uv_rule(UvRule rule)
{
    switch (rule) {
    case UvRule::smooth:
        return Sdc::Options::FVAR_LINEAR_NONE;
    case UvRule::corners:
        return Sdc::Options::FVAR_LINEAR_CORNERS_ONLY;
    case UvRule::corners_and_junctions:
        return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1;
    case UvRule::corners_junctions_and_concave:
        return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2;
    case UvRule::boundaries:
        return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
    case UvRule::linear:
        break;
    }
    return Sdc::Options::FVAR_LINEAR_ALL;
}

struct Creases {
    std::vector<std::int32_t> ends;  // two an edge
    std::vector<float> sharpness;
};

// OpenSubdiv complains on the console about creases of edges that no face has; it never sees them.
Creases creases_on_faces(const Surface& surface)
{
    const auto key = [](std::int32_t a, std::int32_t b) {
        return std::uint64_t(static_cast<std::uint32_t>(std::min(a, b))) << 32 | static_cast<std::uint32_t>(std::max(a, b));
    };
    struct Crease {
        float sharpness;
        bool on_face;
    };
    std::unordered_map<std::uint64_t, Crease> asked;
    for (std::size_t i = 0; i < surface.crease_edges.size(); ++i) {
        asked[key(surface.crease_edges[i].x, surface.crease_edges[i].y)] = {surface.crease_sharpness[i], false};
    }
    Creases creases;
    if (asked.empty()) {
        return creases;
    }
    std::size_t first = 0;
    for (const std::int32_t size : surface.face_sizes) {
        for (std::int32_t i = 0; i < size; ++i) {
            const std::int32_t a = surface.corners[first + i];
            const std::int32_t b = surface.corners[first + (i + 1) % size];
            const auto found = asked.find(key(a, b));
            if (found != asked.end() && !found->second.on_face) {
                found->second.on_face = true;
                creases.ends.insert(creases.ends.end(), {a, b});
                creases.sharpness.push_back(std::min(found->second.sharpness, Sdc::Crease::SHARPNESS_INFINITE));
            }
        }
        first += static_cast<std::size_t>(size);
    }
    return creases;
}

}  // namespace

UvTopology share_uvs(const Surface& surface)
{
    // Corners by vertex, so that only those of one vertex are compared.
    std::vector<std::uint32_t> firsts(surface.positions.size() + 1, 0);
    for (const std::int32_t corner : surface.corners) {
        ++firsts[corner + 1];
    }
    std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
    std::vector<std::uint32_t> order(surface.corners.size());
    std::vector<std::uint32_t> used(firsts.begin(), firsts.end() - 1);
    for (std::size_t corner = 0; corner < surface.corners.size(); ++corner) {
        order[used[surface.corners[corner]]++] = static_cast<std::uint32_t>(corner);
    }
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        return std::tie(surface.uvs[a].x, surface.uvs[a].y) < std::tie(surface.uvs[b].x, surface.uvs[b].y);
    };
    UvTopology topology;
    topology.indices.resize(order.size());
    for (std::size_t vertex = 0; vertex < surface.positions.size(); ++vertex) {
        std::sort(order.begin() + firsts[vertex], order.begin() + firsts[vertex + 1], less);
        for (std::uint32_t i = firsts[vertex]; i < firsts[vertex + 1]; ++i) {
            if (i == firsts[vertex] || less(order[i - 1], order[i])) {
                topology.values.push_back(surface.uvs[order[i]]);
            }
            topology.indices[order[i]] = static_cast<std::int32_t>(topology.values.size()) - 1;
        }
    }
    return topology;
}

void check_valences(const Surface& surface, std::int32_t most, const std::string& limit)
{
    const auto refuse = [&](const std::string& what, std::int32_t count, const char* of) {
        throw Error(what + " of the surface has " + std::to_string(count) + of + ", but " + limit);
    };
    std::vector<std::int32_t> faces(surface.positions.size(), 0);
    for (const std::int32_t corner : surface.corners) {
        ++faces[corner];
    }
    for (std::size_t vertex = 0; vertex < faces.size(); ++vertex) {
        if (faces[vertex] > most) {
            refuse("vertex " + std::to_string(vertex), faces[vertex], " faces");
        }
    }
    for (std::size_t face = 0; face < surface.face_sizes.size(); ++face) {
        if (surface.face_sizes[face] > most) {
            refuse("face " + std::to_string(face), surface.face_sizes[face], " corners");
        }
    }
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Surface& surface, const UvTopology& uvs,
                                                   const Refinement& refinement)
{
    if (refinement.scheme == Scheme::loop &&
        std::any_of(surface.face_sizes.begin(), surface.face_sizes.end(), [](std::int32_t n) { return n != 3; })) {
        throw Error("the Loop scheme needs triangles; triangulate the surface or use catmark");
    }
    // OpenSubdiv counts what is around a vertex or a face in 16 bits.
    check_valences(surface, OpenSubdiv::Vtr::VALENCE_LIMIT - 1, "subdivision takes up to 65534; split it or use levels = 0");
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(surface.positions.size());
    descriptor.numFaces = static_cast<int>(surface.face_sizes.size());
    descriptor.numVertsPerFace = surface.face_sizes.data();
    descriptor.vertIndicesPerFace = surface.corners.data();
    Far::TopologyDescriptor::FVarChannel channel;
    channel.numValues = static_cast<int>(uvs.values.size());
    channel.valueIndices = uvs.indices.data();
    descriptor.numFVarChannels = 1;
    descriptor.fvarChannels = &channel;
    const Creases creases = creases_on_faces(surface);
    descriptor.numCreases = static_cast<int>(creases.sharpness.size());
    descriptor.creaseVertexIndexPairs = creases.ends.data();
    descriptor.creaseWeights = creases.sharpness.data();
    std::vector<float> corner_sharpness(surface.corner_sharpness.begin(), surface.corner_sharpness.end());
    for (float& sharpness : corner_sharpness) {
        sharpness = std::min(sharpness, Sdc::Crease::SHARPNESS_INFINITE);
    }
    descriptor.numCorners = static_cast<int>(corner_sharpness.size());
    descriptor.cornerVertexIndices = surface.corner_vertices.data();
    descriptor.cornerWeights = corner_sharpness.data();

    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(osd_boundary(refinement.boundary));
    options.SetFVarLinearInterpolation(osd_uv_rule(refinement.uv_rule));
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(osd_scheme(refinement.scheme), options)));
    if (!refiner) {
        throw Error("the surface cannot be subdivided; remove faces that use a vertex twice, or use levels = 0");
    }
    return refiner;
}

const void* opensubdiv_function()
{
    return reinterpret_cast<const void*>(&Far::SetErrorCallback);
}

}  // namespace mesoshell

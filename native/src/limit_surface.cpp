#include "limit_surface.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include "vertex_normals.h"

namespace mesoshell {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// What OpenSubdiv accumulates: anything with Clear and AddWithWeight.
template <typename Vector>
struct Primvar {
    Vector value{0.0f};
    void Clear(void* = nullptr) { value = Vector(0.0f); }
    void AddWithWeight(const Primvar& other, float weight) { value += other.value * weight; }
};

// Corners of a vertex with equal UVs share one UV value, so that islands are what OpenSubdiv thinks they are.
struct UvTopology {
    std::vector<int> indices;  // one a corner
    std::vector<Primvar<glm::vec2>> values;
};

UvTopology share_uvs(const Surface& surface)
{
    std::vector<std::uint32_t> order(surface.corners.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const auto key = [&](std::uint32_t c) {
            return std::tuple(surface.corners[c], surface.uvs[c].x, surface.uvs[c].y);
        };
        return key(a) < key(b);
    };
    std::sort(order.begin(), order.end(), less);
    UvTopology topology;
    topology.indices.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || less(order[i - 1], order[i])) {
            topology.values.push_back({surface.uvs[order[i]]});
        }
        topology.indices[order[i]] = static_cast<int>(topology.values.size()) - 1;
    }
    return topology;
}

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

std::unique_ptr<Far::TopologyRefiner> make_refiner(const Surface& surface, const UvTopology& uvs, Scheme scheme)
{
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

    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_BOUNDARIES);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(osd_scheme(scheme), options)));
    if (!refiner) {
        throw Error("the surface cannot be subdivided; remove faces that use a vertex twice, or use levels = 0");
    }
    return refiner;
}

glm::vec3 unit_or_zero(const glm::vec3& v)
{
    const float size = glm::length(v);
    return size > 0.0f && std::isfinite(size) ? v / size : glm::vec3(0.0f);
}

RefinedSurface unrefined(const Surface& surface)
{
    RefinedSurface same;
    same.positions.assign(surface.positions.begin(), surface.positions.end());
    same.face_sizes.assign(surface.face_sizes.begin(), surface.face_sizes.end());
    same.corners.assign(surface.corners.begin(), surface.corners.end());
    same.faces.resize(surface.face_sizes.size());
    std::iota(same.faces.begin(), same.faces.end(), 0);
    UvTopology uvs = share_uvs(surface);
    same.uv_corners = std::move(uvs.indices);
    same.uvs.reserve(uvs.values.size());
    for (const Primvar<glm::vec2>& uv : uvs.values) {
        same.uvs.push_back(uv.value);
    }
    if (surface.normals.empty()) {
        same.normals = angle_weighted_normals(surface);
    } else {
        same.normals.reserve(surface.normals.size());
        for (const glm::vec3& normal : surface.normals) {
            same.normals.push_back(unit_or_zero(normal));
        }
    }
    return same;
}

}  // namespace

RefinedSurface refine(const Surface& surface, const Refinement& refinement)
{
    if (refinement.levels == 0) {
        return unrefined(surface);
    }
    const int levels = refinement.levels;
    const Scheme scheme = refinement.scheme;
    if (scheme == Scheme::loop && std::any_of(surface.face_sizes.begin(), surface.face_sizes.end(), [](int n) { return n != 3; })) {
        throw Error("the Loop scheme needs triangles; triangulate the surface or use catmark");
    }
    const UvTopology uvs = share_uvs(surface);
    const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(surface, uvs, scheme);
    Far::TopologyRefiner::UniformOptions uniform(levels);
    uniform.fullTopologyInLastLevel = true;  // limit masks ask the last level for its neighborhoods
    refiner->RefineUniform(uniform);
    const Far::PrimvarRefiner primvars(*refiner);

    std::vector<Primvar<glm::vec3>> points(surface.positions.size());
    std::transform(surface.positions.begin(), surface.positions.end(), points.begin(),
                   [](const glm::vec3& p) { return Primvar<glm::vec3>{p}; });
    std::vector<Primvar<glm::vec2>> corner_uvs = uvs.values;
    for (int level = 1; level <= levels; ++level) {
        std::vector<Primvar<glm::vec3>> finer(refiner->GetLevel(level).GetNumVertices());
        primvars.Interpolate(level, points, finer);
        points = std::move(finer);
        std::vector<Primvar<glm::vec2>> finer_uvs(refiner->GetLevel(level).GetNumFVarValues(0));
        primvars.InterpolateFaceVarying(level, corner_uvs, finer_uvs, 0);
        corner_uvs = std::move(finer_uvs);
    }

    RefinedSurface refined;
    std::vector<Primvar<glm::vec3>> limit(points.size());
    std::vector<Primvar<glm::vec3>> tangent_1(points.size());
    std::vector<Primvar<glm::vec3>> tangent_2(points.size());
    primvars.Limit(points, limit, tangent_1, tangent_2);
    std::vector<Primvar<glm::vec2>> limit_uvs(corner_uvs.size());
    primvars.LimitFaceVarying(corner_uvs, limit_uvs, 0);
    refined.positions.resize(points.size());
    refined.normals.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        refined.positions[i] = limit[i].value;
        refined.normals[i] = unit_or_zero(glm::cross(tangent_1[i].value, tangent_2[i].value));
    }
    refined.uvs.reserve(limit_uvs.size());
    for (const Primvar<glm::vec2>& uv : limit_uvs) {
        refined.uvs.push_back(uv.value);
    }
    const Far::TopologyLevel& last = refiner->GetLevel(levels);
    for (int face = 0; face < last.GetNumFaces(); ++face) {
        const Far::ConstIndexArray vertices = last.GetFaceVertices(face);
        const Far::ConstIndexArray values = last.GetFaceFVarValues(face, 0);
        refined.face_sizes.push_back(vertices.size());
        refined.corners.insert(refined.corners.end(), vertices.begin(), vertices.end());
        refined.uv_corners.insert(refined.uv_corners.end(), values.begin(), values.end());
        int origin = face;
        for (int level = levels; level > 0; --level) {
            origin = refiner->GetLevel(level).GetFaceParentFace(origin);
        }
        refined.faces.push_back(origin);
    }
    return refined;
}

std::vector<float> refine_values(const Surface& surface, const Refinement& refinement, std::span<const float> values)
{
    if (refinement.levels == 0) {
        return {values.begin(), values.end()};
    }
    const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(surface, share_uvs(surface), refinement.scheme);
    Far::TopologyRefiner::UniformOptions uniform(refinement.levels);
    uniform.fullTopologyInLastLevel = true;  // limit masks ask the last level for its neighborhoods
    refiner->RefineUniform(uniform);
    const Far::PrimvarRefiner primvars(*refiner);
    std::vector<Primvar<float>> numbers(values.size());
    std::transform(values.begin(), values.end(), numbers.begin(), [](float value) { return Primvar<float>{value}; });
    for (int level = 1; level <= refinement.levels; ++level) {
        std::vector<Primvar<float>> finer(refiner->GetLevel(level).GetNumVertices());
        primvars.Interpolate(level, numbers, finer);
        numbers = std::move(finer);
    }
    std::vector<Primvar<float>> limit(numbers.size());
    primvars.Limit(numbers, limit);
    std::vector<float> result(limit.size());
    std::transform(limit.begin(), limit.end(), result.begin(), [](const Primvar<float>& number) { return number.value; });
    return result;
}

const void* opensubdiv_function()
{
    return reinterpret_cast<const void*>(&Far::SetErrorCallback);
}

}  // namespace mesoshell

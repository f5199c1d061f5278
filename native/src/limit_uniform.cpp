// Uniform refinement: every face split alike, level by level, and what OpenSubdiv's limit masks say of the last level.
#include "crowded.h"
#include "limit_exact.h"
#include "limit_masks.h"
#include "limit_patches.h"
#include "limit_refiner.h"

#include <algorithm>
#include <span>
#include <utility>

#include <opensubdiv/far/primvarRefiner.h>

namespace mesoshell {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// OpenSubdiv refines whatever has Clear and AddWithWeight. These write down what they are asked instead of summing it.
struct Point {
    std::uint32_t index;
};
struct SourcePoints {
    std::uint32_t first;
    Point operator[](int i) const { return {first + static_cast<std::uint32_t>(i)}; }
};

// Points of one level, whose rows are asked for in ascending order.
class RefinedPoints {
public:
    RefinedPoints(MaskRows<float>& rows, std::uint32_t first) : rows_(rows), first_(first) {}

    struct Writer : Point {
        RefinedPoints* owner;
        void Clear() { owner->begin_row(); }
        void AddWithWeight(const Point& source, float weight) { owner->rows_.add(source.index, weight); }
    };
    Writer operator[](int i) { return {{first_ + static_cast<std::uint32_t>(i)}, this}; }
    void finish()
    {
        if (begun_) {
            rows_.end_row();
        }
    }

private:
    void begin_row()
    {
        finish();
        begun_ = true;
    }
    MaskRows<float>& rows_;
    std::uint32_t first_;
    bool begun_ = false;
};

// One of the three masks of a limit point; the owner gathers them.
class LimitRecord {
public:
    struct Entry {
        std::uint32_t index;
        float weight;
    };
    struct Writer {
        LimitRecord* owner;
        void Clear();
        void AddWithWeight(const Point& source, float weight) { owner->entries[owner->count++] = {source.index, weight}; }
    };
    Writer operator[](int) { return {this}; }
    std::span<const Entry> row() const { return {entries.data(), count}; }

    std::vector<Entry> entries;  // as many as a mask may have, of which a point uses `count`
    std::size_t count = 0;
    class LimitRows* rows = nullptr;
    bool begins = false;  // its Clear is the first of a point's
};

class LimitRows {
public:
    LimitRows(MaskRows<LimitWeights>& rows, const ExactRows& exact, std::size_t most_entries) : rows_(rows), exact_(exact)
    {
        for (LimitRecord* record : {&position, &tangent_1, &tangent_2}) {
            record->entries.resize(most_entries);
        }
        position.rows = tangent_1.rows = tangent_2.rows = this;
        position.begins = true;
    }
    LimitRecord position, tangent_1, tangent_2;

    void finish()
    {
        if (!begun_) {
            return;
        }
        const auto exact = exact_.find(static_cast<std::uint32_t>(rows_.size()));
        if (exact != exact_.end()) {
            for (std::size_t i = 0; i < exact->second.vertices.size(); ++i) {
                rows_.add(exact->second.vertices[i], exact->second.weights[i]);
            }
            rows_.end_row();
            return;
        }
        const std::span<const LimitRecord::Entry> points = position.row();
        const std::span<const LimitRecord::Entry> first = tangent_1.row();
        const std::span<const LimitRecord::Entry> second = tangent_2.row();
        const bool together = std::equal(points.begin(), points.end(), first.begin(), first.end(),
                                         [](const auto& a, const auto& b) { return a.index == b.index; });
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::vec2 tangents = together ? glm::vec2(first[i].weight, second[i].weight) : glm::vec2(0.0f);
            rows_.add(points[i].index, {points[i].weight, tangents.x, tangents.y});
        }
        for (std::size_t i = 0; !together && i < first.size(); ++i) {
            if (first[i].weight != 0.0f || second[i].weight != 0.0f) {
                rows_.add(first[i].index, {0.0f, first[i].weight, second[i].weight});
            }
        }
        rows_.end_row();
    }
    void begin_point()
    {
        finish();
        begun_ = true;
        position.count = tangent_1.count = tangent_2.count = 0;
    }

private:
    MaskRows<LimitWeights>& rows_;
    const ExactRows& exact_;
    bool begun_ = false;
};

void LimitRecord::Writer::Clear()
{
    if (owner->begins) {
        owner->rows->begin_point();
    }
}

// Entries of a limit mask, at most: a vertex, and what its edges and faces lead to.
std::size_t most_around(const Far::TopologyLevel& level)
{
    int most = 0;
    for (int vertex = 0; vertex < level.GetNumVertices(); ++vertex) {
        most = std::max(most, level.GetVertexEdges(vertex).size() + level.GetVertexFaces(vertex).size());
    }
    return static_cast<std::size_t>(most) + 1;
}

LimitMasks masks_of(const Far::TopologyRefiner& refiner, Job& job)
{
    const Far::PrimvarRefiner primvars(refiner);
    LimitMasks masks;
    masks.vertices = static_cast<std::size_t>(refiner.GetLevel(0).GetNumVertices());
    // Quads inside a mesh have masks of 4, 4 and 9 points for every face, two edges and vertex, and limit masks of 9.
    const auto refined = static_cast<std::size_t>(refiner.GetNumVerticesTotal()) - masks.vertices;
    const auto last = static_cast<std::size_t>(refiner.GetLevel(refiner.GetMaxLevel()).GetNumVertices());
    masks.refinement.reserve(refined, refined * 11 / 2);
    masks.limit.reserve(last, last * 9 + last / 8);
    std::uint32_t before = 0;
    std::uint32_t first = static_cast<std::uint32_t>(masks.vertices);
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        job.throw_if_cancelled();
        const SourcePoints sources{before};
        RefinedPoints points(masks.refinement, first);
        primvars.Interpolate(level, sources, points);
        points.finish();
        // Points of faces come first, and those of edges and vertices are made of them.
        const int of_faces = refiner.GetLevel(level - 1).GetNumFaces();
        const bool has_face_points = refiner.GetSchemeType() != Sdc::SCHEME_LOOP;
        if (has_face_points) {
            masks.stretches.push_back(first - masks.vertices + static_cast<std::size_t>(of_faces));
        }
        before = first;
        first += static_cast<std::uint32_t>(refiner.GetLevel(level).GetNumVertices());
        masks.stretches.push_back(first - masks.vertices);
    }
    masks.last_level = before;
    const SourcePoints sources{before};
    const ExactRows exact = exact_limits(refiner);
    LimitRows rows(masks.limit, exact, most_around(refiner.GetLevel(refiner.GetMaxLevel())));
    primvars.Limit(sources, rows.position, rows.tangent_1, rows.tangent_2);
    rows.finish();
    masks.refinement.finish();
    masks.limit.finish();
    return masks;
}

struct UvPoint {
    glm::vec2 value{0.0f};
    void Clear() { value = glm::vec2(0.0f); }
    void AddWithWeight(const UvPoint& other, float weight) { value += other.value * weight; }
};

std::vector<glm::vec2> refined_uvs(const Far::TopologyRefiner& refiner, const std::vector<glm::vec2>& values)
{
    const Far::PrimvarRefiner primvars(refiner);
    std::vector<UvPoint> uvs(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        uvs[i].value = values[i];
    }
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<UvPoint> finer(static_cast<std::size_t>(refiner.GetLevel(level).GetNumFVarValues(0)));
        primvars.InterpolateFaceVarying(level, uvs, finer, 0);
        uvs = std::move(finer);
    }
    std::vector<UvPoint> limit(uvs.size());
    primvars.LimitFaceVarying(uvs, limit, 0);
    std::vector<glm::vec2> refined(limit.size());
    for (std::size_t i = 0; i < limit.size(); ++i) {
        refined[i] = limit[i].value;
    }
    return refined;
}

// Without the faces that come from those of the mesh from `most` on.
RefinedTopology last_level(const Far::TopologyRefiner& refiner, std::size_t most)
{
    RefinedTopology topology;
    std::vector<std::int32_t> origins(static_cast<std::size_t>(refiner.GetLevel(0).GetNumFaces()));
    for (std::size_t face = 0; face < origins.size(); ++face) {
        origins[face] = static_cast<std::int32_t>(face);
    }
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        const Far::TopologyLevel& finer = refiner.GetLevel(level);
        topology.faces.resize(static_cast<std::size_t>(finer.GetNumFaces()));
        for (int face = 0; face < finer.GetNumFaces(); ++face) {
            topology.faces[face] = origins[finer.GetFaceParentFace(face)];
        }
        origins = topology.faces;
    }
    // Faces keep the order of those they come from.
    topology.faces.erase(std::lower_bound(topology.faces.begin(), topology.faces.end(), static_cast<std::int32_t>(most)),
                         topology.faces.end());
    const Far::TopologyLevel& last = refiner.GetLevel(refiner.GetMaxLevel());
    topology.face_sizes.reserve(topology.faces.size());
    topology.corners.reserve(static_cast<std::size_t>(last.GetNumFaceVertices()));
    topology.uv_corners.reserve(static_cast<std::size_t>(last.GetNumFaceVertices()));
    for (int face = 0; face < static_cast<int>(topology.faces.size()); ++face) {
        const Far::ConstIndexArray vertices = last.GetFaceVertices(face);
        const Far::ConstIndexArray values = last.GetFaceFVarValues(face, 0);
        topology.face_sizes.push_back(vertices.size());
        topology.corners.insert(topology.corners.end(), vertices.begin(), vertices.end());
        topology.uv_corners.insert(topology.uv_corners.end(), values.begin(), values.end());
    }
    return topology;
}

// Whether all faces at a vertex have one tangent plane in the limit: creases that patches resolve are smooth there.
bool has_one_plane(const Far::TopologyRefiner& refiner, const Far::TopologyLevel& level, int vertex)
{
    const int faces = level.GetVertexFaces(vertex).size();
    if (refiner.GetSchemeType() == Sdc::SCHEME_BILINEAR || level.IsVertexNonManifold(vertex) || faces == 0) {
        return false;
    }
    if (faces == 1) {  // at a rounded corner the tangents of the face's two edges are those of the boundary: parallel
        return level.GetVertexRule(vertex) != Sdc::Crease::RULE_CREASE;
    }
    if (level.GetVertexRule(vertex) == Sdc::Crease::RULE_SMOOTH) {
        return true;
    }
    const auto stays_sharp = [&](float left) {
        return left > 0.0f && left + static_cast<float>(refiner.GetMaxLevel()) > sharp_levels;
    };
    if (stays_sharp(level.GetVertexSharpness(vertex))) {
        return false;
    }
    int creases = 0;  // one alone is a dart
    for (const int edge : level.GetVertexEdges(vertex)) {
        creases += level.GetEdgeFaces(edge).size() > 1 && stays_sharp(level.GetEdgeSharpness(edge)) ? 1 : 0;
    }
    return creases == 0 || (creases == 1 && !level.IsVertexBoundary(vertex));
}

class UniformEvaluator : public LimitEvaluator {
public:
    explicit UniformEvaluator(LimitMasks masks) : masks_(std::move(masks)) {}

    LimitPoints evaluate(std::span<const glm::vec3> positions, Job& job) const override
    {
        std::vector<glm::vec3> with_fan;
        LimitFrames frames = apply_masks(masks_, filled(positions, with_fan), job);
        return {std::move(frames.positions), {}, std::move(frames.tangents)};
    }
    std::vector<float> interpolate(std::span<const float> values, Job& job) const override
    {
        std::vector<float> with_fan;
        return apply_masks(masks_, filled(values, with_fan), job);
    }
    std::size_t bytes() const override { return masks_.bytes(); }

private:
    // The vertices of a fan beside the mesh (crowded.h) may be anywhere.
    template <typename Value>
    std::span<const Value> filled(std::span<const Value> values, std::vector<Value>& with_fan) const
    {
        if (values.size() == masks_.vertices) {
            return values;
        }
        with_fan.assign(values.begin(), values.end());
        with_fan.resize(masks_.vertices, Value(0.0f));
        return with_fan;
    }

    LimitMasks masks_;
};

std::unique_ptr<Far::TopologyRefiner> refined_to_level(const Surface& surface, const UvTopology& uvs, const Refinement& refinement)
{
    std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(surface, uvs, refinement);
    Far::TopologyRefiner::UniformOptions uniform(refinement.levels);
    uniform.fullTopologyInLastLevel = true;  // limit masks ask the last level for its neighborhoods
    uniform.orderVerticesFromFacesFirst = true;
    refiner->RefineUniform(uniform);
    return refiner;
}

}  // namespace

Refined refine_uniformly(const Surface& surface, const Refinement& refinement, Job& job)
{
    UvTopology uvs = share_uvs(surface);
    std::unique_ptr<Far::TopologyRefiner> refiner = refined_to_level(surface, uvs, refinement);
    if (const int valence = missing_valence(*refiner); valence > 0) {
        const SurfaceWithFan with_fan(surface, valence);
        uvs = share_uvs(with_fan.surface());
        refiner = refined_to_level(with_fan.surface(), uvs, refinement);
    }
    job.throw_if_cancelled();

    Refined refined;
    refined.topology = last_level(*refiner, surface.face_sizes.size());
    refined.topology.uvs = refined_uvs(*refiner, uvs.values);
    const Far::TopologyLevel& last = refiner->GetLevel(refinement.levels);
    refined.sharp.resize(static_cast<std::size_t>(last.GetNumVertices()));
    for (int vertex = 0; vertex < last.GetNumVertices(); ++vertex) {
        refined.sharp[vertex] = !has_one_plane(*refiner, last, vertex);
    }
    refined.evaluator = std::make_unique<const UniformEvaluator>(masks_of(*refiner, job));
    return refined;
}

}  // namespace mesoshell

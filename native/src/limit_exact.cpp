#include "limit_exact.h"

#include <algorithm>

#include "limit_patches.h"

namespace mesoshell {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// Patches close in on a dart slowly: some thousandth of an edge is left.
constexpr int dart_levels = 10;

class ExactLimits {
public:
    explicit ExactLimits(const Far::TopologyRefiner& refiner)
        : refiner_(refiner), mesh_(refiner.GetLevel(0)), last_(refiner.GetLevel(refiner.GetMaxLevel())),
          patches_(refiner, patch_options().SetApproxLevelSmooth(dart_levels))
    {
    }

    ExactRows run()
    {
        for (int edge = 0; edge < mesh_.GetNumEdges(); ++edge) {
            if (is_semi_sharp(mesh_.GetEdgeSharpness(edge))) {
                add_along(edge);
            }
        }
        for (int vertex = 0; vertex < mesh_.GetNumVertices(); ++vertex) {
            if (mesh_.GetVertexFaces(vertex).size() > 0 && may_be_off(vertex)) {
                const int face = mesh_.GetVertexFaces(vertex)[0];
                const Far::ConstIndexArray vertices = mesh_.GetFaceVertices(face);
                const int i = static_cast<int>(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin());
                add(descendant(vertex), face, i, 0.0f);
            }
        }
        return std::move(rows_);
    }

private:
    static bool is_semi_sharp(float sharpness) { return sharpness > 0.0f && sharpness < Sdc::Crease::SHARPNESS_INFINITE; }

    bool may_be_off(int vertex) const
    {
        return is_semi_sharp(mesh_.GetVertexSharpness(vertex)) || mesh_.GetVertexRule(vertex) == Sdc::Crease::RULE_DART;
    }

    // Whether the last level's mask of a vertex is not the limit.
    bool is_off(int vertex) const
    {
        if (last_.GetVertexRule(vertex) == Sdc::Crease::RULE_DART || is_semi_sharp(last_.GetVertexSharpness(vertex))) {
            return true;
        }
        const Far::ConstIndexArray edges = last_.GetVertexEdges(vertex);
        return std::any_of(edges.begin(), edges.end(),
                           [&](int edge) { return is_semi_sharp(last_.GetEdgeSharpness(edge)); });
    }

    int descendant(int vertex) const
    {
        for (int level = 0; level < refiner_.GetMaxLevel(); ++level) {
            vertex = refiner_.GetLevel(level).GetVertexChildVertex(vertex);
        }
        return vertex;
    }

    // The vertices of the last level on an edge of the mesh, from end to end.
    void add_along(int edge)
    {
        const Far::ConstIndexArray ends = mesh_.GetEdgeVertices(edge);
        std::vector<int> line{ends[0], ends[1]};
        for (int level = 0; level < refiner_.GetMaxLevel(); ++level) {
            const Far::TopologyLevel& coarse = refiner_.GetLevel(level);
            std::vector<int> finer{coarse.GetVertexChildVertex(line[0])};
            for (std::size_t i = 1; i < line.size(); ++i) {
                const int part = coarse.FindEdge(line[i - 1], line[i]);
                if (part < 0) {
                    return;
                }
                finer.push_back(coarse.GetEdgeChildVertex(part));
                finer.push_back(coarse.GetVertexChildVertex(line[i]));
            }
            line = std::move(finer);
        }
        const int face = mesh_.GetEdgeFaces(edge)[0];
        const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
        const int i = static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
        const bool forward = mesh_.GetFaceVertices(face)[i] == ends[0];
        for (std::size_t k = 0; k < line.size(); ++k) {
            const float share = static_cast<float>(k) / static_cast<float>(line.size() - 1);
            add(line[k], face, i, forward ? share : 1.0f - share);
        }
    }

    // The point at `share` along an edge of a face.
    void add(int vertex, int face, int edge, float share)
    {
        if (!is_off(vertex) || rows_.contains(static_cast<std::uint32_t>(vertex))) {
            return;
        }
        if (face != face_) {
            face_ = face;
            has_patch_ = patches_take(mesh_, face) && patches_.InitVertexSurface(face, &patch_);
        }
        if (!has_patch_) {
            return;
        }
        const auto count = static_cast<std::size_t>(patch_.GetNumControlPoints());
        std::vector<int> controls(count);
        patch_.GetControlPointIndices(controls.data());
        float place[2];
        patch_.GetParameterization().GetEdgeCoord(edge, share, place);
        std::vector<float> position(count);
        std::vector<float> along_u(count);
        std::vector<float> along_v(count);
        patch_.EvaluateStencil(place, position.data(), along_u.data(), along_v.data());
        ExactRow& row = rows_[static_cast<std::uint32_t>(vertex)];
        for (std::size_t i = 0; i < count; ++i) {
            row.vertices.push_back(static_cast<std::uint32_t>(controls[i]));
            row.weights.push_back({position[i], along_u[i], along_v[i]});
        }
    }

    const Far::TopologyRefiner& refiner_;
    const Far::TopologyLevel& mesh_;
    const Far::TopologyLevel& last_;
    PatchFactory patches_;
    Patch patch_;
    int face_ = -1;
    bool has_patch_ = false;
    ExactRows rows_;
};

}  // namespace

ExactRows exact_limits(const Far::TopologyRefiner& refiner)
{
    return ExactLimits(refiner).run();
}

}  // namespace mesoshell

// Adaptive refinement: every edge has as many parts as its length asks for, and each face joins those of its edges. An
// edge's points belong to the edge and are evaluated once, so that faces beside it meet without a crack.
#include "limit_refiner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <opensubdiv/bfr/tessellation.h>

#include "edge_measure.h"
#include "limit_samples.h"
#include "mesoshell/shell.h"
#include "parallel.h"

namespace mesoshell {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr int default_levels = 6;

// Rates of a face as Bfr::Tessellation takes them: one an edge, then those of the inside.
using Rates = std::vector<int>;

class AdaptiveRefinement {
public:
    AdaptiveRefinement(const Surface& surface, const Refinement& refinement)
        : surface_(surface), measure_(refinement),
          most_parts_(1 << (refinement.levels > 0 ? refinement.levels : default_levels)),
          uvs_(share_uvs(surface)), refiner_(make_refiner(surface, uvs_, refinement)), mesh_(refiner_->GetLevel(0)),
          factory_(*refiner_, patch_options())
    {
    }

    Refined run(Job& job)
    {
        make_patches(job);
        rate_edges(job);
        rate_insides(job);
        count(job);
        Refined refined;
        refined.sharp = sharp_points();
        fill(refined.topology, job);
        refined.evaluator = evaluate_samples(std::move(patches_), std::move(samples_), points_);
        return refined;
    }

private:
    void make_patches(Job& job)
    {
        patches_.resize(static_cast<std::size_t>(mesh_.GetNumFaces()));
        for_faces(job, mesh_.GetNumFaces(), [&](int face) {
            if (!patches_take(mesh_, face)) {
                throw Error("face " + std::to_string(face) +
                            " of the surface has too many creases around for adaptive refinement; refine to a level");
            }
            if (!factory_.InitVertexSurface(face, &patches_[face])) {
                throw Error("face " + std::to_string(face) +
                            " of the surface has no limit surface; repair the faces around it, or refine to a level");
            }
        });
    }

    // The parts of a curve on a patch, from one place to another: as few as keep each within the measure.
    template <typename Place>
    int parts_of(const PatchOver<glm::vec3>& patch, const Place& place) const
    {
        int parts = std::min(2, most_parts_);
        for (;;) {
            glm::vec3 before = patch.at(place(0.0f));
            float longest = 0.0f;
            float whole = 0.0f;
            for (int i = 1; i <= parts; ++i) {
                const glm::vec3 after = patch.at(place(static_cast<float>(i) / static_cast<float>(parts)));
                const float length = measure_(before, after);
                longest = std::max(longest, length);
                whole += length;
                before = after;
            }
            if (parts == 2 && whole <= 1.0f) {
                return 1;
            }
            if (!(longest > 1.0f) || parts == most_parts_) {
                return parts;
            }
            const float asked = std::ceil(std::max(whole, static_cast<float>(parts + 1)));
            parts = asked < static_cast<float>(most_parts_) ? static_cast<int>(asked) : most_parts_;
        }
    }

    bool owns_edge(int face, int edge) const { return mesh_.GetEdgeFaces(edge)[0] == face; }

    void rate_edges(Job& job)
    {
        edge_rates_.assign(static_cast<std::size_t>(mesh_.GetNumEdges()), 1);
        for_faces(job, mesh_.GetNumFaces(), [&](int face) {
            const PatchOver<glm::vec3> patch(patches_[face], surface_.positions);
            const Bfr::Parameterization param = patches_[face].GetParameterization();
            const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
            for (int i = 0; i < edges.size(); ++i) {
                if (owns_edge(face, edges[i])) {
                    edge_rates_[edges[i]] = parts_of(patch, [&](float t) {
                        glm::vec2 place;
                        param.GetEdgeCoord(i, t, &place.x);
                        return place;
                    });
                }
            }
        });
    }

    // The inside has at least as many parts as the edges beside it, and as its own middle lines ask for.
    void rate_insides(Job& job)
    {
        rates_.resize(static_cast<std::size_t>(mesh_.GetNumFaces()));
        for_faces(job, mesh_.GetNumFaces(), [&](int face) {
            const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
            Rates& rates = rates_[face];
            for (const int edge : edges) {
                rates.push_back(edge_rates_[edge]);
            }
            const Bfr::Parameterization param = patches_[face].GetParameterization();
            const PatchOver<glm::vec3> patch(patches_[face], surface_.positions);
            if (param.GetType() == Bfr::Parameterization::QUAD) {
                const int along_u = parts_of(patch, [](float t) { return glm::vec2(t, 0.5f); });
                const int along_v = parts_of(patch, [](float t) { return glm::vec2(0.5f, t); });
                rates.push_back(std::max({rates[0], rates[2], along_u}));
                rates.push_back(std::max({rates[1], rates[3], along_v}));
            } else {
                rates.push_back(*std::max_element(rates.begin(), rates.end()));
            }
        });
    }

    Bfr::Tessellation tessellation(int face) const
    {
        return Bfr::Tessellation(patches_[face].GetParameterization(), static_cast<int>(rates_[face].size()),
                                 rates_[face].data(),
                                 Bfr::Tessellation::Options().SetFacetSize(4).PreserveQuads(true));
    }

    // Where the points of edges and faces begin: vertices of the mesh, then edges in turn, then insides of faces in turn.
    // UVs alike, but an edge has its points once for every two UVs that its ends have.
    void count(Job& job)
    {
        const int faces = mesh_.GetNumFaces();
        face_points_.assign(static_cast<std::size_t>(faces) + 1, 0);
        face_uvs_.assign(static_cast<std::size_t>(faces) + 1, 0);
        face_facets_.assign(static_cast<std::size_t>(faces) + 1, 0);
        for_faces(job, faces, [&](int face) {
            const Bfr::Tessellation pattern = tessellation(face);
            face_points_[face + 1] = static_cast<std::size_t>(pattern.GetNumInteriorCoords());
            face_facets_[face + 1] = static_cast<std::size_t>(pattern.GetNumFacets());
        });
        std::size_t points = static_cast<std::size_t>(mesh_.GetNumVertices());
        std::size_t uvs = uvs_.values.size();
        edge_points_.resize(edge_rates_.size());
        edge_uvs_.resize(edge_rates_.size());
        for (int edge = 0; edge < mesh_.GetNumEdges(); ++edge) {
            edge_points_[edge] = points;
            points += static_cast<std::size_t>(edge_rates_[edge] - 1);
            for (const int face : mesh_.GetEdgeFaces(edge)) {
                const UvSide side = side_of(face, edge);
                const auto same = [&](const UvSide& other) { return other.ends == side.ends; };
                if (std::none_of(edge_uvs_[edge].begin(), edge_uvs_[edge].end(), same)) {
                    edge_uvs_[edge].push_back({side.ends, face, uvs});
                    uvs += static_cast<std::size_t>(edge_rates_[edge] - 1);
                }
            }
        }
        face_points_[0] = points;
        face_uvs_[0] = uvs;
        for (int face = 0; face < faces; ++face) {
            face_uvs_[face + 1] = face_uvs_[face] + face_points_[face + 1];
            face_points_[face + 1] += face_points_[face];
            face_facets_[face + 1] += face_facets_[face];
            check_prisms(face_facets_[face + 1]);
        }
        points_ = face_points_.back();
    }

    static void check_prisms(std::size_t prisms)
    {
        if (prisms > static_cast<std::size_t>(most_prisms)) {
            throw InvalidArgument("the shell would have more than " + std::to_string(most_prisms) +
                                  " prisms; allow longer edges, fewer levels or use a coarser mesh");
        }
    }

    // The UVs at the ends of an edge in one face, in the edge's own direction.
    struct UvSide {
        std::array<int, 2> ends;
        int face;           // evaluates them
        std::size_t first;  // of the edge's points
    };
    UvSide side_of(int face, int edge) const
    {
        const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
        const int i = static_cast<int>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
        const Far::ConstIndexArray values = mesh_.GetFaceFVarValues(face, 0);
        const int a = values[i];
        const int b = values[(i + 1) % edges.size()];
        return forward(face, i) ? UvSide{{a, b}, face, 0} : UvSide{{b, a}, face, 0};
    }
    // Whether a face runs along its edge in the edge's own direction.
    bool forward(int face, int i) const
    {
        return mesh_.GetFaceVertices(face)[i] == mesh_.GetEdgeVertices(mesh_.GetFaceEdges(face)[i])[0];
    }

    // Points around a face in the order of its boundary: each vertex, then those of the edge that begins there.
    template <typename At, typename First>
    std::vector<int> boundary(int face, const At& at_vertex, const First& first_of_edge) const
    {
        std::vector<int> points;
        const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
        for (int i = 0; i < edges.size(); ++i) {
            points.push_back(at_vertex(i));
            const int inner = edge_rates_[edges[i]] - 1;
            const int first = static_cast<int>(first_of_edge(i));
            for (int k = 0; k < inner; ++k) {
                points.push_back(forward(face, i) ? first + k : first + inner - 1 - k);
            }
        }
        return points;
    }

    void fill(RefinedTopology& topology, Job& job)
    {
        const int faces = mesh_.GetNumFaces();
        std::vector<std::vector<std::int32_t>> corners(static_cast<std::size_t>(faces));
        std::vector<std::vector<std::int32_t>> uv_corners(static_cast<std::size_t>(faces));
        std::vector<std::vector<LimitSample>> samples(static_cast<std::size_t>(faces));
        // Of several faces at a vertex, or a UV, the first evaluates it.
        std::vector<int> vertex_owner(static_cast<std::size_t>(mesh_.GetNumVertices()), -1);
        std::vector<int> uv_owner(uvs_.values.size(), -1);
        for (int face = faces - 1; face >= 0; --face) {
            for (const int vertex : mesh_.GetFaceVertices(face)) {
                vertex_owner[vertex] = face;
            }
            for (const int value : mesh_.GetFaceFVarValues(face, 0)) {
                uv_owner[value] = face;
            }
        }
        topology.uvs.resize(face_uvs_.back());
        const std::span<const glm::vec2> values(uvs_.values);
        for_faces(job, faces, [&](int face) {
            const Bfr::Tessellation pattern = tessellation(face);
            std::vector<glm::vec2> places(static_cast<std::size_t>(pattern.GetNumCoords()));
            pattern.GetCoords(&places.data()->x);
            const Far::ConstIndexArray vertices = mesh_.GetFaceVertices(face);
            const Far::ConstIndexArray edges = mesh_.GetFaceEdges(face);
            const Far::ConstIndexArray uv_values = mesh_.GetFaceFVarValues(face, 0);
            const auto uv_side = [&](int i) -> const UvSide& {
                const UvSide side = side_of(face, edges[i]);
                return *std::find_if(edge_uvs_[edges[i]].begin(), edge_uvs_[edges[i]].end(),
                                     [&](const UvSide& other) { return other.ends == side.ends; });
            };
            const std::vector<int> points =
                boundary(face, [&](int i) { return vertices[i]; }, [&](int i) { return edge_points_[edges[i]]; });
            const std::vector<int> uvs = boundary(face, [&](int i) { return uv_values[i]; },
                                                  [&](int i) { return uv_side(i).first; });

            Patch uv_patch;
            if (!factory_.InitFaceVaryingSurface(face, &uv_patch)) {
                throw Error("face " + std::to_string(face) + " of the surface has no limit of its UVs; unwrap it again");
            }
            const PatchOver<glm::vec2> uv_at(uv_patch, values);
            std::size_t k = 0;
            for (int i = 0; i < edges.size(); ++i) {
                const bool evaluates_uvs = uv_side(i).face == face;
                for (int part = 0; part < edge_rates_[edges[i]]; ++part, ++k) {
                    if (part == 0 ? vertex_owner[vertices[i]] == face : owns_edge(face, edges[i])) {
                        samples[face].push_back({static_cast<std::uint32_t>(points[k]), places[k]});
                    }
                    if (part == 0 ? uv_owner[uv_values[i]] == face : evaluates_uvs) {
                        topology.uvs[uvs[k]] = uv_at.at(places[k]);
                    }
                }
            }
            for (std::size_t inner = 0; k < places.size(); ++k, ++inner) {
                samples[face].push_back({static_cast<std::uint32_t>(face_points_[face] + inner), places[k]});
                topology.uvs[face_uvs_[face] + inner] = uv_at.at(places[k]);
            }
            std::vector<int> facets(4 * static_cast<std::size_t>(pattern.GetNumFacets()));
            pattern.GetFacets(facets.data());
            const auto mapped = [&](const std::vector<int>& around, std::size_t first_inner) {
                std::vector<std::int32_t> result(facets.size());
                std::transform(facets.begin(), facets.end(), result.begin(), [&](int i) {
                    if (i < 0) {
                        return -1;
                    }
                    const auto index = static_cast<std::size_t>(i);
                    return index < around.size() ? around[index]
                                                 : static_cast<std::int32_t>(first_inner + index - around.size());
                });
                return result;
            };
            corners[face] = mapped(points, face_points_[face]);
            uv_corners[face] = mapped(uvs, face_uvs_[face]);
        });

        topology.corners.reserve(4 * face_facets_.back());
        topology.uv_corners.reserve(4 * face_facets_.back());
        samples_.firsts.push_back(0);
        for (int face = 0; face < faces; ++face) {
            for (std::size_t i = 0; i < corners[face].size(); i += 4) {
                const int size = corners[face][i + 3] < 0 ? 3 : 4;
                topology.face_sizes.push_back(size);
                topology.faces.push_back(face);
                topology.corners.insert(topology.corners.end(), corners[face].begin() + i, corners[face].begin() + i + size);
                topology.uv_corners.insert(topology.uv_corners.end(), uv_corners[face].begin() + i,
                                           uv_corners[face].begin() + i + size);
            }
            samples_.all.insert(samples_.all.end(), samples[face].begin(), samples[face].end());
            samples_.firsts.push_back(samples_.all.size());
        }
        check_prisms(topology.corners.size() - 2 * topology.face_sizes.size());
    }

    // Points on edges that stay sharp in the limit, and their ends; what has no faces has no plane either.
    std::vector<bool> sharp_points() const
    {
        std::vector<bool> sharp(points_, false);
        const bool linear = refiner_->GetSchemeType() == Sdc::SCHEME_BILINEAR;
        std::vector<int> creases(static_cast<std::size_t>(mesh_.GetNumVertices()), 0);
        for (int edge = 0; edge < mesh_.GetNumEdges(); ++edge) {
            const bool inside = mesh_.GetEdgeFaces(edge).size() > 1;
            if (inside && (linear || mesh_.GetEdgeSharpness(edge) > sharp_levels)) {
                std::fill_n(sharp.begin() + static_cast<std::ptrdiff_t>(edge_points_[edge]), edge_rates_[edge] - 1, true);
                for (const int vertex : mesh_.GetEdgeVertices(edge)) {
                    ++creases[vertex];
                }
            }
        }
        for (int vertex = 0; vertex < mesh_.GetNumVertices(); ++vertex) {
            const int faces = mesh_.GetVertexFaces(vertex).size();
            // a crease that ends in the surface is a dart, which is smooth
            const int ends = mesh_.IsVertexBoundary(vertex) ? 0 : 1;
            // its tangents are parallel
            const bool rounded = faces == 1 && mesh_.GetVertexRule(vertex) == Sdc::Crease::RULE_CREASE;
            sharp[vertex] = linear || faces == 0 || rounded || mesh_.IsVertexNonManifold(vertex) || creases[vertex] > ends ||
                            (mesh_.GetVertexSharpness(vertex) > sharp_levels && faces > 1);
        }
        return sharp;
    }

    const Surface& surface_;
    EdgeMeasure measure_;
    int most_parts_;
    UvTopology uvs_;
    std::unique_ptr<Far::TopologyRefiner> refiner_;
    const Far::TopologyLevel& mesh_;
    PatchFactory factory_;
    std::vector<Patch> patches_;
    std::vector<int> edge_rates_;
    std::vector<Rates> rates_;
    std::vector<std::size_t> edge_points_;  // the first of each edge
    std::vector<std::vector<UvSide>> edge_uvs_;
    std::vector<std::size_t> face_points_;  // the first inside each face, and the end
    std::vector<std::size_t> face_uvs_;
    std::vector<std::size_t> face_facets_;
    std::size_t points_ = 0;
    LimitSamples samples_;
};

}  // namespace

Refined refine_adaptively(const Surface& surface, const Refinement& refinement, Job& job)
{
    check_valences(surface, most_patch_faces,
                   "adaptive refinement takes up to " + std::to_string(most_patch_faces) +
                       "; split it or refine to a level instead");
    return AdaptiveRefinement(surface, refinement).run(job);
}

}  // namespace mesoshell

// Another path to the limit surface: OpenSubdiv's Far patch tables, evaluated at places of the mesh's faces.
#pragma once

#include <memory>
#include <vector>

#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/ptexIndices.h>

#include "limit_refiner.h"

namespace mesoshell {

// Refines adaptively around what is irregular, `isolation` levels deep, and evaluates bicubic patches and Gregory patches.
// Exact at regular places; near extraordinary points an approximation that a deeper isolation improves.
class LimitOracle {
public:
    struct Frame {
        glm::vec3 position{0.0f};
        glm::vec3 along_u{0.0f};
        glm::vec3 along_v{0.0f};
    };

    LimitOracle(const Surface& surface, const Refinement& refinement, int isolation = 8)
    {
        namespace Far = OpenSubdiv::Far;
        const UvTopology uvs = share_uvs(surface);
        refiner_ = make_refiner(surface, uvs, refinement);
        Far::PatchTableFactory::Options options(static_cast<unsigned>(isolation));
        options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
        options.useInfSharpPatch = true;
        refiner_->RefineAdaptive(options.GetRefineAdaptiveOptions());
        table_.reset(Far::PatchTableFactory::Create(*refiner_, options));
        map_ = std::make_unique<Far::PatchMap>(*table_);
        ptex_ = std::make_unique<Far::PtexIndices>(*refiner_);

        points_.resize(static_cast<std::size_t>(refiner_->GetNumVerticesTotal() + table_->GetNumLocalPoints()));
        for (std::size_t i = 0; i < surface.positions.size(); ++i) {
            points_[i].value = surface.positions[i];
        }
        const Far::PrimvarRefiner primvars(*refiner_);
        Point* source = points_.data();
        for (int level = 1; level <= refiner_->GetMaxLevel(); ++level) {
            Point* finer = source + refiner_->GetLevel(level - 1).GetNumVertices();
            primvars.Interpolate(level, source, finer);
            source = finer;
        }
        table_->ComputeLocalPointValues(points_.data(), points_.data() + refiner_->GetNumVerticesTotal());
    }

    // (u, v) of a quad runs from its first corner along its first edge and its last.
    Frame at(int face, float u, float v) const
    {
        const auto* handle = map_->FindPatch(ptex_->GetFaceId(face), u, v);
        float position[20], along_u[20], along_v[20];
        table_->EvaluateBasis(*handle, u, v, position, along_u, along_v);
        const auto controls = table_->GetPatchVertices(*handle);
        Frame frame;
        for (int i = 0; i < controls.size(); ++i) {
            const glm::vec3& p = points_[static_cast<std::size_t>(controls[i])].value;
            frame.position += p * position[i];
            frame.along_u += p * along_u[i];
            frame.along_v += p * along_v[i];
        }
        return frame;
    }

private:
    struct Point {
        glm::vec3 value{0.0f};
        void Clear() { value = glm::vec3(0.0f); }
        void AddWithWeight(const Point& other, float weight) { value += other.value * weight; }
    };
    std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> refiner_;
    std::unique_ptr<OpenSubdiv::Far::PatchTable> table_;
    std::unique_ptr<OpenSubdiv::Far::PatchMap> map_;
    std::unique_ptr<OpenSubdiv::Far::PtexIndices> ptex_;
    std::vector<Point> points_;
};

}  // namespace mesoshell

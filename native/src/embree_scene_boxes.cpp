#include "embree_scene.h"
#include "embree_scene_api.h"

namespace mesoshell {
namespace {

void box_bounds(const RTCBoundsFunctionArguments* args)
{
    const BoxScene::Box& box = static_cast<const BoxScene::Box*>(args->geometryUserPtr)[args->primID];
    *args->bounds_o = {box.lower.x, box.lower.y, box.lower.z, 0.0f, box.upper.x, box.upper.y, box.upper.z, 0.0f};
}

void box_intersect(const RTCIntersectFunctionNArguments* args)
{
    if (args->valid[0] != -1) {
        return;
    }
    const auto& visit = *static_cast<const BoxScene::Visit*>(reinterpret_cast<Query*>(args->context)->payload);
    auto& ray = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const float t = visit(args->primID, ray.ray.tfar);
    if (t < ray.ray.tfar) {
        ray.ray.tfar = t;
        ray.hit.geomID = args->geomID;
        ray.hit.primID = args->primID;
    }
}

}  // namespace

BoxScene::BoxScene(std::span<const Box> boxes)
    : handles_(std::make_unique<EmbreeHandles>()), boxes_(boxes.begin(), boxes.end())
{
    RTCDevice device = shared_device();
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned int>(boxes_.size()));
    rtcSetGeometryUserData(geometry, boxes_.data());
    rtcSetGeometryBoundsFunction(geometry, box_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, box_intersect);
    rtcCommitGeometry(geometry);
    handles_->scene = rtcNewScene(device);
    rtcAttachGeometry(handles_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(handles_->scene);
    throw_on_error();
}

BoxScene::~BoxScene() = default;

void BoxScene::visit_along(const glm::vec3& origin, const glm::vec3& dir, float tnear, const Visit& visit, float tfar) const
{
    if (!is_ray(origin, dir, tnear, tfar)) {
        return;
    }
    Query query(false);
    query.payload = const_cast<Visit*>(&visit);
    RTCRayHit ray = make_ray(origin, dir, tnear, tfar);
    trace1(handles_->scene, query, ray);
}

}  // namespace mesoshell

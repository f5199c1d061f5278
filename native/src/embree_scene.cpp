#include "embree_scene.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "closest_point.h"
#include "embree_scene_api.h"
#include "mesoshell/libraries.h"

namespace mesoshell {
namespace {

static_assert(sizeof(RayPacket16) >= sizeof(RTCRayHit16));
static_assert(offsetof(RayPacket16, tfar) == offsetof(RTCRay16, tfar));
static_assert(offsetof(RayPacket16, normal_x) == offsetof(RTCRayHit16, hit));
static_assert(offsetof(RayPacket16, geometry) - offsetof(RayPacket16, normal_x) == offsetof(RTCHit16, geomID));
static_assert(offsetof(RayPacket16, instance) - offsetof(RayPacket16, normal_x) == offsetof(RTCHit16, instID));

// Counts a surface and lets the ray go on.
void count_filter(const RTCFilterFunctionNArguments* args)
{
    auto& crossings = *static_cast<TriangleScene::Crossings*>(reinterpret_cast<Query*>(args->context)->payload);
    for (unsigned int i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) {
            continue;
        }
        const float along = RTCHitN_Ng_x(args->hit, args->N, i) * RTCRayN_dir_x(args->ray, args->N, i) +
                            RTCHitN_Ng_y(args->hit, args->N, i) * RTCRayN_dir_y(args->ray, args->N, i) +
                            RTCHitN_Ng_z(args->hit, args->N, i) * RTCRayN_dir_z(args->ray, args->N, i);
        crossings.count += 1;
        crossings.winding += along > 0.0f ? 1 : -1;
        args->valid[i] = 0;
    }
}

struct NearestQuery {
    const glm::vec3* corners;
    const glm::vec3* offsets;  // null without a lattice
    glm::vec3 point;
    NearestPoint nearest;
    std::uint32_t copy = 0;  // of the nearest triangle
};

bool nearest_callback(RTCPointQueryFunctionArguments* args)
{
    auto& query = *static_cast<NearestQuery*>(args->userPtr);
    const glm::vec3* corner = query.corners + 3 * static_cast<std::size_t>(args->primID);
    glm::vec3 point = query.point;
    std::uint32_t copy = 0;
    if (query.offsets != nullptr && args->context->instStackSize > 0) {
        copy = args->context->instID[0];
        point -= query.offsets[copy];
    }
    const TrianglePoint found = closest_point(point, corner[0], corner[1], corner[2]);
    NearestPoint& nearest = query.nearest;
    const auto place = std::pair(args->primID, copy);
    if (!(found.squared < nearest.squared) &&
        !(found.squared == nearest.squared && place < std::pair(nearest.triangle, query.copy))) {
        return false;
    }
    nearest = {args->primID, found.weights, found.squared};
    query.copy = copy;
    // A little more than the distance, so that triangles at the same one are visited too.
    args->query->radius = std::sqrt(found.squared) * 1.00001f + 1e-12f;
    return true;
}

// Filters cost every ray a test, so only scenes that count have them.
RTCSceneFlags flags_for(TriangleScene::Use use)
{
    const int filter = use == TriangleScene::Use::crossings ? filter_scene_flag : RTC_SCENE_FLAG_NONE;
    return static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | filter);
}

RTCScene make_triangle_scene(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                             TriangleScene::Use use)
{
    RTCDevice device = shared_device();
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, flags_for(use));
    if (triangles.empty()) {  // Embree has no empty buffers
        rtcCommitScene(scene);
        return scene;
    }
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertex_buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                  sizeof(glm::vec3), positions.size());
    void* index_buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                 sizeof(glm::uvec3), triangles.size());
    if (vertex_buffer == nullptr || index_buffer == nullptr) {
        rtcReleaseGeometry(geometry);
        rtcReleaseScene(scene);
        throw_on_error();
        throw std::bad_alloc();
    }
    std::memcpy(vertex_buffer, positions.data(), positions.size_bytes());
    std::memcpy(index_buffer, triangles.data(), triangles.size_bytes());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

}  // namespace

TriangleScene::TriangleScene(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, Use use)
    : handles_(std::make_unique<EmbreeHandles>())
{
    corners_.reserve(triangles.size() * 3);
    for (const glm::uvec3& t : triangles) {
        for (int i = 0; i < 3; ++i) {
            corners_.push_back(positions[t[i]]);
        }
    }
    handles_->scene = make_triangle_scene(positions, triangles, use);
    throw_on_error();
}

TriangleScene::TriangleScene(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                             const Lattice& lattice, Use use)
    : TriangleScene(positions, triangles, use)
{
    RTCDevice device = shared_device();
    handles_->part = handles_->scene;
    handles_->scene = rtcNewScene(device);
    rtcSetSceneFlags(handles_->scene, flags_for(use));
    for (int j = lattice.first.y; j <= lattice.last.y; ++j) {
        for (int i = lattice.first.x; i <= lattice.last.x; ++i) {
            const glm::vec3 offset(static_cast<float>(i) * lattice.period.x, static_cast<float>(j) * lattice.period.y, 0.0f);
            const float world_from_tile[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, offset.x, offset.y, offset.z};
            RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(instance, handles_->part);
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, world_from_tile);
            rtcCommitGeometry(instance);
            rtcAttachGeometryByID(handles_->scene, instance, static_cast<unsigned int>(offsets_.size()));
            rtcReleaseGeometry(instance);
            offsets_.push_back(offset);
        }
    }
    rtcCommitScene(handles_->scene);
    throw_on_error();
}

TriangleScene::~TriangleScene() = default;

void TriangleScene::intersect16(const std::int32_t* valid, RayPacket16& rays) const
{
    Query query(true);
    trace16(valid, handles_->scene, query, reinterpret_cast<RTCRayHit16&>(rays));
}

TriangleHit TriangleScene::intersect1(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar) const
{
    if (!is_ray(origin, dir, tnear, tfar)) {
        return {};
    }
    Query query(false);
    RTCRayHit ray = make_ray(origin, dir, tnear, tfar);
    trace1(handles_->scene, query, ray);
    TriangleHit hit;
    hit.hit = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    hit.t = ray.ray.tfar;
    hit.normal = glm::vec3(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
    hit.triangle = ray.hit.primID;
    hit.weights = glm::vec2(ray.hit.u, ray.hit.v);
    return hit;
}

bool TriangleScene::occluded1(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar) const
{
    if (!is_ray(origin, dir, tnear, tfar)) {
        return false;
    }
    Query query(false);
    RTCRayHit ray = make_ray(origin, dir, tnear, tfar);
    return any1(handles_->scene, query, ray.ray);
}

TriangleScene::Crossings TriangleScene::count_crossings(const glm::vec3& origin, const glm::vec3& dir) const
{
    Crossings crossings;
    Query query(false);
    query.payload = &crossings;
    query.set_filter(count_filter);
    RTCRayHit ray = make_ray(origin, dir, 0.0f, std::numeric_limits<float>::infinity());
    trace1(handles_->scene, query, ray);
    return crossings;
}

NearestPoint TriangleScene::nearest(const glm::vec3& point, float limit) const
{
    NearestQuery nearest{corners_.data(), offsets_.empty() ? nullptr : offsets_.data(), point, {}};
    nearest.nearest.squared = limit * limit;
    RTCPointQuery query{point.x, point.y, point.z, 0.0f, limit};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(handles_->scene, &query, &context, nearest_callback, &nearest);
    return nearest.nearest;
}

float TriangleScene::distance(const glm::vec3& point, float limit) const
{
    return std::sqrt(nearest(point, limit).squared);
}

const void* embree_function()
{
    return reinterpret_cast<const void*>(&rtcNewDevice);
}

std::string embree_version()
{
    const auto part = [](RTCDeviceProperty property) {
        return std::to_string(rtcGetDeviceProperty(shared_device(), property));
    };
    return part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
           part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
}

}  // namespace mesoshell

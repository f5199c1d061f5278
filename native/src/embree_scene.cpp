#include "embree_scene.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string>

#ifdef MESOSHELL_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "mesoshell/error.h"
#include "mesoshell/libraries.h"

namespace mesoshell {
namespace {

static_assert(sizeof(RayPacket16) >= sizeof(RTCRayHit16));
static_assert(offsetof(RayPacket16, tfar) == offsetof(RTCRay16, tfar));
static_assert(offsetof(RayPacket16, normal_x) == offsetof(RTCRayHit16, hit));
static_assert(offsetof(RayPacket16, geometry) - offsetof(RayPacket16, normal_x) == offsetof(RTCHit16, geomID));
static_assert(offsetof(RayPacket16, instance) - offsetof(RayPacket16, normal_x) == offsetof(RTCHit16, instID));

// What a query carries to its callbacks. The two Embree APIs name and pass it differently; nothing else in this file knows.
#ifdef MESOSHELL_EMBREE4

struct Query {
    RTCRayQueryContext context;  // first, so that a callback's context pointer is a pointer to its Query
    RTCIntersectArguments arguments;
    void* payload = nullptr;
    explicit Query(bool coherent)
    {
        rtcInitRayQueryContext(&context);
        rtcInitIntersectArguments(&arguments);
        arguments.context = &context;
        arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    }
};

void trace1(RTCScene scene, Query& query, RTCRayHit& ray)
{
    rtcIntersect1(scene, &ray, &query.arguments);
}

void trace16(const std::int32_t* valid, RTCScene scene, Query& query, RTCRayHit16& rays)
{
    rtcIntersect16(valid, scene, &rays, &query.arguments);
}

constexpr RTCSceneFlags filter_scene_flag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

#else

struct Query {
    RTCIntersectContext context;
    void* payload = nullptr;
    explicit Query(bool coherent)
    {
        rtcInitIntersectContext(&context);
        context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};

void trace1(RTCScene scene, Query& query, RTCRayHit& ray)
{
    rtcIntersect1(scene, &query.context, &ray);
}

void trace16(const std::int32_t* valid, RTCScene scene, Query& query, RTCRayHit16& rays)
{
    rtcIntersect16(valid, scene, &query.context, &rays);
}

constexpr RTCSceneFlags filter_scene_flag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

#endif

RTCDevice shared_device()
{
    // One device for the life of the process: its worker threads are TBB's, and shared.
    static RTCDevice device = rtcNewDevice(nullptr);
    if (device == nullptr) {
        throw Error("Embree could not start (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                    "); install the package again");
    }
    return device;
}

void throw_on_error()
{
    switch (rtcGetDeviceError(shared_device())) {
    case RTC_ERROR_NONE:
        return;
    case RTC_ERROR_OUT_OF_MEMORY:
        throw std::bad_alloc();
    default:
        throw Error("Embree refused a mesh; check it for degenerate or huge coordinates");
    }
}

RTCRayHit make_ray(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar)
{
    RTCRayHit ray;
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = dir.x;
    ray.ray.dir_y = dir.y;
    ray.ray.dir_z = dir.z;
    ray.ray.tnear = tnear;
    ray.ray.tfar = tfar;
    ray.ray.time = 0.0f;
    ray.ray.mask = ~0u;
    ray.ray.id = 0;
    ray.ray.flags = 0;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

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

// Ericson 2004, "Real-Time Collision Detection", section 5.1.5: the closest point by Voronoi regions.
float squared_distance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c)
{
    const auto squared = [](const glm::vec3& v) { return glm::dot(v, v); };
    const glm::vec3 ab = b - a;
    const glm::vec3 ac = c - a;
    const glm::vec3 ap = p - a;
    const float d1 = glm::dot(ab, ap);
    const float d2 = glm::dot(ac, ap);
    if (d1 <= 0.0f && d2 <= 0.0f) {
        return squared(ap);
    }
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp);
    const float d4 = glm::dot(ac, bp);
    if (d3 >= 0.0f && d4 <= d3) {
        return squared(bp);
    }
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp);
    const float d6 = glm::dot(ac, cp);
    if (d6 >= 0.0f && d5 <= d6) {
        return squared(cp);
    }
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
        return squared(ap - ab * (d1 / (d1 - d3)));
    }
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
        return squared(ap - ac * (d2 / (d2 - d6)));
    }
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f) {
        return squared(bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
    }
    const float scale = 1.0f / (va + vb + vc);
    return squared(ap - ab * (vb * scale) - ac * (vc * scale));
}

struct ClosestQuery {
    const glm::vec3* corners;
    const glm::vec3* offsets;  // null without a lattice
    glm::vec3 point;
    float squared;
};

bool closest_callback(RTCPointQueryFunctionArguments* args)
{
    auto& closest = *static_cast<ClosestQuery*>(args->userPtr);
    const glm::vec3* corner = closest.corners + 3 * static_cast<std::size_t>(args->primID);
    glm::vec3 point = closest.point;
    if (closest.offsets != nullptr && args->context->instStackSize > 0) {
        point -= closest.offsets[args->context->instID[0]];
    }
    const float squared = squared_distance(point, corner[0], corner[1], corner[2]);
    if (squared < closest.squared) {
        closest.squared = squared;
        args->query->radius = std::sqrt(squared);
        return true;
    }
    return false;
}

}  // namespace

struct EmbreeHandles {
    RTCScene scene = nullptr;
    RTCScene part = nullptr;
    ~EmbreeHandles()
    {
        if (scene != nullptr) {
            rtcReleaseScene(scene);
        }
        if (part != nullptr) {
            rtcReleaseScene(part);
        }
    }
};

namespace {

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
    Query query(false);
    RTCRayHit ray = make_ray(origin, dir, tnear, tfar);
    trace1(handles_->scene, query, ray);
    TriangleHit hit;
    hit.hit = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    hit.t = ray.ray.tfar;
    hit.normal = glm::vec3(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
    hit.triangle = ray.hit.primID;
    return hit;
}

TriangleScene::Crossings TriangleScene::count_crossings(const glm::vec3& origin, const glm::vec3& dir) const
{
    Crossings crossings;
    Query query(false);
    query.payload = &crossings;
#ifdef MESOSHELL_EMBREE4
    query.arguments.filter = count_filter;
    query.arguments.flags = static_cast<RTCRayQueryFlags>(query.arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
#else
    query.context.filter = count_filter;
#endif
    RTCRayHit ray = make_ray(origin, dir, 0.0f, std::numeric_limits<float>::infinity());
    trace1(handles_->scene, query, ray);
    return crossings;
}

float TriangleScene::distance(const glm::vec3& point, float limit) const
{
    ClosestQuery closest{corners_.data(), offsets_.empty() ? nullptr : offsets_.data(), point, limit * limit};
    RTCPointQuery query{point.x, point.y, point.z, 0.0f, limit};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(handles_->scene, &query, &context, closest_callback, &closest);
    return std::sqrt(closest.squared);
}

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

void BoxScene::visit_along(const glm::vec3& origin, const glm::vec3& dir, float tnear, const Visit& visit) const
{
    Query query(false);
    query.payload = const_cast<Visit*>(&visit);
    RTCRayHit ray = make_ray(origin, dir, tnear, std::numeric_limits<float>::infinity());
    trace1(handles_->scene, query, ray);
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

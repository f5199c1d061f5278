// Embree 3 and Embree 4 as one: what differs between their APIs is here and nowhere else. For embree_scene*.cpp only.
#pragma once

#include <new>
#include <string>

#include <glm/glm.hpp>

#ifdef MESOSHELL_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "mesoshell/error.h"

namespace mesoshell {

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

// What a query carries to its callbacks. The two Embree APIs name and pass it differently.
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
    void set_filter(RTCFilterFunctionN filter)
    {
        arguments.filter = filter;
        arguments.flags = static_cast<RTCRayQueryFlags>(arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
    }
};

inline void trace1(RTCScene scene, Query& query, RTCRayHit& ray)
{
    rtcIntersect1(scene, &ray, &query.arguments);
}

inline bool any1(RTCScene scene, const Query& query, RTCRay& ray)
{
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = query.arguments.flags;
    rtcOccluded1(scene, &ray, &arguments);
    return ray.tfar < 0.0f;
}

inline void trace16(const std::int32_t* valid, RTCScene scene, Query& query, RTCRayHit16& rays)
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
    void set_filter(RTCFilterFunctionN filter) { context.filter = filter; }
};

inline void trace1(RTCScene scene, Query& query, RTCRayHit& ray)
{
    rtcIntersect1(scene, &query.context, &ray);
}

inline bool any1(RTCScene scene, Query& query, RTCRay& ray)
{
    rtcOccluded1(scene, &query.context, &ray);
    return ray.tfar < 0.0f;
}

inline void trace16(const std::int32_t* valid, RTCScene scene, Query& query, RTCRayHit16& rays)
{
    rtcIntersect16(valid, scene, &query.context, &rays);
}

constexpr RTCSceneFlags filter_scene_flag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

#endif

inline RTCDevice shared_device()
{
    // One device for the life of the process: its worker threads are TBB's, and shared.
    static RTCDevice device = rtcNewDevice(nullptr);
    if (device == nullptr) {
        throw Error("Embree could not start (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                    "); install the package again");
    }
    return device;
}

inline void throw_on_error()
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

// Whether Embree takes a ray: its debug builds, which distributions have, abort at others. What is not finite or begins this far
// away meets nothing.
inline bool is_ray(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar)
{
    constexpr float farthest = 1.8e18f;
    return glm::all(glm::lessThanEqual(glm::abs(origin), glm::vec3(farthest))) &&
           glm::all(glm::lessThanEqual(glm::abs(dir), glm::vec3(farthest))) && tnear <= tfar;
}

inline RTCRayHit make_ray(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar)
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

}  // namespace mesoshell

#pragma once

// The seam to Embree: the only header of the product that includes it. Embree 3.13 and 4 differ in
// the folder of their headers, in how queries take their flags (a context; arguments), in the
// default mask of a geometry, and in a field that instance arrays add to hits. IRSIG_EMBREE_4 is
// defined by CMake where it found Embree 4.
#ifdef IRSIG_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstddef>

#include "core/scene/trace/tracer.h"

namespace irsig {

// Embree writes hits into packets of this project: the last field of Embree's own may be missing
// here, never one in between.
static_assert(sizeof(RayPacket) >= sizeof(RTCRayHit16));
static_assert(alignof(RayPacket) == alignof(RTCRayHit16));
static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRayHit16, ray.tfar));
static_assert(offsetof(RayPacket, normal_x) == offsetof(RTCRayHit16, hit.Ng_x));
static_assert(offsetof(RayPacket, triangle) == offsetof(RTCRayHit16, hit.primID));
static_assert(offsetof(RayPacket, geometry) == offsetof(RTCRayHit16, hit.geomID));
static_assert(offsetof(RayPacket, instance) == offsetof(RTCRayHit16, hit.instID));

// Flags of a query. `coherent` rays start and go close to each other.
class EmbreeQuery {
 public:
#ifdef IRSIG_EMBREE_4
  explicit EmbreeQuery(bool coherent)
      : flags_(coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT) {}

  void intersect(const int* valid, RTCScene scene, RayPacket& packet) const {
    RTCIntersectArguments arguments = intersect_arguments();
    rtcIntersect16(valid, scene, reinterpret_cast<RTCRayHit16*>(&packet), &arguments);
  }
  void occluded(const int* valid, RTCScene scene, RayPacket& packet) const {
    RTCOccludedArguments arguments = occluded_arguments();
    rtcOccluded16(valid, scene, reinterpret_cast<RTCRay16*>(&packet), &arguments);
  }
  void intersect(RTCScene scene, RTCRayHit& ray) const {
    RTCIntersectArguments arguments = intersect_arguments();
    rtcIntersect1(scene, &ray, &arguments);
  }
  void occluded(RTCScene scene, RTCRay& ray) const {
    RTCOccludedArguments arguments = occluded_arguments();
    rtcOccluded1(scene, &ray, &arguments);
  }

 private:
  [[nodiscard]] RTCIntersectArguments intersect_arguments() const {
    RTCIntersectArguments out;
    rtcInitIntersectArguments(&out);
    out.flags = flags_;
    return out;
  }
  [[nodiscard]] RTCOccludedArguments occluded_arguments() const {
    RTCOccludedArguments out;
    rtcInitOccludedArguments(&out);
    out.flags = flags_;
    return out;
  }

  RTCRayQueryFlags flags_;
#else
  explicit EmbreeQuery(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }

  void intersect(const int* valid, RTCScene scene, RayPacket& packet) {
    rtcIntersect16(valid, scene, &context_, reinterpret_cast<RTCRayHit16*>(&packet));
  }
  void occluded(const int* valid, RTCScene scene, RayPacket& packet) {
    rtcOccluded16(valid, scene, &context_, reinterpret_cast<RTCRay16*>(&packet));
  }
  void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &context_, &ray); }
  void occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &context_, &ray); }

 private:
  RTCIntersectContext context_;
#endif
};

// Returns a new geometry that every ray may meet, whatever the version's default mask.
inline RTCGeometry new_unmasked_geometry(RTCDevice device, RTCGeometryType type) {
  RTCGeometry geometry = rtcNewGeometry(device, type);
#ifdef IRSIG_EMBREE_4
  rtcSetGeometryMask(geometry, 0xffffffffu);
#endif
  return geometry;
}

}  // namespace irsig

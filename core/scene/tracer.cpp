#include "core/scene/tracer.h"

#include <embree3/rtcore.h>

#include <cstddef>
#include <cstring>

namespace irsig {
namespace {

static_assert(sizeof(RayPacket) == sizeof(RTCRayHit16));
static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRayHit16, ray.tfar));
static_assert(offsetof(RayPacket, normal_x) == offsetof(RTCRayHit16, hit.Ng_x));
static_assert(offsetof(RayPacket, triangle) == offsetof(RTCRayHit16, hit.primID));

// Lanes beyond `count` are switched off.
alignas(64) constexpr int kValid[32] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1,
                                        -1, -1, -1, -1, -1, 0,  0,  0,  0,  0,  0,
                                        0,  0,  0,  0,  0,  0,  0,  0,  0,  0};

class EmbreeTracer final : public Tracer {
 public:
  EmbreeTracer(RTCDevice device, RTCScene scene) : device_(device), scene_(scene) {}
  ~EmbreeTracer() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void intersect(RayPacket& packet, int count, bool coherent) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    alignas(64) int valid[16];
    std::memcpy(valid, kValid + 16 - count, sizeof(valid));
    rtcIntersect16(valid, scene_, &context, reinterpret_cast<RTCRayHit16*>(&packet));
  }

  void occluded(RayPacket& packet, int count, bool coherent) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    alignas(64) int valid[16];
    std::memcpy(valid, kValid + 16 - count, sizeof(valid));
    rtcOccluded16(valid, scene_, &context, reinterpret_cast<RTCRay16*>(&packet));
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

TracerIsa widest_isa() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return TracerIsa::kAvx512;
  if (__builtin_cpu_supports("avx2")) return TracerIsa::kAvx2;
  return TracerIsa::kSse42;
}

std::string isa_name(TracerIsa isa) {
  switch (isa) {
    case TracerIsa::kAvx512:
      return "avx512";
    case TracerIsa::kAvx2:
      return "avx2";
    case TracerIsa::kSse42:
      return "sse4.2";
  }
  return "";
}

absl::StatusOr<std::unique_ptr<Tracer>> Tracer::build(const std::vector<float>& vertex,
                                                      const std::vector<std::uint32_t>& triangle,
                                                      TracerIsa isa) {
  const std::string config = "threads=1,set_affinity=0,isa=" + isa_name(isa);
  RTCDevice device = rtcNewDevice(config.c_str());
  if (device == nullptr) return absl::InternalError("Embree: no device with " + config);
  RTCScene scene = rtcNewScene(device);
  // Never COMPACT: with AVX-512, packets of 16 and COHERENT it loops for ever in 3.13.5.
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               vertex.size() / 3));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), triangle.size() / 3));
  if (vertices != nullptr && indices != nullptr) {
    std::memcpy(vertices, vertex.data(), vertex.size() * sizeof(float));
    std::memcpy(indices, triangle.data(), triangle.size() * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
  }
  rtcReleaseGeometry(geometry);
  auto tracer = std::make_unique<EmbreeTracer>(device, scene);
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    return absl::InternalError("Embree: error " + std::to_string(static_cast<int>(error)) +
                               " while building the acceleration structure");
  return tracer;
}

}  // namespace irsig

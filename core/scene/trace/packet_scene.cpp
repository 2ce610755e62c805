#include "core/scene/trace/packet_scene.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/scene/trace/embree.h"

namespace irsig {
namespace {

// Lanes beyond `count` are switched off.
alignas(64) constexpr int kPacketValid[32] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1,
                                              -1, -1, -1, -1, -1, 0,  0,  0,  0,  0,  0,
                                              0,  0,  0,  0,  0,  0,  0,  0,  0,  0};

// Embree's own limit of a grid's side, in vertices.
constexpr std::uint32_t kMostGridSide = 32767;

class EmbreePackets final : public PacketScene {
 public:
  explicit EmbreePackets(RTCDevice device) : device_(device) {}
  ~EmbreePackets() override {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    for (RTCScene mesh : meshes_) rtcReleaseScene(mesh);
    rtcReleaseDevice(device_);
  }
  EmbreePackets(const EmbreePackets&) = delete;
  EmbreePackets& operator=(const EmbreePackets&) = delete;

  absl::Status build(std::vector<PacketGrid> grids, std::span<const PacketMesh> mesh,
                     std::vector<PacketInstance> instance) {
    scene_ = robust_scene();
    for (PacketGrid& grid : grids) add_grid(std::move(grid));
    first_instance_ = static_cast<std::uint32_t>(grid_.size());
    for (const PacketMesh& m : mesh) add_mesh(m);
    instance_ = std::move(instance);
    for (const PacketInstance& i : instance_) add_instance(i);
    rtcCommitScene(scene_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
      return absl::InternalError(
          absl::StrCat("Embree could not build the land (error ", static_cast<int>(error), ")"));
    return absl::OkStatus();
  }

  void intersect(RayPacket& packet, int count) const override {
    alignas(64) int valid[16];
    std::memcpy(valid, kPacketValid + 16 - count, sizeof(valid));
    switch_off(packet, count);
    packets().intersect(valid, scene_, packet);
    for (int i = 0; i < count; ++i) {
      if (packet.geometry[i] == RTC_INVALID_GEOMETRY_ID) {
        packet.triangle[i] = RayPacket::kMiss;
        continue;
      }
      if (packet.instance[i] == RTC_INVALID_GEOMETRY_ID) {
        packet.instance[i] = kGround;
        continue;
      }
      packet.instance[i] -= first_instance_;
      const std::array<float, 9>& r = instance_[packet.instance[i]].rotation;
      const float x = packet.normal_x[i], y = packet.normal_y[i], z = packet.normal_z[i];
      packet.normal_x[i] = r[0] * x + r[1] * y + r[2] * z;
      packet.normal_y[i] = r[3] * x + r[4] * y + r[5] * z;
      packet.normal_z[i] = r[6] * x + r[7] * y + r[8] * z;
    }
  }

  void occluded(RayPacket& packet, int count) const override {
    alignas(64) int valid[16];
    std::memcpy(valid, kPacketValid + 16 - count, sizeof(valid));
    switch_off(packet, count);
    packets().occluded(valid, scene_, packet);
  }

 private:
  [[nodiscard]] RTCScene robust_scene() const {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return scene;
  }
  // COHERENT is not set: with it, packets of 16 and AVX-512, Embree 3.13.5 loops for ever in
  // compressed boxes, which grids have.
  static EmbreeQuery packets() { return EmbreeQuery(false); }
  // Below AVX-512 Embree cuts packets of 16 up and goes by tnear and tfar alone, not by `valid`.
  static void switch_off(RayPacket& p, int count) {
    for (int i = count; i < RayPacket::kSize; ++i) {
      p.tnear[i] = 0;
      p.tfar[i] = -1;
    }
  }

  void add_grid(PacketGrid of) {
    PacketGrid& grid = *grid_.emplace_back(std::make_unique<PacketGrid>(std::move(of)));
    grid.vertex.resize(grid.vertex.size() + 4);  // Embree reads 16 bytes of the last vertex
    std::vector<RTCGrid> piece;
    const auto add = [&](std::uint32_t left, std::uint32_t low, std::uint32_t columns,
                         std::uint32_t rows) {
      const std::uint32_t stride = grid.columns + 1;
      constexpr std::uint32_t kMostCells = kMostGridSide - 1;
      for (std::uint32_t y = 0; y < rows; y += kMostCells)
        for (std::uint32_t x = 0; x < columns; x += kMostCells)
          piece.push_back({(low + y) * stride + left + x, stride,
                           static_cast<unsigned short>(std::min(columns - x, kMostCells) + 1),
                           static_cast<unsigned short>(std::min(rows - y, kMostCells) + 1)});
    };
    if (grid.hole_columns == 0) {
      add(0, 0, grid.columns, grid.rows);
    } else {
      const std::uint32_t right = grid.hole_left + grid.hole_columns,
                          high = grid.hole_low + grid.hole_rows;
      add(0, 0, grid.columns, grid.hole_low);
      add(0, high, grid.columns, grid.rows - high);
      add(0, grid.hole_low, grid.hole_left, grid.hole_rows);
      add(right, grid.hole_low, grid.columns - right, grid.hole_rows);
    }
    RTCGeometry geometry = new_unmasked_geometry(device_, RTC_GEOMETRY_TYPE_GRID);
    void* to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID,
                                       sizeof(RTCGrid), piece.size());
    if (to != nullptr) std::memcpy(to, piece.data(), piece.size() * sizeof(RTCGrid));
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               grid.vertex.data(), 0, 3 * sizeof(float),
                               std::size_t{grid.columns + 1} * (grid.rows + 1));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  void add_mesh(const PacketMesh& mesh) {
    RTCScene scene = robust_scene();
    meshes_.push_back(scene);
    RTCGeometry geometry = new_unmasked_geometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto put = [&](RTCBufferType type, RTCFormat format, const void* from,
                         std::size_t count) {
      void* to = rtcSetNewGeometryBuffer(geometry, type, 0, format, 12, count);
      if (to != nullptr && count > 0) std::memcpy(to, from, 12 * count);
    };
    put(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertex.data(), mesh.vertex.size() / 3);
    put(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangle.data(), mesh.triangle.size() / 3);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }

  void add_instance(const PacketInstance& i) {
    RTCGeometry geometry = new_unmasked_geometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, meshes_[i.mesh]);
    rtcSetGeometryTimeStepCount(geometry, 1);
    float matrix[12];
    for (std::size_t row = 0; row < 3; ++row) {
      std::copy_n(i.rotation.data() + 3 * row, 3, matrix + 4 * row);
      matrix[4 * row + 3] = i.shift[row];
    }
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, matrix);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> meshes_;
  std::vector<std::unique_ptr<PacketGrid>> grid_;
  std::vector<PacketInstance> instance_;
  std::uint32_t first_instance_ = 0;
};

}  // namespace

absl::StatusOr<std::unique_ptr<const PacketScene>> PacketScene::make(
    std::vector<PacketGrid> grid, std::span<const PacketMesh> mesh,
    std::vector<PacketInstance> instance, TracerIsa isa) {
  const std::string config = "threads=1,set_affinity=0,isa=" + isa_name(isa);
  RTCDevice device = rtcNewDevice(config.c_str());
  if (device == nullptr) return absl::InternalError("Embree: no device with " + config);
  auto out = std::make_unique<EmbreePackets>(device);
  if (const absl::Status built = out->build(std::move(grid), mesh, std::move(instance));
      !built.ok())
    return built;
  return out;
}

}  // namespace irsig

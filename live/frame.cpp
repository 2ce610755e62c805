#include "live/frame.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/view_pictures.h"
#include "core/transport/ray_batch.h"

namespace irsig {
namespace {

constexpr std::uint32_t kTileSide = 8, kTilePixels = kTileSide * kTileSide;
constexpr std::uint32_t kMostSamples = 4;
// Places of the samples in a pixel: each row and each column of a pixel has one.
constexpr float kSampleX[3][4] = {{0.5f}, {0.25f, 0.75f}, {0.375f, 0.875f, 0.125f, 0.625f}},
                kSampleY[3][4] = {{0.5f}, {0.75f, 0.25f}, {0.125f, 0.375f, 0.625f, 0.875f}};

using Light = std::array<float, 5>;  // [LiveLight]

Light total_of(float emitted, float sun, float reflected, float air) {
  return {emitted + sun + reflected + air, emitted, sun, reflected, air};
}

// Rows of a table, linear in the square root of the cosine.
float at_cosine(const float* row, float cos_o) {
  const float position = std::sqrt(cos_o) * (kEmissionCosines - 1);
  const auto low = std::min(static_cast<std::uint32_t>(position), kEmissionCosines - 2);
  return row[low] + (position - static_cast<float>(low)) * (row[low + 1] - row[low]);
}

// Radiance of what stands behind target and land, by the z of the direction.
class Background {
 public:
  Background(const std::vector<float>& table, double horizon_z)
      : table_(table), horizon_(static_cast<float>(horizon_z)) {}

  // Mean over directions between two z.
  [[nodiscard]] float mean(float upper_z, float lower_z) const {
    if (upper_z > lower_z) std::swap(upper_z, lower_z);
    if (lower_z <= horizon_ || upper_z >= horizon_ || lower_z - upper_z < 1e-9f)
      return at(0.5f * (upper_z + lower_z), lower_z <= horizon_);
    const float above = (horizon_ - upper_z) / (lower_z - upper_z);
    return above * at(0.5f * (upper_z + horizon_), true) +
           (1 - above) * at(0.5f * (lower_z + horizon_), false);
  }

 private:
  [[nodiscard]] float at(float z, bool above) const {
    const float width = above ? 1 + horizon_ : 1 - horizon_,
                from = above ? horizon_ - z : z - horizon_,
                f = width > 0 ? std::sqrt(std::clamp(from / width, 0.0f, 1.0f)) : 0;
    const float position = f * (kSideNodes - 1);
    const auto low = std::min(static_cast<std::uint32_t>(position), kSideNodes - 2);
    // Linear in z between nodes, as the nodes' errors are stated for.
    const auto square = [](float x) { return x * x; };
    const float n0 = static_cast<float>(low) / (kSideNodes - 1),
                n1 = static_cast<float>(low + 1) / (kSideNodes - 1),
                t = (square(f) - square(n0)) / (square(n1) - square(n0));
    const float* row = table_.data() + (above ? 0 : kSideNodes) + low;
    return row[0] + t * (row[1] - row[0]);
  }

  const std::vector<float>& table_;
  float horizon_;
};

// Flags pixels of the target, and beside it, next to which another part is met, or the same one in
// other light: rays between those of both samples may meet either.
void flag_beside(const std::vector<std::uint32_t>& thing, LiveFrame& frame) {
  constexpr std::uint32_t kLand = 1u << 16;
  const std::uint32_t width = frame.width_px;
  const auto compare = [&](std::size_t a, std::size_t b) {
    const bool target = (thing[a] > 0 && thing[a] < kLand) || (thing[b] > 0 && thing[b] < kLand);
    if (target && (thing[a] != thing[b] || frame.met[a] != frame.met[b]))
      frame.edge[a] = frame.edge[b] = 1;
  };
  for (std::uint32_t y = 0; y < frame.height_px; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t at = std::size_t{y} * width + x;
      if (x + 1 < width) compare(at, at + 1);
      if (y + 1 < frame.height_px) compare(at, at + width);
    }
}

}  // namespace

// What a thread needs for itself.
struct FrameTracer::Worker {
  RayPacket packet[kTilePixels / RayPacket::kSize];  // to the target
  RayPacket land[kTilePixels / RayPacket::kSize];
  RayPacket to_sun;
  LandMix mix;
  float sun_of[kTilePixels] = {};  // sunlight of land where nothing shades it
  std::vector<float> brdf;
};

// One camera's frame, ready to be drawn.
class FrameTracer::View {
 public:
  View(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
       const ViewRequest& request, PlaceGrid::Seen seen, const ViewFrame& frame,
       const PictureFrame& pictures)
      : scene_(sweep.simulator().scene()),
        target_(scene_.target),
        own_(sweep.own_parts()),
        parts_(lights.choice().effects.parts),
        of_(lights.frame()),
        seen_(std::move(seen)),
        background_(seen_.light.background, seen_.horizon_z),
        frame_(frame),
        pictures_(pictures),
        pixel_m_(pictures.rectangle.width_m / pictures.width_px) {
    const ConditionSpec& condition = request.condition[lights.choice().condition];
    if (land != nullptr) {
      rays_ = land;
      land_.emplace(request.land, condition.above_surface_m - target_.centre.z, target_.centre,
                    of_.land_range_m, land->bend_per_m());
      cos_heading_ = std::cos(request.land->heading_deg * kRadPerDeg);
      sin_heading_ = std::sin(request.land->heading_deg * kRadPerDeg);
      surface_m_ = request.land->surface_m + condition.above_surface_m - target_.centre.z;
      sensor_ = place_of(frame_.sensor);
      slope_ = {land->bend_per_m() * sensor_.x, land->bend_per_m() * sensor_.y, 0};
      sensor_.z += dot(slope_, sensor_);
      land_sun_ = turned(of_.sun);
    }
    emitters_ = request.emitters.get();
    plane_ = request.land != nullptr ? std::nullopt
                                     : plane_of(boundary_of(condition, scene_.surface_z_m()));
    sun_ = to_float(of_.sun);
    find_target_rectangle();
  }

  [[nodiscard]] std::uint32_t columns() const {
    return (pictures_.width_px + kTileSide - 1) / kTileSide;
  }
  [[nodiscard]] std::uint32_t rows() const {
    return (pictures_.height_px + kTileSide - 1) / kTileSide;
  }

  struct Sample {
    Light light{};
    LiveClass met = 0;
    std::uint32_t thing = 0;  // of one surface: part and facet's side, or land's
    double range_m = 0, temperature_k = 0;
  };

  // The samples of one tile, [pixel of the tile], for one place within pixels.
  //   before  the tile's samples at another place, or null: land beside them is in the sun as there
  void trace_tile(std::uint32_t tile_x, std::uint32_t tile_y, float sx, float sy, Worker& worker,
                  const Sample* before, Sample* out) const {
    Vec<Body> direction[kTilePixels];
    float z0[kTilePixels], z1[kTilePixels];
    const bool target = overlaps_target(tile_x, tile_y);
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      const Cell c = cell(tile_x, tile_y, i);
      direction[i] = direction_at(c.x + static_cast<double>(sx), c.y + static_cast<double>(sy));
    }
    if (!land_)
      for (std::uint32_t i = 0; i < kTilePixels; ++i) {
        const Cell c = cell(tile_x, tile_y, i);
        z0[i] = static_cast<float>(direction_at(c.x + 0.5, c.y).z);
        z1[i] = static_cast<float>(direction_at(c.x + 0.5, c.y + 1).z);
      }
    if (target) trace_target(direction, worker);
    if (rays_ != nullptr) trace_land(direction, worker);
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      out[i] = {};
      if (target && shade_target(direction[i], worker, i, out[i])) continue;
      if (rays_ != nullptr && shade_land(direction[i], worker, i, out[i])) continue;
      const float z = static_cast<float>(direction[i].z);
      out[i].light = land_ ? total_of(0, 0, background_.mean(z, z), seen_.light.path)
                           : total_of(0, 0, background_.mean(z0[i], z1[i]), seen_.light.path);
      out[i].met = 0;
    }
    if (target && of_.sun_shines) add_sun(worker, out);
    if (rays_ != nullptr && of_.sun_shines) add_sun_on_land(worker, direction, before, out);
  }

  [[nodiscard]] std::string name_of(LiveClass met, const schema::Sweep& sweep) const;

 private:
  struct Cell {
    double x, y;
  };
  // Pixel of a tile: packets are blocks of 4 x 4 pixels.
  [[nodiscard]] static Cell cell(std::uint32_t tile_x, std::uint32_t tile_y, std::uint32_t i) {
    const Place p = place(i);
    return {static_cast<double>(tile_x * kTileSide + p.x),
            static_cast<double>(tile_y * kTileSide + p.y)};
  }

 public:
  struct Place {
    std::uint32_t x, y;
  };
  [[nodiscard]] static Place place(std::uint32_t i) {
    const std::uint32_t block = i / 16, in = i % 16;
    return {(block % 2) * 4 + in % 4, (block / 2) * 4 + in / 4};
  }

 private:
  [[nodiscard]] Vec<Body> direction_at(double x_px, double y_px) const {
    const PlaneRectangle& r = pictures_.rectangle;
    const double x_m = r.x0_m + x_px * pixel_m_,
                 y_m = r.y0_m + (pictures_.height_px - y_px) * pixel_m_;
    return normalized(pictures_.plane_m * frame_.forward + x_m * frame_.right + y_m * frame_.up);
  }

  static Float3 to_float(Vec<Body> v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }

  // Pixels that may show the target.
  void find_target_rectangle() {
    const double depth_m =
        std::max(-dot(frame_.sensor, frame_.forward) - target_.radius_m, 1e-3 * target_.radius_m);
    double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
    const auto add = [&](double x_m, double y_m) {
      x0 = std::min(x0, x_m), x1 = std::max(x1, x_m), y0 = std::min(y0, y_m),
      y1 = std::max(y1, y_m);
    };
    const double across = dot(-1.0 * frame_.sensor, frame_.right),
                 up = dot(-1.0 * frame_.sensor, frame_.up), r = target_.radius_m;
    for (const double sx : {-r, r})
      for (const double sy : {-r, r})
        for (const double d : {depth_m, depth_m + 2 * r})
          add((across + sx) * pictures_.plane_m / d, (up + sy) * pictures_.plane_m / d);
    const PlaneRectangle& rect = pictures_.rectangle;
    target_x0_ = (x0 - rect.x0_m) / pixel_m_;
    target_x1_ = (x1 - rect.x0_m) / pixel_m_;
    target_y0_ = pictures_.height_px - (y1 - rect.y0_m) / pixel_m_;
    target_y1_ = pictures_.height_px - (y0 - rect.y0_m) / pixel_m_;
  }
  [[nodiscard]] bool overlaps_target(std::uint32_t tile_x, std::uint32_t tile_y) const {
    const double x = tile_x * kTileSide, y = tile_y * kTileSide;
    return x <= target_x1_ && x + kTileSide >= target_x0_ && y <= target_y1_ &&
           y + kTileSide >= target_y0_;
  }

  void trace_target(const Vec<Body>* direction, Worker& worker) const {
    for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
      RayPacket& packet = worker.packet[p];
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const Vec<Body> d = direction[p * RayPacket::kSize + static_cast<std::uint32_t>(lane)];
        const double along = pictures_.plane_m / std::max(dot(d, frame_.forward), 1e-6);
        const Vec<Body> from = frame_.sensor + along * d;
        packet.org_x[lane] = static_cast<float>(from.x);
        packet.org_y[lane] = static_cast<float>(from.y);
        packet.org_z[lane] = static_cast<float>(from.z);
        packet.dir_x[lane] = static_cast<float>(d.x);
        packet.dir_y[lane] = static_cast<float>(d.y);
        packet.dir_z[lane] = static_cast<float>(d.z);
        start(packet, lane);
      }
      target_.tracer->intersect(packet, RayPacket::kSize, true);
    }
  }
  static void start(RayPacket& packet, int lane) {
    packet.tnear[lane] = 0;
    packet.tfar[lane] = std::numeric_limits<float>::infinity();
    packet.time[lane] = 0;
    packet.mask[lane] = 0xffffffffu;
    packet.id[lane] = static_cast<std::uint32_t>(lane);
    packet.flags[lane] = 0;
    packet.triangle[lane] = packet.geometry[lane] = packet.instance[lane] = RayPacket::kMiss;
  }

  // False: the ray passes the target, or what it meets is hidden.
  bool shade_target(Vec<Body> d, Worker& worker, std::uint32_t i, Sample& out) const {
    RayPacket& packet = worker.packet[i / RayPacket::kSize];
    const std::uint32_t lane = i % RayPacket::kSize;
    if (packet.triangle[lane] == RayPacket::kMiss) return false;
    const Float3 at = point(packet, lane);
    if (plane_) {
      const Vec<Body> p{at.x, at.y, at.z};
      if (p.z > plane_->z_m || hidden_by(*plane_, p, frame_.sensor)) return reject(packet, lane);
    }
    const std::uint32_t facet_index = packet.triangle[lane];
    const Target::Facet& facet = target_.facet[facet_index];
    Vec<Body> n{facet.nx, facet.ny, facet.nz};
    double cosine = -dot(n, d);
    if (cosine <= 0) {
      if (!target_.part[facet.part].two_sided) return reject(packet, lane);
      n = -1.0 * n;
      cosine = -cosine;
    }
    const double range_m = length(Vec<Body>{at.x, at.y, at.z} - frame_.sensor);
    if (rays_ != nullptr) {
      RayPacket& land = worker.land[i / RayPacket::kSize];
      if (land.triangle[lane] != RayPacket::kMiss &&
          static_cast<double>(land.tfar[lane]) < range_m - target_.offset_m())
        return reject(packet, lane);
      land.triangle[lane] = RayPacket::kMiss;
    }
    const std::uint32_t material = target_.part[facet.part].material;
    const auto cos_o = static_cast<float>(std::min(cosine, 1.0));
    const std::uint32_t emitter =
        emitters_ != nullptr ? emitters_->of(facet_index, facet.part) : facet.part;
    const ConditionSources::EmitterShare& share = of_.emitter[emitter];
    const float* table = seen_.light.emitted.data() + material * of_.lights * kEmissionCosines;
    float emitted = 0;
    for (std::uint32_t k = 0; k < share.count; ++k)
      emitted += static_cast<float>(share.weight[k]) *
                 at_cosine(table + (share.first + k) * kEmissionCosines, cos_o);
    float reflected =
        ReflectedSky::look_up(seen_.light.reflected.data() + material * ReflectedSky::kEntries,
                              static_cast<float>(-n.z), cos_o, azimuth(n, -1.0 * d));
    if (!own_.facet.empty() && own_.facet[facet_index].hidden > 0) {
      const OwnParts::Facet& own = own_.facet[facet_index];
      reflected += own.hidden * (own_part(own.emitter, table, cos_o) - reflected);
    }
    out.light = total_of(emitted, 0, reflected, seen_.light.path);
    out.met = static_cast<LiveClass>(1 + 2 * material);
    out.thing = 1 + facet.part;
    out.range_m = range_m;
    out.temperature_k = static_cast<double>(of_.kelvin[emitter]);
    return true;
  }
  // Returns what a material of that table reflects of one part of the target all around it.
  [[nodiscard]] float own_part(std::uint32_t emitter, const float* table, float cos_o) const {
    if (!parts_) return 0;
    const ConditionSources::EmitterShare& share = of_.emitter[emitter];
    // That part sends its emission and some of the sky, as upright walls seen aslant do.
    constexpr float kAslant = 0.7f, kUpright = 0, kSideways = 1.6f;
    const std::uint32_t part = emitters_ != nullptr ? emitters_->part_of(emitter) : emitter,
                        material = target_.part[part].material;
    const float* own = seen_.light.emitted.data() + material * of_.lights * kEmissionCosines;
    float reflected = 0, blackbody = 0, emitted = 0;
    for (std::uint32_t k = 0; k < share.count; ++k) {
      const auto weight = static_cast<float>(share.weight[k]);
      const std::uint32_t light = share.first + k;
      blackbody += weight * seen_.light.blackbody[light];
      emitted += weight * at_cosine(own + light * kEmissionCosines, kAslant);
      reflected += weight * (seen_.light.blackbody[light] -
                             at_cosine(table + light * kEmissionCosines, cos_o));
    }
    if (!(blackbody > 0)) return 0;
    emitted +=
        ReflectedSky::look_up(seen_.light.reflected.data() + material * ReflectedSky::kEntries,
                              kUpright, kAslant, kSideways);
    return reflected * emitted / blackbody;
  }
  static bool reject(RayPacket& packet, std::uint32_t lane) {
    packet.triangle[lane] = RayPacket::kMiss;
    return false;
  }
  [[nodiscard]] static Float3 point(const RayPacket& packet, std::uint32_t lane) {
    const float t = packet.tfar[lane];
    return {packet.org_x[lane] + t * packet.dir_x[lane],
            packet.org_y[lane] + t * packet.dir_y[lane],
            packet.org_z[lane] + t * packet.dir_z[lane]};
  }

  // Of the sensor around a normal, from uphill. 0 .. pi
  [[nodiscard]] static float azimuth(Vec<Body> n, Vec<Body> o) {
    const Vec<Body> up{0, 0, -1};
    const Vec<Body> hill = up - dot(up, n) * n, across = o - dot(o, n) * n;
    const double size = length(hill) * length(across);
    if (!(size > 1e-9)) return 0;
    return static_cast<float>(std::acos(std::clamp(dot(hill, across) / size, -1.0, 1.0)));
  }

  static void add_sun_to(float sun, Sample& sample) {
    sample.light[0] += sun;
    sample.light[static_cast<std::size_t>(LiveLight::kSun)] += sun;
    ++sample.met;
  }
  // Whether two samples of a pixel met the same land at about the same place.
  [[nodiscard]] static bool is_beside(const Sample& a, const Sample& b) {
    constexpr double kSamePlace = 0.05;  // of the range
    return a.thing == b.thing && std::abs(a.range_m - b.range_m) < kSamePlace * b.range_m;
  }

  // Adds the sun to the samples of a tile that met the target and face it.
  void add_sun(Worker& worker, Sample* out) const {
    for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
      const RayPacket& packet = worker.packet[p];
      RayPacket& ray = worker.to_sun;
      int count = 0;
      std::uint32_t lane_of[RayPacket::kSize];
      for (std::uint32_t lane = 0; lane < RayPacket::kSize; ++lane) {
        if (packet.triangle[lane] == RayPacket::kMiss) continue;
        const Float3 n = facing(packet, lane);
        if (!(dot(n, sun_) > 0)) continue;
        const Float3 at = point(packet, lane);
        const auto offset = static_cast<float>(target_.offset_m());
        ray.org_x[count] = at.x + offset * n.x;
        ray.org_y[count] = at.y + offset * n.y;
        ray.org_z[count] = at.z + offset * n.z;
        ray.dir_x[count] = sun_.x;
        ray.dir_y[count] = sun_.y;
        ray.dir_z[count] = sun_.z;
        start(ray, count);
        lane_of[count++] = lane;
      }
      if (count == 0) continue;
      target_.tracer->occluded(ray, count, true);
      int lit = 0;
      for (int k = 0; k < count; ++k)
        if (!(ray.tfar[k] < 0)) lane_of[lit++] = lane_of[k];
      if (rays_ != nullptr) lit = past_land(packet, lane_of, lit, ray);
      for (int k = 0; k < lit; ++k)
        add_sun_to(reflected_sun(packet, lane_of[k], worker),
                   out[p * RayPacket::kSize + lane_of[k]]);
    }
  }

  // Leaves of these lanes those whose point land does not shade; returns their number.
  int past_land(const RayPacket& packet, std::uint32_t* lane_of, int count, RayPacket& ray) const {
    for (int k = 0; k < count; ++k) {
      const Float3 at = point(packet, lane_of[k]), n = facing(packet, lane_of[k]);
      const double offset = target_.offset_m();
      put(ray, k,
          place_of(Vec<Body>{at.x + offset * n.x, at.y + offset * n.y, at.z + offset * n.z}),
          land_sun_);
    }
    if (count > 0) rays_->scene().occluded(ray, count);
    int lit = 0;
    for (int k = 0; k < count; ++k)
      if (!(ray.tfar[k] < 0)) lane_of[lit++] = lane_of[k];
    return lit;
  }
  [[nodiscard]] Float3 facing(const RayPacket& packet, std::uint32_t lane) const {
    const Target::Facet& f = target_.facet[packet.triangle[lane]];
    const float along =
        f.nx * packet.dir_x[lane] + f.ny * packet.dir_y[lane] + f.nz * packet.dir_z[lane];
    return along > 0 ? Float3{-f.nx, -f.ny, -f.nz} : Float3{f.nx, f.ny, f.nz};
  }
  [[nodiscard]] float reflected_sun(const RayPacket& packet, std::uint32_t lane,
                                    Worker& worker) const {
    const Float3 n = facing(packet, lane);
    const Vec<Body> normal{n.x, n.y, n.z},
        o{-packet.dir_x[lane], -packet.dir_y[lane], -packet.dir_z[lane]},
        h = normalized(o + of_.sun);
    const double cos_h = std::clamp(dot(h, normal), 1e-6, 1.0);
    const Reflection r{static_cast<float>(dot(normal, of_.sun)), static_cast<float>(dot(normal, o)),
                       static_cast<float>(cos_h), static_cast<float>(1 - cos_h * cos_h),
                       static_cast<float>(std::clamp(dot(h, o), 0.0, 1.0))};
    const Target::Facet& f = target_.facet[packet.triangle[lane]];
    const Material& material = scene_.carried_material()[target_.part[f.part].material];
    if (scene_.path_basis() == nullptr)
      return material.brdf_per_sr(r) * r.cos_i * seen_.light.sun[0];
    worker.brdf.resize(material.nodes());
    material.spectral_brdf_per_sr(r, worker.brdf.data());
    float sum = 0;
    for (std::uint32_t k = 0; k < of_.columns; ++k)
      sum += worker.brdf[of_.first_column + k] * seen_.light.sun[k];
    return sum * r.cos_i;
  }

  // Body to the land's local frame, and places relative to the target's centre to places there.
  [[nodiscard]] Vec<Enu> turned(Vec<Body> d) const {
    return {d.x * sin_heading_ + d.y * cos_heading_, d.x * cos_heading_ - d.y * sin_heading_, -d.z};
  }
  [[nodiscard]] Vec<Enu> place_of(Vec<Body> p) const {
    const Vec<Enu> level = turned({p.x + target_.centre.x, p.y + target_.centre.y, 0});
    return {level.x, level.y, surface_m_ - p.z};
  }
  // A line of sight leaves the sensor higher than a straight one (Land).
  [[nodiscard]] Vec<Enu> in_sight(Vec<Body> d) const {
    Vec<Enu> out = turned(d);
    out.z += dot(slope_, out);
    return out;
  }

  void trace_land(const Vec<Body>* direction, Worker& worker) const {
    for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
      RayPacket& packet = worker.land[p];
      for (int lane = 0; lane < RayPacket::kSize; ++lane) {
        const Vec<Enu> d =
            in_sight(direction[p * RayPacket::kSize + static_cast<std::uint32_t>(lane)]);
        put(packet, lane, sensor_, d);
      }
      rays_->scene().intersect(packet, RayPacket::kSize);
    }
  }
  static void put(RayPacket& packet, int lane, Vec<Enu> from, Vec<Enu> d) {
    packet.org_x[lane] = static_cast<float>(from.x);
    packet.org_y[lane] = static_cast<float>(from.y);
    packet.org_z[lane] = static_cast<float>(from.z);
    packet.dir_x[lane] = static_cast<float>(d.x);
    packet.dir_y[lane] = static_cast<float>(d.y);
    packet.dir_z[lane] = static_cast<float>(d.z);
    start(packet, lane);
  }
  [[nodiscard]] static Vec<Enu> land_normal(const RayPacket& land, std::uint32_t lane) {
    Vec<Enu> n =
        normalized(Vec<Enu>{land.normal_x[lane], land.normal_y[lane], land.normal_z[lane]});
    const bool turn = land.instance[lane] == PacketScene::kGround
                          ? n.z < 0
                          : n.x * static_cast<double>(land.dir_x[lane]) +
                                    n.y * static_cast<double>(land.dir_y[lane]) +
                                    n.z * static_cast<double>(land.dir_z[lane]) >
                                0;
    return turn ? -1.0 * n : n;
  }

  // False: the ray meets no land.
  bool shade_land(Vec<Body> d, Worker& worker, std::uint32_t i, Sample& out) const {
    const RayPacket& land = worker.land[i / RayPacket::kSize];
    const std::uint32_t lane = i % RayPacket::kSize;
    if (land.triangle[lane] == RayPacket::kMiss) return false;
    LandMix& mix = worker.mix;
    const auto distance = static_cast<double>(land.tfar[lane]);
    const Vec<Enu> n = land_normal(land, lane), at_m = sensor_ + distance * in_sight(d);
    rays_->mix_at(land.instance[lane], land.triangle[lane], at_m.x, at_m.y, n, mix);
    const Land::RangeShare range = land_->behind(distance);
    const auto ranges = static_cast<std::uint32_t>(of_.land_range_m.size());
    const auto at = [&](const std::vector<float>& table, std::uint32_t row) {
      const float* v = table.data() + row * ranges + range.node;
      return v[0] + range.weight_of_next * (v[1] - v[0]);
    };
    const float open = static_cast<float>(std::min(1.0, 0.5 * (1 + n.z)));
    float emitted = 0, sun = 0;
    for (const KindShare& part : mix.kind)
      emitted += open * part.share * at(seen_.light.land, part.kind);
    std::uint32_t most = 0;
    for (std::uint32_t m = 0; m < mix.fraction.size(); ++m) {
      if (mix.fraction[m] > mix.fraction[most]) most = m;
      if (!(mix.fraction[m] > 0)) continue;
      if (open < 1) emitted += (1 - open) * mix.fraction[m] * at(seen_.light.land, of_.kinds + m);
      if (of_.sun_shines) sun += mix.fraction[m] * at(seen_.light.land_sun, m);
    }
    out.light = total_of(emitted, 0, 0, seen_.light.path);
    out.met = static_cast<LiveClass>(1 + 2 * (of_.materials + most));
    out.thing = (1u << 16) | most;
    out.range_m = distance;
    worker.sun_of[i] = sun * static_cast<float>(std::max(0.0, dot(n, land_sun_)));
    return true;
  }

  // Adds the sun to the samples of a tile that met land in the sun.
  void add_sun_on_land(Worker& worker, const Vec<Body>* direction, const Sample* before,
                       Sample* out) const {
    for (std::uint32_t p = 0; p < kTilePixels / RayPacket::kSize; ++p) {
      const RayPacket& land = worker.land[p];
      RayPacket& ray = worker.to_sun;
      int count = 0;
      std::uint32_t of[RayPacket::kSize];
      for (std::uint32_t lane = 0; lane < RayPacket::kSize; ++lane) {
        const std::uint32_t i = p * RayPacket::kSize + lane;
        if (land.triangle[lane] == RayPacket::kMiss || !(worker.sun_of[i] > 0)) continue;
        if (before != nullptr && is_beside(before[i], out[i])) {
          if (before[i].met == out[i].met + 1) add_sun_to(worker.sun_of[i], out[i]);
          continue;
        }
        // Coordinates of float32 are known to 2^-24 of the farthest of them.
        constexpr double kDepart = 0x1p-20;
        const auto distance = static_cast<double>(land.tfar[lane]);
        const Vec<Enu> at = sensor_ + distance * in_sight(direction[i]),
                       n = land_normal(land, lane);
        const double off = kDepart * (distance + length(at)) + 1e-4;
        put(ray, count, at + off * n, land_sun_);
        of[count++] = i;
      }
      if (count == 0) continue;
      rays_->scene().occluded(ray, count);
      int lit = 0;
      for (int k = 0; k < count; ++k)
        if (!(ray.tfar[k] < 0)) of[lit++] = of[k];
      add_sun_past_target(worker, direction, of, lit, out);
    }
  }

  // Adds the sun to samples of land that no land shades, unless the target does.
  void add_sun_past_target(Worker& worker, const Vec<Body>* direction, const std::uint32_t* of,
                           int count, Sample* out) const {
    RayPacket& ray = worker.to_sun;
    const Vec<Body> lift{0, 0, target_.offset_m()};
    const double radius_m = target_.radius_m;
    std::uint32_t near[RayPacket::kSize];
    int rays = 0;
    for (int k = 0; k < count; ++k) {
      const Vec<Body> from = frame_.sensor + out[of[k]].range_m * direction[of[k]] - lift;
      // Most rays pass the sphere around the target.
      const double along = -dot(from, of_.sun);
      const Vec<Body> nearest = from + along * of_.sun;
      if (along < -radius_m || dot(nearest, nearest) > radius_m * radius_m) {
        add_sun_to(worker.sun_of[of[k]], out[of[k]]);
        continue;
      }
      ray.org_x[rays] = static_cast<float>(from.x);
      ray.org_y[rays] = static_cast<float>(from.y);
      ray.org_z[rays] = static_cast<float>(from.z);
      ray.dir_x[rays] = sun_.x;
      ray.dir_y[rays] = sun_.y;
      ray.dir_z[rays] = sun_.z;
      start(ray, rays);
      near[rays++] = of[k];
    }
    if (rays == 0) return;
    target_.tracer->occluded(ray, rays, true);
    for (int k = 0; k < rays; ++k)
      if (!(ray.tfar[k] < 0)) add_sun_to(worker.sun_of[near[k]], out[near[k]]);
  }

  const PreparedScene& scene_;
  const Target& target_;
  const OwnParts& own_;
  bool parts_;
  const LightFrame& of_;
  PlaceGrid::Seen seen_;
  Background background_;
  ViewFrame frame_;
  PictureFrame pictures_;
  double pixel_m_;
  const LandRays* rays_ = nullptr;
  std::optional<Land> land_;
  double cos_heading_ = 1, sin_heading_ = 0, surface_m_ = 0;
  Vec<Enu> sensor_, slope_, land_sun_;  // of the lines of sight over land
  const Emitters* emitters_ = nullptr;
  std::optional<Plane> plane_;
  Float3 sun_{0, 0, 0};
  double target_x0_ = 0, target_x1_ = 0, target_y0_ = 0, target_y1_ = 0;
};

FrameTracer::FrameTracer(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
                         PlaceGrid& grid, TileThreads& threads)
    : sweep_(sweep), land_(land), lights_(lights), grid_(grid), threads_(threads) {
  for (std::uint32_t t = 0; t < threads.threads(); ++t)
    worker_.push_back(std::make_unique<Worker>());
}
FrameTracer::~FrameTracer() = default;

std::uint32_t FrameTracer::classes() const {
  return 1 + 2 * (lights_.frame().materials + lights_.frame().land_materials);
}

absl::StatusOr<std::unique_ptr<FrameTracer::View>> FrameTracer::view(const LiveCamera& camera) {
  RETURN_IF_ERROR(check_camera(camera));
  const LiveChoice& choice = lights_.choice();
  ASSIGN_OR_RETURN(const auto request, sweep_.request(choice.condition, choice.band, camera));
  const Target& target = sweep_.simulator().target();
  RETURN_IF_ERROR(check_outside(target, request.viewpoint));
  const ViewFrame frame = make_view_frame(target, request.viewpoint);
  ASSIGN_OR_RETURN(const auto pictures, picture_frame(target, frame, request));
  ASSIGN_OR_RETURN(auto seen, grid_.at(request.viewpoint));
  return std::make_unique<View>(sweep_, land_, lights_, request, std::move(seen), frame, pictures);
}

absl::StatusOr<LiveFrame> FrameTracer::draw(const LiveCamera& camera, std::uint32_t samples,
                                            LiveLight light) {
  const auto begin = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(const auto made, view(camera));
  const View& view = *made;
  LiveFrame out;
  out.width_px = camera.width_px;
  out.height_px = camera.height_px;
  const std::size_t pixels = std::size_t{camera.width_px} * camera.height_px;
  out.radiance_w_m2_sr.resize(pixels);
  out.spread.resize(pixels);
  out.met.resize(pixels);
  out.edge.resize(pixels);
  std::vector<std::uint32_t> things(pixels);
  samples = std::clamp(samples, 1u, kMostSamples);
  const std::uint32_t set = samples == 1 ? 0 : samples == 2 ? 1 : 2;
  const auto shown = static_cast<std::size_t>(light);
  const std::uint32_t columns = view.columns();
  threads_.run(columns * view.rows(), [&](std::uint32_t tile, std::uint32_t thread) {
    const std::uint32_t tile_x = tile % columns, tile_y = tile / columns;
    View::Sample sample[kTilePixels], first[kTilePixels];
    float sum[kTilePixels] = {}, low[kTilePixels], high[kTilePixels];
    std::uint32_t thing[kTilePixels];
    bool edge[kTilePixels] = {};
    LiveClass met[kTilePixels];
    for (std::uint32_t s = 0; s < samples; ++s) {
      view.trace_tile(tile_x, tile_y, kSampleX[set][s], kSampleY[set][s], *worker_[thread],
                      s == 0 ? nullptr : first, sample);
      if (s == 0) std::copy(sample, sample + kTilePixels, first);
      for (std::uint32_t i = 0; i < kTilePixels; ++i) {
        const float value = sample[i].light[shown];
        sum[i] += value;
        if (s == 0) {
          low[i] = high[i] = value;
          thing[i] = sample[i].thing;
          met[i] = sample[i].met;
          continue;
        }
        low[i] = std::min(low[i], value);
        high[i] = std::max(high[i], value);
        edge[i] |= thing[i] != sample[i].thing || met[i] != sample[i].met;
      }
    }
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      const View::Place p = View::place(i);
      const std::uint32_t x = tile_x * kTileSide + p.x, y = tile_y * kTileSide + p.y;
      if (x >= camera.width_px || y >= camera.height_px) continue;
      const std::size_t at = std::size_t{y} * camera.width_px + x;
      out.radiance_w_m2_sr[at] = sum[i] / static_cast<float>(samples);
      out.spread[at] = 0.5f * (high[i] - low[i]);
      out.met[at] = met[i];
      out.edge[at] = edge[i] ? 1 : 0;
      things[at] = thing[i];
    }
  });
  flag_beside(things, out);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

std::string FrameTracer::View::name_of(LiveClass met, const schema::Sweep& sweep) const {
  if (met == 0) return "background";
  const std::uint32_t material = (met - 1u) / 2;
  if (material < of_.materials) return sweep.material(static_cast<int>(material)).name();
  const auto land = static_cast<int>(material - of_.materials);
  return land < sweep.land().material_size() ? sweep.land().material(land).material() : "land";
}

absl::StatusOr<LivePick> FrameTracer::pick(const LiveCamera& camera, std::uint32_t x,
                                           std::uint32_t y) {
  if (x >= camera.width_px || y >= camera.height_px)
    return absl::InvalidArgumentError("the point lies beside the picture");
  ASSIGN_OR_RETURN(const auto made, view(camera));
  View::Sample sample[kTilePixels];
  made->trace_tile(x / kTileSide, y / kTileSide, 0.5f, 0.5f, *worker_[0], nullptr, sample);
  LivePick out;
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const View::Place p = View::place(i);
    if (p.x != x % kTileSide || p.y != y % kTileSide) continue;
    const View::Sample& s = sample[i];
    out.what = made->name_of(s.met, sweep_.resolved().sweep());
    if (s.thing > 0 && s.thing < (1u << 16))
      out.what = sweep_.simulator().target().part[s.thing - 1].name + ": " + out.what;
    out.range_m = s.range_m;
    out.temperature_k = s.temperature_k;
    out.in_sun = s.met > 0 && s.met % 2 == 0;
    for (std::size_t k = 0; k < out.light.size(); ++k)
      out.light[k] = static_cast<double>(s.light[k]);
  }
  return out;
}

}  // namespace irsig

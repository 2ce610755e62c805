#include "core/land/objects/land_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/land/objects/object_places.h"

namespace irsig {
namespace {

// A ray that departs from an object is so many radii of the mesh in front of it: sixteen times what
// the ray tracer's answers are uncertain by.
constexpr double kDeparture = 0x1p-16;
// Boxes are that much larger than what they enclose, in radii.
constexpr double kBoxSlack = 0x1p-20;
constexpr double kBytesPerFacet = 400;  // of the ray tracer with its guards

// One lane of a packet whose others are switched off.
RayPacket switched_off() {
  RayPacket out{};
  for (int i = 0; i < RayPacket::kSize; ++i) {
    out.tfar[i] = -1;
    out.triangle[i] = out.geometry[i] = out.instance[i] = RayPacket::kMiss;
  }
  return out;
}

RayPacket packet_of(Vec<Body> origin, Vec<Body> direction, double most) {
  static const RayPacket kOff = switched_off();
  RayPacket out = kOff;
  out.org_x[0] = static_cast<float>(origin.x);
  out.org_y[0] = static_cast<float>(origin.y);
  out.org_z[0] = static_cast<float>(origin.z);
  out.dir_x[0] = static_cast<float>(direction.x);
  out.dir_y[0] = static_cast<float>(direction.y);
  out.dir_z[0] = static_cast<float>(direction.z);
  out.tnear[0] = 0;
  out.tfar[0] = static_cast<float>(most);
  out.mask[0] = 0xffffffffu;
  return out;
}

ObjectName name_of(PlacesFrom from, const std::string& key, const std::string& place_file,
                   std::uint32_t line, std::size_t place) {
  switch (from) {
    case PlacesFrom::kTable:
      return {absl::StrCat(key, ".place[", place, "]"), ""};
    case PlacesFrom::kFile:
      return {key + ".places_file", absl::StrCat(place_file, ":", line, ":1: ")};
    case PlacesFrom::kScatter:
      return {key, ""};
  }
  return {};
}

absl::Status place_problem(const ObjectModel& model, std::size_t place, const std::string& what) {
  const ObjectName name =
      name_of(model.from, model.key, model.place_file, model.place[place].line, place);
  return keyed_problem(name.key, name.text + what);
}

}  // namespace

// A mesh around the middle of its box, as float32 has it.
struct LandObjects::Shape {
  std::string key, place_file;
  PlacesFrom from = PlacesFrom::kTable;
  std::vector<std::uint32_t> line;  // [place] of a file; else empty
  std::unique_ptr<const Tracer> tracer;
  std::vector<float> vertex;            // as the tracer has them
  std::vector<std::uint32_t> triangle;  // three indices each
  Vec<Body> half{};  // of the box
  double radius = 0;
  struct Facet {
    std::array<float, 3> normal;
    std::uint32_t material;
  };
  std::vector<Facet> facet;
};

// A ray in the frame of an object's mesh, from the object's box on. Distances are in metres divided
// by the object's scale.
struct LandObjects::LocalRay {
  Vec<Body> origin, direction;
  double begin = 0, length = 0;  // begin: the distance of `origin` from where the ray begins
};

LandObjects::LandObjects() = default;
LandObjects::LandObjects(LandObjects&&) noexcept = default;
LandObjects& LandObjects::operator=(LandObjects&&) noexcept = default;
LandObjects::~LandObjects() = default;

absl::StatusOr<LandObjects> LandObjects::create(std::vector<ObjectModel> models,
                                                const HeightField& field, TracerIsa isa) {
  LandObjects out;
  std::uint64_t objects = 0, facets = 0;
  std::vector<LandBox> box;
  for (ObjectModel& model : models) {
    const Mesh& mesh = model.mesh;
    objects += model.place.size();
    facets += mesh.triangle.size();
    if (objects > kMostLandObjects)
      return keyed_problem(model.key, absl::StrCat("there are more than ", kMostLandObjects,
                                                   " objects up to this table, which is the "
                                                   "limit; join objects in one mesh"));
    if (facets > kMostObjectFacets)
      return keyed_problem(model.key + ".model",
                           absl::StrCat("the meshes of objects have more than ", kMostObjectFacets,
                                        " facets up to this one, which is the limit; use coarser "
                                        "meshes"));
    if (mesh.triangle.empty()) return keyed_problem(model.key + ".model", "the mesh has no facets");
    Shape& shape = out.shape_.emplace_back();
    shape.key = model.key;
    shape.from = model.from;
    shape.place_file = model.place_file;
    Vec<Body> low = mesh.vertex.front(), high = low;
    for (const Vec<Body>& v : mesh.vertex) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const Vec<Body> middle = 0.5 * (low + high);
    std::vector<float> vertex;
    vertex.reserve(3 * mesh.vertex.size());
    for (const Vec<Body>& v : mesh.vertex) {
      const Vec<Body> d = v - middle;
      shape.radius = std::max(shape.radius, length(d));
      for (const double x : {d.x, d.y, d.z}) vertex.push_back(static_cast<float>(x));
    }
    const double slack = kBoxSlack * shape.radius;
    shape.half = 0.5 * (high - low) + Vec<Body>{slack, slack, slack};
    std::vector<std::uint32_t> triangle;
    triangle.reserve(3 * mesh.triangle.size());
    for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
      const auto& corner = mesh.triangle[i];
      triangle.insert(triangle.end(), corner.begin(), corner.end());
      const Vec<Body> a = mesh.vertex[corner[0]];
      Vec<Body> n = cross(mesh.vertex[corner[1]] - a, mesh.vertex[corner[2]] - a);
      if (const double norm = length(n); norm > 0) n = (1 / norm) * n;
      shape.facet.push_back(
          {{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)},
           model.material[mesh.triangle_group[i]]});
    }
    ASSIGN_OR_RETURN(shape.tracer, Tracer::build(vertex, triangle, isa));
    shape.vertex = std::move(vertex);
    shape.triangle = std::move(triangle);

    const ObjectBase base = base_of(mesh);
    if (model.from == PlacesFrom::kFile)
      for (const ObjectPlace& place : model.place) shape.line.push_back(place.line);
    for (std::size_t i = 0; i < model.place.size(); ++i) {
      const ObjectPlace& place = model.place[i];
      if (!(place.scale > 0))
        return place_problem(model, i,
                             absl::StrCat("scale = ", place.scale, ", expected a number above 0"));
      const auto land_m = lowest_land_m(base, place, field);
      if (!land_m)
        return place_problem(
            model, i,
            absl::StrCat("the object at east_m = ", absl::SixDigits(place.x_m),
                         ", north_m = ", absl::SixDigits(place.y_m),
                         " stands beyond the map of heights; move it, or use a larger map"));
      Object& object = out.object_.emplace_back();
      object.cos_heading = std::cos(place.heading_deg * kRadPerDeg);
      object.sin_heading = std::sin(place.heading_deg * kRadPerDeg);
      object.scale = place.scale;
      object.shape = static_cast<std::uint32_t>(out.shape_.size() - 1);
      object.place = static_cast<std::uint32_t>(i);
      const double c = object.cos_heading, s = object.sin_heading;
      const Vec<Body> m = place.scale * middle;
      object.middle_m = {place.x_m + m.x * s + m.y * c, place.y_m + m.x * c - m.y * s,
                         *land_m - model.sink_m + place.scale * (base.lowest_z_m - middle.z)};
      const Vec<Body> h = place.scale * (1 + 1e-9) * shape.half;
      const Vec<Enu> around{std::abs(h.x * s) + std::abs(h.y * c),
                            std::abs(h.x * c) + std::abs(h.y * s), h.z};
      box.push_back({object.middle_m - around, object.middle_m + around});
    }
  }
  out.tree_ = BoxTree(box);
  return out;
}

std::optional<LandObjects::LocalRay> LandObjects::enter(const Object& object, Vec<Enu> origin_m,
                                                        Vec<Enu> direction, double most_m,
                                                        double bend_per_m) const {
  const Shape& shape = shape_[object.shape];
  const double c = object.cos_heading, s = object.sin_heading;
  Vec<Enu> middle_m = object.middle_m;
  middle_m.z += bend_per_m * (middle_m.x * middle_m.x + middle_m.y * middle_m.y);
  const auto turned = [&](Vec<Enu> v) {
    return Vec<Body>{v.x * s + v.y * c, v.x * c - v.y * s, -v.z};
  };
  const Vec<Body> from = (1 / object.scale) * turned(origin_m - middle_m);
  LocalRay out{from, turned(direction), 0, most_m / object.scale};
  double end = out.length;
  const auto cut = [&](double o, double d, double half) {
    if (d == 0) {
      if (std::abs(o) > half) end = -1;
      return;
    }
    const double a = (-half - o) / d, b = (half - o) / d;
    out.begin = std::max(out.begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  };
  cut(from.x, out.direction.x, shape.half.x);
  cut(from.y, out.direction.y, shape.half.y);
  cut(from.z, out.direction.z, shape.half.z);
  if (!(out.begin <= end)) return std::nullopt;
  out.origin = from + out.begin * out.direction;
  out.length = end - out.begin;
  return out;
}

std::optional<ObjectHit> LandObjects::first_hit(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                                                double bend_per_m) const {
  const double unit = length(direction);
  const Vec<Enu> towards = (1 / unit) * direction;
  const Object* met = nullptr;
  std::uint32_t facet = 0;
  double nearest_m = 0;
  tree_.walk(origin_m, towards, most * unit, bend_per_m, [&](std::uint32_t i, double most_m) {
    const Object& object = object_[i];
    const auto ray = enter(object, origin_m, towards, most_m, bend_per_m);
    if (!ray) return most_m;
    RayPacket packet = packet_of(ray->origin, ray->direction, ray->length);
    shape_[object.shape].tracer->intersect(packet, 1, false);
    if (packet.geometry[0] == RayPacket::kMiss) return most_m;
    const double distance_m = object.scale * (ray->begin + static_cast<double>(packet.tfar[0]));
    if (distance_m > most_m || (met != nullptr && distance_m >= nearest_m)) return most_m;
    met = &object;
    facet = packet.triangle[0];
    nearest_m = distance_m;
    return distance_m;
  });
  if (met == nullptr) return std::nullopt;
  const Shape& shape = shape_[met->shape];
  const auto& n = shape.facet[facet].normal;
  const double c = met->cos_heading, s = met->sin_heading;
  const double x = static_cast<double>(n[0]), y = static_cast<double>(n[1]);
  Vec<Enu> normal = normalized(Vec<Enu>{x * s + y * c, x * c - y * s, -static_cast<double>(n[2])});
  if (dot(normal, towards) > 0) normal = -1.0 * normal;
  return ObjectHit{nearest_m / unit, normal,
                   origin_m + nearest_m * towards + kDeparture * met->scale * shape.radius * normal,
                   shape.facet[facet].material};
}

bool LandObjects::hidden(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                         double bend_per_m) const {
  const double unit = length(direction);
  const Vec<Enu> towards = (1 / unit) * direction;
  bool out = false;
  tree_.walk(origin_m, towards, most * unit, bend_per_m, [&](std::uint32_t i, double most_m) {
    if (out) return most_m;
    const Object& object = object_[i];
    const auto ray = enter(object, origin_m, towards, most_m, bend_per_m);
    if (!ray) return most_m;
    RayPacket packet = packet_of(ray->origin, ray->direction, ray->length);
    shape_[object.shape].tracer->occluded(packet, 1, false);
    out = packet.tfar[0] < 0;
    return out ? -1 : most_m;
  });
  return out;
}

std::optional<ObjectName> LandObjects::around(Vec<Enu> point_m) const {
  constexpr Vec<Body> kRay[] = {{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  std::optional<ObjectName> out;
  tree_.around(point_m, [&](std::uint32_t i) {
    const Object& object = object_[i];
    const Shape& shape = shape_[object.shape];
    const auto here = enter(object, point_m, {0, 0, 1}, 0, 0);
    if (out || !here) return;
    for (const Vec<Body>& direction : kRay) {
      RayPacket packet = packet_of(here->origin, direction, 3 * shape.radius);
      shape.tracer->intersect(packet, 1, false);
      if (packet.geometry[0] == RayPacket::kMiss) return;
      const auto& n = shape.facet[packet.triangle[0]].normal;
      if (dot(Vec<Body>{n[0], n[1], n[2]}, direction) <= 0) return;
    }
    out = name_of(shape.from, shape.key, shape.place_file,
                  shape.line.empty() ? 0 : shape.line[object.place], object.place);
  });
  return out;
}

std::size_t LandObjects::shapes() const { return shape_.size(); }

LandObjects::ShapeMesh LandObjects::mesh(std::size_t shape) const {
  return {shape_[shape].vertex, shape_[shape].triangle};
}

std::uint32_t LandObjects::material(std::size_t shape, std::uint32_t facet) const {
  return shape_[shape].facet[facet].material;
}

std::size_t LandObjects::memory_bytes() const {
  std::size_t facets = 0, lines = 0;
  for (const Shape& shape : shape_) {
    facets += shape.facet.size();
    lines += shape.line.size();
  }
  return tree_.memory_bytes() + object_.size() * sizeof(Object) + lines * sizeof(std::uint32_t) +
         static_cast<std::size_t>(kBytesPerFacet) * facets;
}

}  // namespace irsig

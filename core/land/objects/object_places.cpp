#include "core/land/objects/object_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr double kBase = 0.05;  // of a mesh's height

// Numbers from 0 to 1, below 1, by splitmix64.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace

ObjectBase base_of(const Mesh& mesh) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec<Body>& v : mesh.vertex) {
    low = std::max(low, v.z);
    high = std::min(high, v.z);
  }
  ObjectBase out;
  out.lowest_z_m = low;
  out.back_m = out.port_m = std::numeric_limits<double>::infinity();
  out.front_m = out.starboard_m = -out.back_m;
  for (const Vec<Body>& v : mesh.vertex) {
    if (v.z < low - kBase * (low - high)) continue;
    out.back_m = std::min(out.back_m, v.x);
    out.front_m = std::max(out.front_m, v.x);
    out.port_m = std::min(out.port_m, v.y);
    out.starboard_m = std::max(out.starboard_m, v.y);
  }
  return out;
}

std::optional<double> lowest_land_m(const ObjectBase& base, const ObjectPlace& place,
                                    const HeightField& field) {
  constexpr int kPoints = 5;  // along each side
  const double c = std::cos(place.heading_deg * kRadPerDeg),
               s = std::sin(place.heading_deg * kRadPerDeg);
  double out = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kPoints; ++i)
    for (int k = 0; k < kPoints; ++k) {
      const double u = i / (kPoints - 1.0), v = k / (kPoints - 1.0);
      const double x = place.scale * (base.back_m + u * (base.front_m - base.back_m)),
                   y = place.scale * (base.port_m + v * (base.starboard_m - base.port_m));
      const auto z_m = field.z_m(place.x_m + x * s + y * c, place.y_m + x * c - y * s);
      if (!z_m) return std::nullopt;
      out = std::min(out, *z_m);
    }
  return out;
}

absl::StatusOr<std::vector<ObjectPlace>> scatter_objects(const ObjectScatter& how,
                                                         const ObjectBase& base,
                                                         const HeightField& field,
                                                         const LandCover& cover) {
  constexpr std::uint64_t kTries = 1000;  // for each object
  Uniform uniform(how.seed);
  std::vector<float> fraction(cover.materials());
  std::vector<ObjectPlace> out;
  for (std::uint64_t tries = 0; out.size() < how.count; ++tries) {
    if (tries >= kTries * how.count)
      return absl::InvalidArgumentError(absl::StrCat(
          "only ", out.size(), " of ", how.count, " places were found in ", tries,
          " tries: little or nothing of the map between inner_radius_m = ",
          absl::SixDigits(how.inner_radius_m), " and radius_m = ", absl::SixDigits(how.radius_m),
          " has this material; state a smaller count, another material or another radius"));
    // Equal areas have equal numbers of objects.
    const double inner2 = how.inner_radius_m * how.inner_radius_m,
                 r = std::sqrt(inner2 + uniform.next() * (how.radius_m * how.radius_m - inner2)),
                 azimuth = 2 * std::numbers::pi * uniform.next();
    ObjectPlace place{r * std::sin(azimuth), r * std::cos(azimuth), 360 * uniform.next(), how.scale,
                      0};
    const double chance = uniform.next();
    cover.at(place.x_m, place.y_m, fraction);
    if (chance < static_cast<double>(fraction[how.material]) && lowest_land_m(base, place, field))
      out.push_back(place);
  }
  return out;
}

}  // namespace irsig

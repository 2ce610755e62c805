#include "verify/reference/reference_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"
#include "verify/reference/reference_view_parts.h"

namespace irsig {

using namespace reference_view;

namespace {

constexpr double kHotterK = 20;

double radical_inverse(std::uint64_t i, int base) {
  double out = 0, digit = 1.0 / base;
  for (; i > 0; i /= static_cast<std::uint64_t>(base), digit /= base)
    out += digit * static_cast<double>(i % static_cast<std::uint64_t>(base));
  return out;
}

}  // namespace

absl::StatusOr<ReferenceView> ReferenceView::make(const SceneSpec& scene,
                                                  const ViewRequest& request,
                                                  std::uint32_t condition) {
  if (request.environment) return absl::UnimplementedError("the embedded atmosphere");
  auto parts = std::make_unique<Parts>();
  Parts& p = *parts;
  p.scene = scene;
  p.condition = request.condition.at(condition);
  p.air = request.air;
  p.viewpoint = request.viewpoint;
  p.sensor = request.viewpoint.range_m * body_from_aspect(request.viewpoint.aspect_azimuth_deg,
                                                          request.viewpoint.aspect_elevation_deg);
  p.surface = p.condition.surroundings.kind != SurroundingsKind::kNone;
  double least_um = 1e300, most_um = 0;
  for (const Band& b : scene.band) {
    least_um = std::min(least_um, b.lambda_min_um);
    most_um = std::max(most_um, b.lambda_max_um);
  }
  for (const MaterialSpec& m : scene.material) {
    ASSIGN_OR_RETURN(auto brdf, ReferenceBrdf::make(m, least_um, most_um));
    p.grey = p.grey && brdf.grey();
    p.brdf.push_back(std::move(brdf));
  }

  std::vector<Point3> corner;
  for (const Vec<Body>& v : scene.mesh.vertex) corner.push_back(point(v));
  std::vector<std::uint32_t> triangle;
  std::vector<std::uint32_t> part_of_group(scene.mesh.group.size());
  for (std::size_t g = 0; g < scene.mesh.group.size(); ++g)
    for (std::uint32_t i = 0; i < scene.part.size(); ++i) {
      std::vector<std::string> match = scene.part[i].match;
      if (match.empty()) match.push_back(scene.part[i].name);
      for (const std::string& pattern : match)
        if (group_matches(scene.mesh.group[g], pattern)) part_of_group[g] = i;
    }
  Body3 low = scene.mesh.vertex.front(), high = low;
  for (std::size_t t = 0; t < scene.mesh.triangle.size(); ++t) {
    const auto& index = scene.mesh.triangle[t];
    triangle.insert(triangle.end(), index.begin(), index.end());
    const Body3 a = scene.mesh.vertex[index[0]], b = scene.mesh.vertex[index[1]],
                c = scene.mesh.vertex[index[2]];
    for (const Body3 v : {a, b, c}) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const Body3 across = cross(b - a, c - a);
    const double twice = length(across);
    p.facet.push_back({a, b - a, c - a, twice > 0 ? (1 / twice) * across : Body3{}, 0.5 * twice,
                       part_of_group[scene.mesh.triangle_group[t]]});
  }
  p.size_m = 0.5 * length(high - low);
  p.tracer = std::make_unique<ReferenceTracer>(std::move(corner), std::move(triangle));

  const ConditionSpec& c = p.condition;
  const double radius = c.sun_angular_radius_deg * kRadPerDeg;
  p.sun = c.sun && c.sun_scale > 0 && c.sun_cos_zenith > -std::sin(radius);
  p.light = {&p.condition, p.sun};
  p.cos_sun = std::cos(radius);
  // Irradiance of a disk of radiance 1 at normal incidence: pi sin^2; drawn evenly in solid angle.
  p.sun_solid_angle = 2 * kPi * 2 * std::pow(std::sin(radius / 2), 2);

  if (request.land != nullptr) {
    p.land = std::make_shared<const Land>(request.land, c.above_surface_m, Body3{},
                                          std::vector<double>{});
    for (const MaterialSpec& m : scene.land_material) {
      ASSIGN_OR_RETURN(const auto brdf, ReferenceBrdf::make(m, least_um, most_um));
      const auto* lambert = std::get_if<Lambert>(&m.model);
      if (!brdf.grey() || lambert == nullptr || lambert->emissivity.size() != 1)
        return absl::UnimplementedError("land whose materials are not grey and diffuse");
      p.land_emissivity.push_back(lambert->emissivity.front().value);
    }
  }
  double coldest_k = 1e300;
  for (const double t : c.part_temperature_k) coldest_k = std::min(coldest_k, t);
  const auto of_temperature = [](double t) {
    return [t](double l) { return planck_radiance_w_m2_sr_um(l, t); };
  };
  for (const Band& b : scene.band) {
    std::vector<double>& of_band = p.part_in_band.emplace_back();
    std::vector<double>& of_land = p.land_in_band.emplace_back();
    for (const double kelvin : c.land_temperature_k)
      of_land.push_back(integral_in_band(b, of_temperature(kelvin)));
    std::vector<std::function<double(double)>> spectra;
    for (const double t : c.part_temperature_k) {
      of_band.push_back(integral_in_band(b, of_temperature(t)));
      spectra.push_back(of_temperature(t));
    }
    const auto sky = [&](double l) { return p.light.sky(l); };
    const auto lower = [&](double l) { return p.light.lower(l); };
    const auto sunlight = [&](double l) { return p.light.sunlight(l); };
    p.sky_in_band.push_back(integral_in_band(b, sky));
    p.lower_in_band.push_back(integral_in_band(b, lower));
    p.sun_in_band.push_back(integral_in_band(b, sunlight));
    p.air_in_band.push_back(integral_in_band(b, of_temperature(c.air_temperature_k)));
    spectra.insert(spectra.end(), {sky, lower, sunlight});
    p.waves.emplace_back(b, spectra, kStrata);
  }

  // Where points are drawn: projected area x (a tenth of the brightest + the part's own), in all
  // bands; a tenth goes to parts in equal shares.
  const std::size_t parts_count = scene.part.size();
  std::vector<double> bright(parts_count, 0.1), projected(p.facet.size(), 0.0),
      of_part(parts_count, 0.0);
  for (std::size_t b = 0; b < scene.band.size(); ++b) {
    double most = 0;
    for (const double l : p.part_in_band[b]) most = std::max(most, l);
    most = std::max(most, p.sky_in_band[b]);
    if (!(most > 0)) continue;
    for (std::size_t i = 0; i < parts_count; ++i) bright[i] += p.part_in_band[b][i] / most;
  }
  double sum = 0;
  for (std::size_t t = 0; t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    double cosine = 0;
    for (const Body3 at : {f.a, f.a + f.ab, f.a + f.ac}) {
      const double one = dot(f.normal, normalized(p.sensor - at));
      cosine = std::max(cosine, scene.part[f.part].two_sided ? std::abs(one) : one);
    }
    projected[t] = std::max(cosine, 0.0) * f.area_m2;
    of_part[f.part] += projected[t];
    sum += projected[t] * bright[f.part];
  }
  if (!(sum > 0)) return absl::InvalidArgumentError("no facet faces the sensor");
  for (std::uint32_t t = 0; t < p.facet.size(); ++t) {
    const std::uint32_t part = p.facet[t].part;
    if (projected[t] > 0)
      p.primary.add(t, 0.9 * projected[t] * bright[part] / sum +
                           0.1 * projected[t] / (of_part[part] * static_cast<double>(parts_count)));
  }
  p.primary.finish();

  bool any_matt = false;
  for (std::uint32_t i = 0; i < parts_count; ++i) any_matt = any_matt || !p.is_mirror(i);
  for (std::uint32_t t = 0; p.sun && any_matt && t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    if (!p.is_mirror(f.part)) continue;
    const double cosine = dot(f.normal, c.sun_direction);
    // Facets along the beam meet a part of the disk.
    const double facing = scene.part[f.part].two_sided ? std::abs(cosine) : cosine;
    p.mirrors.add(t, f.area_m2 * std::max(0.0, facing + std::sin(radius)));
  }
  if (!p.mirrors.item.empty()) p.mirrors.finish();

  p.hot_density.assign(p.facet.size(), 0.0);
  std::vector<double> power(p.facet.size(), 0.0);
  double all = 0;
  for (std::size_t t = 0; t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    if (!(c.part_temperature_k[f.part] >= coldest_k + kHotterK)) continue;
    for (std::size_t b = 0; b < scene.band.size(); ++b) {
      double most = 0;
      for (const double l : p.part_in_band[b]) most = std::max(most, l);
      if (most > 0) power[t] += f.area_m2 * p.part_in_band[b][f.part] / most;
    }
    all += power[t];
  }
  for (std::uint32_t t = 0; t < p.facet.size(); ++t) {
    if (!(power[t] > 0)) continue;
    p.hot.add(t, power[t]);
    p.hot_density[t] = power[t] / all / p.facet[t].area_m2;
  }
  if (!p.hot.item.empty()) p.hot.finish();
  return ReferenceView(std::move(parts));
}

ReferenceView::Result ReferenceView::run(std::uint64_t samples, std::uint64_t seed) const {
  const Parts& all = *parts_;
  const std::size_t bands = all.scene.band.size(), n = all.channels();
  Result out;
  out.row.resize(bands);
  ReplicateStatistics statistics(4 * bands);
  for (std::uint32_t batch = 0; batch < kBatches; ++batch) {
    Random random(mix64(seed) + batch);
    Parts::Path path{random, {}, 0, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
    for (auto* v :
         {&path.lambda_um, &path.weight, &path.through, &path.sum, &path.source, &path.factor,
          &path.end_factor, &path.sky, &path.lower, &path.sunlight, &path.land})
      v->assign(n, 1.0);
    for (auto* v : {&path.total, &path.apparent, &path.contrast}) v->assign(bands, 0.0);
    path.part.resize(all.scene.part.size());
    if (all.grey) {
      for (std::size_t q = 0; q < path.part.size(); ++q)
        for (std::size_t b = 0; b < bands; ++b) path.part[q].push_back(all.part_in_band[b][q]);
      path.sky = all.sky_in_band;
      path.lower = all.lower_in_band;
      path.sunlight = all.sun_in_band;
    }
    std::array<double, kBase.size()> shift{};
    for (double& s : shift) s = random();
    std::vector<double> value(4 * bands, 0.0), gross(bands, 0.0);
    for (std::uint64_t i = 0; i < samples; ++i) {
      for (std::size_t d = 0; d < kBase.size(); ++d) {
        const double x = radical_inverse(i + 1, kBase[d]) + shift[d];
        path.u[d] = x - std::floor(x);
      }
      all.trace(path);
      for (std::size_t b = 0; b < bands; ++b) {
        value[4 * b] += path.total[b];
        value[4 * b + 1] += path.apparent[b];
        value[4 * b + 2] += path.contrast[b];
        value[4 * b + 3] += path.area_m2;
        gross[b] += std::abs(path.total[b]);
      }
      if (all.mirrors.item.empty()) continue;
      all.trace_from_sun(path);
      for (std::size_t b = 0; b < bands; ++b) {
        value[4 * b] += path.total[b];
        value[4 * b + 1] += path.apparent[b];
        value[4 * b + 2] += path.apparent[b];
        gross[b] += path.total[b];
      }
    }
    for (double& v : value) v /= static_cast<double>(samples);
    statistics.add(value);
    for (std::size_t b = 0; b < bands; ++b)
      out.row[b].gross_w_sr += gross[b] / static_cast<double>(samples) / kBatches;
    out.rays += path.rays;
  }
  for (std::size_t b = 0; b < bands; ++b) {
    Row& r = out.row[b];
    r.total = statistics.estimate(4 * b);
    r.apparent = statistics.estimate(4 * b + 1);
    r.contrast = statistics.estimate(4 * b + 2);
    r.projected_area_m2 = statistics.estimate(4 * b + 3);
  }
  return out;
}

ReferenceView::ReferenceView(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
ReferenceView::~ReferenceView() = default;
ReferenceView::ReferenceView(ReferenceView&&) noexcept = default;
ReferenceView& ReferenceView::operator=(ReferenceView&&) noexcept = default;

}  // namespace irsig

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/constants.h"
#include "verify/search/random_scene.h"
#include "verify/search/random_scene_basics.h"

namespace irsig {
namespace {

using namespace random_scene_basics;

// Triangles of the parts of a body, in its own axes about its centre.
struct Piece {
  std::string name;
  std::vector<std::array<V3, 3>> triangle;
};

void add_quad(std::vector<std::array<V3, 3>>& out, V3 a, V3 b, V3 c, V3 d) {
  out.push_back({a, b, c});
  out.push_back({a, c, d});
}

// A rectangle z = const between the corners of `outer` and `inner` (half sides): four trapezoids
// facing up or down.
void add_ring(std::vector<std::array<V3, 3>>& out, std::array<double, 2> outer,
              std::array<double, 2> inner, double z, bool up) {
  const V3 o[4] = {{-outer[0], -outer[1], z},
                   {outer[0], -outer[1], z},
                   {outer[0], outer[1], z},
                   {-outer[0], outer[1], z}};
  const V3 i[4] = {{-inner[0], -inner[1], z},
                   {inner[0], -inner[1], z},
                   {inner[0], inner[1], z},
                   {-inner[0], inner[1], z}};
  for (int k = 0; k < 4; ++k) {
    const int n = (k + 1) % 4;
    up ? add_quad(out, o[k], o[n], i[n], i[k]) : add_quad(out, o[k], i[k], i[n], o[n]);
  }
}

void add_walls(std::vector<std::array<V3, 3>>& out, std::array<double, 2> half, double low,
               double high, bool outwards) {
  const double x[4] = {-half[0], half[0], half[0], -half[0]};
  const double y[4] = {-half[1], -half[1], half[1], half[1]};
  for (int k = 0; k < 4; ++k) {
    const int n = (k + 1) % 4;
    const V3 a{x[k], y[k], low}, b{x[n], y[n], low}, c{x[n], y[n], high}, d{x[k], y[k], high};
    outwards ? add_quad(out, a, b, c, d) : add_quad(out, a, d, c, b);
  }
}

std::vector<Piece> pieces_of(const RandomBody& b) {
  Piece whole{"", {}}, patch{"_patch", {}};
  auto& out = whole.triangle;
  const double hx = 0.5 * b.size_m[0], hy = 0.5 * b.size_m[1], hz = 0.5 * b.size_m[2];
  const auto level = [](std::vector<std::array<V3, 3>>& to, double x, double y, double z, bool up) {
    const V3 p[4] = {{-x, -y, z}, {x, -y, z}, {x, y, z}, {-x, y, z}};
    up ? add_quad(to, p[0], p[1], p[2], p[3]) : add_quad(to, p[0], p[3], p[2], p[1]);
  };
  switch (b.kind) {
    case RandomBody::Kind::kBox:
      level(out, hx, hy, hz, true);
      level(out, hx, hy, -hz, false);
      add_walls(out, {hx, hy}, -hz, hz, true);
      break;
    case RandomBody::Kind::kPlate:
      level(out, hx, hy, 0, true);
      break;
    case RandomBody::Kind::kSphere: {
      constexpr int kRings = 10, kSectors = 16;
      const auto at = [&](int ring, int sector) {
        const double t = std::numbers::pi * ring / kRings,
                     a = 2 * std::numbers::pi * (sector % kSectors) / kSectors;
        if (ring == 0) return V3{0, 0, hx};
        if (ring == kRings) return V3{0, 0, -hx};
        return V3{hx * std::sin(t) * std::cos(a), hx * std::sin(t) * std::sin(a), hx * std::cos(t)};
      };
      for (int r = 0; r < kRings; ++r)
        for (int s = 0; s < kSectors; ++s) {
          if (r > 0) out.push_back({at(r, s), at(r + 1, s), at(r, s + 1)});
          if (r + 1 < kRings) out.push_back({at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
        }
      break;
    }
    case RandomBody::Kind::kCup: {
      const double wall = 0.05 * std::min({b.size_m[0], b.size_m[1], b.size_m[2]});
      const std::array<double, 2> outer{hx, hy}, inner{hx - wall, hy - wall},
          rim{b.aperture * (hx - wall), b.aperture * (hy - wall)};
      add_walls(out, outer, -hz, hz, true);
      level(out, hx, hy, -hz, false);
      add_ring(out, outer, rim, hz, true);
      add_walls(out, rim, hz - wall, hz, false);
      add_ring(out, inner, rim, hz - wall, false);
      add_walls(out, inner, -hz + wall, hz - wall, false);
      if (b.patch > 0) {
        const std::array<double, 2> spot{b.patch * inner[0], b.patch * inner[1]};
        add_ring(out, inner, spot, -hz + wall, true);
        level(patch.triangle, spot[0], spot[1], -hz + wall, true);
      } else {
        level(out, inner[0], inner[1], -hz + wall, true);
      }
      break;
    }
  }
  std::vector<Piece> all;
  if (b.split) {
    Piece half{"_half", {}};
    for (std::size_t i = 0; i < out.size(); i += 2) half.triangle.push_back(out[i]);
    for (std::size_t i = 0; 2 * i + 1 < out.size(); ++i) out[i] = out[2 * i + 1];
    out.resize(out.size() / 2);
    all.push_back(half);
  }
  if (!whole.triangle.empty()) all.insert(all.begin(), whole);
  if (!patch.triangle.empty()) all.push_back(patch);
  return all;
}

}  // namespace

namespace {

// visit(east_m, north_m) of a scene that may be mirrored: at the sun's azimuth and its opposite.
template <typename Value>
std::string asc_of(const RandomScene& scene, const Value& value) {
  constexpr int kSamples = 201;
  const double shortest_m =
      std::min({scene.land.wave_m[0], scene.land.wave_m[1], scene.land.patch_m});
  const double spacing_m = shortest_m / 16, half_m = 0.5 * (kSamples - 1) * spacing_m;
  const double twice_rad = 2 * sun_of(scene.time).azimuth_deg * kRadPerDeg;
  std::string out = absl::StrFormat(
      "ncols %d\nnrows %d\nxllcenter %.12g\nyllcenter %.12g\n"
      "cellsize %.12g\n",
      kSamples, kSamples, -half_m, -half_m, spacing_m);
  for (int row = kSamples - 1; row >= 0; --row)
    for (int column = 0; column < kSamples; ++column) {
      double x = column * spacing_m - half_m, y = row * spacing_m - half_m;
      if (scene.mirrored) {
        const double mirrored_x = -std::cos(twice_rad) * x + std::sin(twice_rad) * y;
        y = std::sin(twice_rad) * x + std::cos(twice_rad) * y;
        x = mirrored_x;
      }
      absl::StrAppendFormat(&out, "%.9g%c", value(x, y), column + 1 < kSamples ? ' ' : '\n');
    }
  return out;
}

std::string beside(const std::string& model_name, const char* what) {
  return absl::StrCat(model_name.substr(0, model_name.rfind('.')), "_", what, ".asc");
}

}  // namespace

std::string heights_name(const std::string& model_name) { return beside(model_name, "heights"); }
std::string fractions_name(const std::string& model_name) {
  return beside(model_name, "fractions");
}

std::string heights_asc(const RandomScene& scene) {
  const RandomLand& land = scene.land;
  const double c = std::cos(land.turn_rad), s = std::sin(land.turn_rad);
  const auto wave = [&](int k, double along_m) {
    return std::sin(2 * std::numbers::pi * along_m / land.wave_m[k] + land.phase[k]);
  };
  return asc_of(scene, [&](double x, double y) {
    return land.amplitude_m * (wave(0, c * x + s * y) - wave(0, 0) + wave(1, x) - wave(1, 0));
  });
}

std::string fractions_asc(const RandomScene& scene) {
  return asc_of(scene, [&](double x, double y) {
    const double k = 2 * std::numbers::pi / scene.land.patch_m;
    return 0.5 + 0.25 * (std::sin(k * x) + std::cos(k * y + 1));
  });
}

std::string model_obj(const RandomScene& scene) {
  std::string out = absl::StrCat("# seed ", scene.seed, ", ", name_of(scene.family),
                                 ": x forward, y port, z up, metres\n");
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < scene.body.size(); ++i) {
    const RandomBody& b = scene.body[i];
    for (Piece piece : pieces_of(b)) {
      for (int round = 0; round < scene.subdivisions; ++round) {
        std::vector<std::array<V3, 3>> finer;
        for (const auto& [p, q, r] : piece.triangle) {
          const V3 pq = 0.5 * (p + q), qr = 0.5 * (q + r), rp = 0.5 * (r + p);
          finer.insert(finer.end(), {{p, pq, rp}, {pq, q, qr}, {rp, qr, r}, {pq, qr, rp}});
        }
        piece.triangle = std::move(finer);
      }
      absl::StrAppend(&out, "o ", scene.prefix, i, piece.name, "\n");
      std::string faces;
      for (const auto& triangle : piece.triangle) {
        for (const V3& own : triangle) {
          V3 v = b.centre_m + own[0] * b.axes[0] + own[1] * b.axes[1] + own[2] * b.axes[2];
          if (scene.mirrored) v[1] = -v[1];
          absl::StrAppend(&out, absl::StrFormat("v %.10g %.10g %.10g\n", v[0], v[1], v[2]));
        }
        absl::StrAppend(&faces, "f ", vertices + 1, " ", vertices + (scene.mirrored ? 3 : 2), " ",
                        vertices + (scene.mirrored ? 2 : 3), "\n");
        vertices += 3;
      }
      out += faces;
    }
  }
  return out;
}

std::string sweep_toml(const RandomScene& scene, const std::string& model_name) {
  const SceneSun sun = sun_of(scene.time);
  const bool land = scene.land.amplitude_m > 0;
  // Mirrored left for right, the sun stands as far on the other side of the bow.
  const double heading_deg = std::fmod(
      720 + (scene.mirrored ? 2 * sun.azimuth_deg - scene.heading_deg : scene.heading_deg), 360);
  const double azimuth_deg =
      std::fmod(720 + (scene.mirrored ? -scene.azimuth_deg : scene.azimuth_deg), 360);
  std::string out = absl::StrCat(
      "# irsig selftest --search: seed ", scene.seed, ", ", name_of(scene.family),
      "\nname = \"seed_", scene.seed, "\"\nseed = ", scene.sampler_seed, "\ntime = [\"", scene.time,
      "\"]\n\n[model]\nfile = \"", model_name,
      "\"\nunit_m = 1\nforward_axis = \"+x\"\nup_axis = \"+z\"\n\n[place]\nlatitude_deg = ",
      kLatitudeDeg, "\nlongitude_deg = ", kLongitudeDeg,
      "\nheading_deg = ", absl::StrFormat("%.9f", heading_deg), "\n");
  for (const RandomMaterial& m : scene.material)
    absl::StrAppend(&out, "\n[[material]]\nname = \"", m.name, "\"\n", m.toml);
  for (std::size_t i = 0; i < scene.body.size(); ++i) {
    const RandomBody& b = scene.body[i];
    for (const Piece& piece : pieces_of(b)) {
      const bool patch = piece.name == "_patch";
      absl::StrAppend(
          &out, "\n[[part]]\nname = \"", scene.prefix, i, piece.name, "\"\nmaterial = \"",
          scene.material[patch ? b.patch_material : b.material].name,
          "\"\ntemperature_k = ", number(patch ? b.patch_temperature_k : b.temperature_k), "\n",
          b.kind == RandomBody::Kind::kPlate ? "two_sided = true\n" : "");
    }
  }
  absl::StrAppend(&out, "\n[[season]]\nname = \"any\"\ndate = ", kDate, "\n",
                  scene.atmosphere && !land
                      ? absl::StrCat("wind_speed_m_s = ", number(scene.wind_speed_m_s), "\n")
                      : "",
                  scene.homogeneous_air
                      ? absl::StrCat("air_temperature_k = ", number(scene.air_temperature_k), "\n")
                      : "");
  if (scene.cloud.cover > 0)
    absl::StrAppend(&out, "\n[[season.cloud]]\nphase = ", scene.cloud.ice ? "\"ice\"" : "\"water\"",
                    "\ncover = ", number(scene.cloud.cover),
                    "\nbase_m = ", number(scene.cloud.base_m),
                    "\ntop_m = ", number(scene.cloud.base_m + scene.cloud.thickness_m),
                    "\nwater_path_g_m2 = ", number(scene.cloud.water_path_g_m2),
                    "\neffective_radius_um = ", number(scene.cloud.effective_radius_um), "\n");
  for (const RandomBand& b : scene.band)
    absl::StrAppend(&out, "\n[[band]]\nname = \"", number(b.lambda_min_um), "_",
                    number(b.lambda_max_um), "\"\nlambda_min_um = ", number(b.lambda_min_um),
                    "\nlambda_max_um = ", number(b.lambda_max_um),
                    "\nstep_um = ", number(b.step_um), "\n");
  absl::StrAppend(&out, "\n[viewpoints]\nkind = \"list\"\nrange_m = ", number(scene.range_m),
                  "\naspect = [ { azimuth_deg = ", absl::StrFormat("%.10f", azimuth_deg),
                  ", elevation_deg = ", absl::StrFormat("%.10f", scene.elevation_deg), " } ]\n");
  absl::StrAppend(&out, "\n[surroundings]\nkind = ",
                  land        ? "\"ground\"\n"
                  : scene.sea ? "\"sea\"\n"
                              : "\"none\"\n");
  if (!scene.atmosphere)
    absl::StrAppend(&out, "sky_temperature_k = ", number(scene.sky_temperature_k), "\n");
  if (land)
    absl::StrAppend(&out, "ground_temperature_k = ", number(scene.land.ground_temperature_k),
                    "\nground_emissivity = 0.95\n\n[land]\nheights = \"", heights_name(model_name),
                    "\"\n\n[[land.material]]\nmaterial = \"grass\"\nfraction_file = \"",
                    fractions_name(model_name),
                    "\"\ntemperature_k = ", number(scene.land.temperature_k[0]),
                    "\n\n[[land.material]]\nmaterial = \"bare_soil_dry\"\ntemperature_k = ",
                    number(scene.land.temperature_k[1]), "\n");
  else if (scene.sea)
    absl::StrAppend(&out, "sea_temperature_k = ", number(scene.sea_temperature_k), "\n",
                    scene.atmosphere
                        ? ""
                        : absl::StrCat("sea_emissivity = ", number(scene.sea_emissivity), "\n"));
  else
    absl::StrAppend(&out, "lower_radiance_w_m2_sr_um = ", number(scene.lower_radiance_w_m2_sr_um),
                    "\n");
  if (scene.atmosphere)
    absl::StrAppend(
        &out, "\n[air]\nmodel = \"atmosphere\"\naerosol = ", land ? "\"rural\"" : "\"maritime\"",
        "\nvisibility_m = ", number(scene.visibility_m), "\n");
  else if (scene.homogeneous_air)
    absl::StrAppend(&out, "\n[air]\nmodel = \"homogeneous\"\nabsorption_m2_kg = ",
                    number(scene.absorption_m2_kg),
                    "\npressure_pa = 101325\ngas_constant_j_kg_k = 287\npath_emission = ",
                    scene.path_emission ? "true" : "false", "\n");
  else
    absl::StrAppend(&out, "\n[air]\nmodel = \"vacuum\"\n");
  absl::StrAppend(
      &out, "\n[transport]\nsun = ", scene.sun ? "true" : "false", "\n",
      scene.max_reflections >= 0 ? absl::StrCat("max_reflections = ", scene.max_reflections, "\n")
                                 : "",
      "\n[accuracy]\nrelative_error = ", number(scene.relative_error),
      "\nmax_samples_per_replicate = ", scene.max_samples_per_replicate, "\n",
      scene.all_effects ? "\n[effects]\nmode = \"all\"\n" : "", "\n[output]\nthumbnail_px = 0\n");
  return out;
}

}  // namespace irsig

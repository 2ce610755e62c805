#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/accuracy/replicates.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/materials/material.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"
#include "verify/cases/hard_materials.h"

namespace irsig {
namespace {

constexpr double kNodeUm = 4.5;  // half a micrometre off the PRISSE model's centre

absl::StatusOr<Material> prepared(const MaterialSpec& spec) {
  auto material = Material::prepare(spec, {kNodeUm}, kNodeUm, kNodeUm);
  if (!material.ok())
    return absl::Status(material.status().code(),
                        absl::StrCat(spec.name, ": ", material.status().message()));
  return material;
}

struct Prepared {
  std::string name;
  bool bounded;
  Material material;
};

// Every model and form at every roughness. Preparing them takes seconds: once for all cases.
const absl::StatusOr<std::vector<Prepared>>& all_materials() {
  static const absl::StatusOr<std::vector<Prepared>> all =
      []() -> absl::StatusOr<std::vector<Prepared>> {
    std::vector<Prepared> out;
    for (const double roughness : kRoughness)
      for (const HardMaterial& kind : every_material(roughness)) {
        ASSIGN_OR_RETURN(auto material, prepared(kind.spec));
        out.push_back({kind.name, kind.bounded, std::move(material)});
      }
    return out;
  }();
  return all;
}

// f(name, material) of each.
template <typename Function>
absl::Status for_each_material(Function&& f) {
  const auto& all = all_materials();
  if (!all.ok()) return all.status();
  for (const Prepared& p : *all) f(p.name, p.material);
  return absl::OkStatus();
}

// To within a micro-degree of the facet's plane.
constexpr double kThetaDeg[] = {0, 1e-4, 10, 30, 60, 80, 85, 89, 89.9, 89.99, 89.9999, 90 - 1e-6};

float cosine(double theta_deg) {
  return static_cast<float>(std::sin((90 - theta_deg) * kRadPerDeg));
}

auto angle(const std::string& name, double theta_deg) {
  return [&name, theta_deg] { return absl::StrCat(name, ", ", theta_deg, " deg"); };
}

absl::StatusOr<Finding> energy(Effort) {
  Worst worst(1e-4);
  const auto& all = all_materials();
  if (!all.ok()) return all.status();
  for (const Prepared& p : *all) {
    if (p.bounded)
      worst.require(!p.material.creates_energy(),
                    [&] { return p.name + ": flagged as creating energy"; });
    for (const double theta_deg : kThetaDeg) {
      const auto [emissivity, dhr] = p.material.emissivity_and_dhr(cosine(theta_deg));
      worst.require(emissivity >= 0 && emissivity <= 1 && std::isfinite(dhr) && dhr >= 0,
                    angle(p.name, theta_deg));
      // More than 1 in all only of a form that says so.
      if (!p.material.creates_energy())
        worst.see(std::abs(emissivity + dhr - 1.0), angle(p.name, theta_deg));
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> flags(Effort) {
  Worst worst(0);
  for (const HardMaterial& kind : gaining_materials()) {
    ASSIGN_OR_RETURN(const auto material, prepared(kind.spec));
    worst.require(material.creates_energy(), [&] { return kind.name; });
  }
  return worst.finding();
}

Material::Sampled draw(const Material& m, float cos_o, std::uint64_t seed, std::uint64_t i) {
  const double phi = 2 * std::numbers::pi * uniform(seed, 3 * i + 2);
  // Uniform numbers as the sampler makes them: 23 bits, never 0 or 1.
  const auto bits = [&](std::uint64_t k) {
    return (static_cast<float>(std::floor(0x1p23 * uniform(seed, k))) + 0.5f) * 0x1p-23f;
  };
  return m.sample(cos_o, bits(3 * i), bits(3 * i + 1), static_cast<float>(std::cos(phi)),
                  static_cast<float>(std::sin(phi)));
}

// White furnace: what a facet reflects of a uniform world is its DHR. The mean weight of directions
// drawn one by one against the table, which is a quadrature.
absl::StatusOr<Finding> furnace(Effort effort) {
  constexpr double kTheta[] = {0, 45, 75, 88};
  Worst worst(student_t_bound(31, 11 * kRoughness.size() * std::size(kTheta)));
  const std::uint64_t draws = effort == Effort::kFull ? 1 << 16 : 1 << 11;
  std::uint64_t row = 0;
  const auto status = for_each_material([&](const std::string& name, const Material& m) {
    for (const double theta_deg : kTheta) {
      const float cos_o = cosine(theta_deg);
      ReplicateStatistics statistics(1);
      ++row;
      for (std::uint64_t replicate = 0; replicate < 32; ++replicate) {
        double sum = 0;
        for (std::uint64_t i = 0; i < draws; ++i)
          sum += static_cast<double>(draw(m, cos_o, 1000 * row + replicate, i).weight);
        const double mean[] = {sum / static_cast<double>(draws)};
        statistics.add(mean);
      }
      // Both tables are within 5e-5 (material.h).
      worst.see(
          t_of(statistics.estimate(0), m.dhr_max(cos_o), 1e-4 * std::max(1.0f, m.dhr_max(cos_o))),
          [&] {
            return absl::StrCat(name, ", ", theta_deg, " deg: ", statistics.estimate(0).value,
                                " +- ", statistics.estimate(0).stderr_, ", DHR ", m.dhr_max(cos_o));
          });
    }
  });
  if (!status.ok()) return status;
  return worst.finding();
}

// Every number that a path may ask for, up to a micro-degree from the facet's plane.
absl::StatusOr<Finding> grazing(Effort effort) {
  Worst worst(0);
  const std::uint64_t draws = effort == Effort::kFull ? 100'000 : 1'000;
  const auto status = for_each_material([&](const std::string& name, const Material& m) {
    for (const double theta_deg : kThetaDeg) {
      const float cos_o = cosine(theta_deg);
      for (std::uint64_t i = 0; i < draws; ++i) {
        const Material::Sampled s = draw(m, cos_o, 77, i);
        const auto good = [](float x) { return std::isfinite(x) && x >= 0; };
        worst.require(good(s.weight), angle(name, theta_deg));
        if (s.weight <= 0) continue;
        const float unit = s.x * s.x + s.y * s.y + s.z * s.z;
        worst.require(good(m.brdf_per_sr(s.at)) && good(m.density_per_sr(s.at)) && s.z > 0 &&
                          std::abs(unit - 1) < 1e-5f,
                      angle(name, theta_deg));
      }
    }
  });
  if (!status.ok()) return status;
  return worst.finding();
}

// The weight of a drawn direction is what brdf and density say of it.
absl::StatusOr<Finding> weights(Effort effort) {
  Worst worst(1e-3);
  const std::uint64_t draws = effort == Effort::kFull ? 10'000 : 500;
  const auto status = for_each_material([&](const std::string& name, const Material& m) {
    for (const double theta_deg : {0.0, 30.0, 60.0, 80.0, 88.0})
      for (std::uint64_t i = 0; i < draws; ++i) {
        const Material::Sampled s = draw(m, cosine(theta_deg), 78, i);
        const float density = m.density_per_sr(s.at);
        if (s.weight <= 0 || density <= 0) continue;
        worst.see(std::abs(m.brdf_per_sr(s.at) * s.at.cos_i / (density * s.weight) - 1),
                  angle(name, theta_deg));
      }
  });
  if (!status.ok()) return status;
  return worst.finding();
}

// Both directions exchanged.
absl::StatusOr<Finding> reciprocity(Effort effort) {
  Worst worst(1e-4);
  const std::uint64_t draws = effort == Effort::kFull ? 10'000 : 500;
  const auto status = for_each_material([&](const std::string& name, const Material& m) {
    for (const double theta_deg : {0.0, 30.0, 60.0, 80.0, 88.0, 89.9999})
      for (std::uint64_t i = 0; i < draws; ++i) {
        const Material::Sampled s = draw(m, cosine(theta_deg), 79, i);
        if (s.weight <= 0) continue;
        Reflection back = s.at;
        std::swap(back.cos_i, back.cos_o);
        const float there = m.brdf_per_sr(s.at), again = m.brdf_per_sr(back);
        if (there > 0) worst.see(std::abs(again / there - 1), angle(name, theta_deg));
      }
  });
  if (!status.ok()) return status;
  return worst.finding();
}

// Emissivity 0 reflects all, emissivity 1 nothing: exactly.
absl::StatusOr<Finding> black_and_white(Effort) {
  Worst worst(0);
  for (const double emissivity : {0.0, 1.0}) {
    ASSIGN_OR_RETURN(const auto m, prepared(grey_paint(emissivity)));
    for (const double theta_deg : kThetaDeg) {
      const auto e = m.emissivity_and_dhr(cosine(theta_deg));
      worst.see(std::abs(e.emissivity - emissivity) + std::abs(e.dhr_max - (1 - emissivity)),
                [&] { return absl::StrCat("emissivity ", emissivity, ", ", theta_deg, " deg"); });
    }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> material_cases() {
  return {
      {"materials", "energy",
       "every model, roughness 1e-4 to 1, to 90 deg - 1e-6: |emissivity + DHR - 1|; 0 to 1 each",
       "Kirchhoff's law; both tables are within 5e-5 of their quadrature (material.h)", energy},
      {"materials", "flags", "published forms that create energy: not flagged",
       "their DHR exceeds 1 (docs/explanation/methods.md)", flags},
      {"materials", "furnace", "every model and roughness: mean sampling weight against DHR [t]",
       "Student's t of all rows, 31 degrees of freedom, after the tables' 1e-4", furnace},
      {"materials", "grazing", "to 90 deg - 1e-6: values not finite, negative, not a direction",
       "none is allowed: a path asks for all of them", grazing},
      {"materials", "weights", "weight of a drawn direction against brdf cos / density, relative",
       "floats: a lobe's exponent of up to 16 magnifies the 6e-8 of its argument's five roundings "
       "to 5e-6; two Fresnel look-ups and 1e-3 where a lobe of 1e-4 is re-evaluated from half "
       "vectors that carry 6e-8 / 1e-4",
       weights},
      {"materials", "reciprocity", "brdf with the directions exchanged, relative",
       "the same half vector on both sides: only cosines trade places, a few roundings of 6e-8",
       reciprocity},
      {"materials", "black_and_white", "emissivity 0 and 1: emissivity and DHR, absolute",
       "0 and 1 are exact in every format", black_and_white},
  };
}

}  // namespace irsig

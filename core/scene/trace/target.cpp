#include "core/scene/trace/target.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"

namespace irsig {

absl::StatusOr<std::vector<std::uint32_t>> part_of_groups(const Mesh& mesh,
                                                          const std::vector<PartSpec>& parts) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part_of_group(mesh.group.size(), kNone);
  Problems errors;
  const auto wrong = [&](const std::string& key, const std::string& what) {
    errors.add(keyed_problem(key, what));
  };
  std::uint32_t rest = kNone;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (parts[i].rest) {
      if (rest != kNone)
        wrong(absl::StrCat("part[", i, "].rest"),
              absl::StrCat("part \"", parts[rest].name, "\" takes the rest already"));
      rest = i;
      continue;
    }
    std::vector<std::string> patterns = parts[i].match;
    if (patterns.empty()) patterns.push_back(parts[i].name);
    for (std::size_t k = 0; k < patterns.size(); ++k) {
      bool matched = false;
      for (std::size_t g = 0; g < mesh.group.size(); ++g) {
        if (!group_matches(mesh.group[g], patterns[k])) continue;
        matched = true;
        if (part_of_group[g] != kNone && part_of_group[g] != i)
          wrong(absl::StrCat("part[", i, "]"),
                absl::StrCat("group \"", mesh.group[g],
                             "\" of the model already belongs to part \"",
                             parts[part_of_group[g]].name, "\""));
        else
          part_of_group[g] = i;
      }
      if (!matched)
        wrong(absl::StrCat("part[", i, "]", parts[i].match.empty() ? ".name" : ".match"),
              absl::StrCat("no group of the model matches \"", patterns[k], "\" (its groups: ",
                           absl::StrJoin(mesh.group, ", "),
                           "), expected match = [\"GROUP\"] or rest = true"));
    }
  }
  std::vector<bool> used(mesh.group.size(), false);
  for (const std::uint32_t g : mesh.triangle_group) used[g] = true;
  bool any_left = false;
  for (std::size_t g = 0; g < mesh.group.size() && rest != kNone; ++g)
    if (part_of_group[g] == kNone) {
      part_of_group[g] = rest;
      any_left = any_left || used[g];
    }
  if (rest != kNone && !any_left)
    wrong(absl::StrCat("part[", rest, "].rest"), "no group of the model is left for it");
  for (std::size_t g = 0; g < mesh.group.size(); ++g)
    if (used[g] && part_of_group[g] == kNone)
      wrong("part", absl::StrCat("no part matches group \"", mesh.group[g],
                                 "\" of the model, so it has neither material nor temperature"));
  if (!errors.empty()) return errors.status();
  return part_of_group;
}

namespace {

// Returns true if no vertex lies above a facet's plane by more than half of the offset at which
// rays start (on neither side of a facet that is seen from both).
bool is_convex(const Target& target) {
  constexpr std::size_t kMostProducts = 200'000'000;
  const std::size_t vertices = target.vertex.size() / 3;
  if (vertices == 0 || target.facet.size() > kMostProducts / vertices) return false;
  const auto allowed = static_cast<float>(0.5 * target.offset_m());
  for (std::size_t i = 0; i < target.facet.size(); ++i) {
    const Target::Facet& f = target.facet[i];
    if (f.nx == 0 && f.ny == 0 && f.nz == 0) continue;
    const bool both = target.part[f.part].two_sided;
    const float* corner =
        target.vertex.data() + 3 * static_cast<std::size_t>(target.triangle[3 * i]);
    for (std::size_t v = 0; v < vertices; ++v) {
      const float* p = target.vertex.data() + 3 * v;
      const float above =
          f.nx * (p[0] - corner[0]) + f.ny * (p[1] - corner[1]) + f.nz * (p[2] - corner[2]);
      if (above > allowed || (both && above < -allowed)) return false;
    }
  }
  return true;
}

}  // namespace

absl::StatusOr<Target> make_target(const Mesh& mesh, std::vector<PartSpec> parts, TracerIsa isa,
                                   TracerOptions options) {
  ASSIGN_OR_RETURN(auto part_of_group, part_of_groups(mesh, parts));

  Target target;
  target.part = std::move(parts);
  target.part_area_m2.assign(target.part.size(), 0.0);
  Vec<Body> low = mesh.vertex.front(), high = low;
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  target.centre = 0.5 * (low + high);
  target.z_extent_m = {low.z, high.z};
  target.vertex.reserve(3 * mesh.vertex.size());
  for (const Vec<Body>& v : mesh.vertex) {
    const Vec<Body> d = v - target.centre;
    target.radius_m = std::max(target.radius_m, length(d));
    for (const double x : {d.x, d.y, d.z}) {
      target.vertex.push_back(static_cast<float>(x));
      target.rounded_m.push_back(static_cast<float>(x - static_cast<double>(target.vertex.back())));
    }
  }
  target.triangle.reserve(3 * mesh.triangle.size());
  target.facet.reserve(mesh.triangle.size());
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    const auto& corner = mesh.triangle[i];
    const Vec<Body> a = mesh.vertex[corner[0]];
    const Vec<Body> twice = cross(mesh.vertex[corner[1]] - a, mesh.vertex[corner[2]] - a);
    const double norm = length(twice);
    const std::uint32_t part = part_of_group[mesh.triangle_group[i]];
    const double inverse = norm > 0 ? 1 / norm : 0;
    target.facet.push_back({static_cast<float>(inverse * twice.x),
                            static_cast<float>(inverse * twice.y),
                            static_cast<float>(inverse * twice.z), part});
    target.part_area_m2[part] += 0.5 * norm;
    target.triangle.insert(target.triangle.end(), corner.begin(), corner.end());
  }
  ASSIGN_OR_RETURN(auto tracer, Tracer::build(target.vertex, target.triangle, isa, options));
  target.tracer = std::move(tracer);
  target.convex = is_convex(target);
  return target;
}

std::vector<TurnedArea> turned_areas(const Target& target, Vec<Body> towards) {
  const auto at = [](const std::vector<float>& of, std::uint32_t v) {
    const float* p = of.data() + 3 * static_cast<std::size_t>(v);
    return Vec<Body>{p[0], p[1], p[2]};
  };
  std::vector<std::vector<std::uint32_t>> facets(target.part.size());
  for (std::uint32_t f = 0; f < target.facet.size(); ++f) facets[target.facet[f].part].push_back(f);
  std::vector<TurnedArea> out(facets.size());
  // Change of the area with each vertex.
  std::vector<Vec<Body>> gradient(target.vertex.size() / 3);
  for (std::size_t part = 0; part < facets.size(); ++part) {
    const auto for_corners = [&](auto&& of) {
      for (const std::uint32_t f : facets[part]) {
        const std::uint32_t* corner = target.triangle.data() + 3 * static_cast<std::size_t>(f);
        const Vec<Body> p[] = {at(target.vertex, corner[0]), at(target.vertex, corner[1]),
                               at(target.vertex, corner[2])};
        const double turned = 0.5 * dot(cross(p[1] - p[0], p[2] - p[0]), towards);
        if (turned < 0 && !target.part[part].two_sided) continue;
        of(corner, p, turned);
      }
    };
    for_corners([&](const std::uint32_t* corner, const Vec<Body>* p, double turned) {
      out[part].m2 += std::abs(turned);
      for (std::size_t k = 0; k < 3; ++k)
        gradient[corner[k]] =
            gradient[corner[k]] +
            (turned < 0 ? -0.5 : 0.5) * cross(p[(k + 2) % 3] - p[(k + 1) % 3], -1.0 * towards);
    });
    for_corners([&](const std::uint32_t* corner, const Vec<Body>*, double) {
      for (std::size_t k = 0; k < 3; ++k) {
        out[part].rounding_m2 +=
            std::abs(dot(gradient[corner[k]], at(target.rounded_m, corner[k])));
        gradient[corner[k]] = {0, 0, 0};
      }
    });
  }
  return out;
}

}  // namespace irsig

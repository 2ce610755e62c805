#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh_measure.h"
#include "core/spectral/planck.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"
#include "verify/cases/ray_shots.h"
#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

// Closed bodies and a region inside them from which rays start: origin + stretch * (point of the
// unit cube).
struct Closed {
  const char* name;
  Mesh mesh;
  Vec<Body> low, high;  // of the region, body frame
};

absl::StatusOr<std::vector<Closed>> closed_bodies() {
  std::vector<Closed> out;
  ASSIGN_OR_RETURN(auto sphere, generate_mesh({"sphere", 20000}));
  out.push_back({"sphere", std::move(sphere), {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}});
  // Walls 13 mm wide and 50 m long (1 : 4000), fans of 500 needles.
  out.push_back({"needle drum", needle_drum(500, 1, 50), {-22, -0.6, -0.6}, {22, 0.6, 0.6}});
  // Strips 40 um wide and 20 m long (1 : 500000).
  out.push_back({"needle slab", needle_slab(500, 20, 0.02), {-9, -0.009, -0.45}, {9, 0.009, 0.45}});
  ASSIGN_OR_RETURN(auto frigate, generate_mesh({"frigate", 20000}));
  out.push_back({"frigate", std::move(frigate), {-40, -3, -4}, {40, 3, -1}});
  for (const Closed& body : out) {
    const MeshMeasure m = measure(body.mesh);
    if (m.open_edges > 0 || !(m.volume_m3 > 0))
      return absl::InternalError(absl::StrCat(body.name, " is not closed: ", m.open_edges,
                                              " open edges, ", m.volume_m3, " m3"));
  }
  return out;
}

// Offsets of a mesh, as in local, projected and Earth-centred coordinates.
constexpr double kOffsetsM[] = {0, 1e3, 1e5, 6.4e6};

Vec<Body> far_away(double offset_m) { return offset_m * Vec<Body>{0.48, -0.6, 0.64}; }

absl::StatusOr<Target> target_of(const Mesh& mesh) {
  return make_target(mesh, {{"body", {"*"}, 0, false, false}}, widest_isa());
}

// aim(target, i, origin): the direction of ray i.
template <typename Aim>
absl::StatusOr<Finding> lost_rays(std::uint64_t rays_of_each, Aim&& aim) {
  Worst worst(0);
  std::uint64_t rays = 0;
  ASSIGN_OR_RETURN(auto bodies, closed_bodies());
  for (const Closed& body : bodies)
    for (const double offset : kOffsetsM) {
      ASSIGN_OR_RETURN(const auto target, target_of(moved(body.mesh, far_away(offset))));
      const Vec<Body> low = body.low + far_away(offset) - target.centre;
      const MeshMeasure m = measure(body.mesh);
      // Half a start offset of a body of this size, wherever it stands.
      const double near_m = 0x1p-21 * length(m.box_max - m.box_min);
      std::uint64_t lost = 0, misplaced = 0;
      for (std::size_t v = 0; v < body.mesh.vertex.size(); ++v) {
        const float* x = target.vertex.data() + 3 * v;
        const Vec<Body> kept = Vec<Body>{x[0], x[1], x[2]} + target.centre - far_away(offset);
        misplaced += length(kept - body.mesh.vertex[v]) < near_m ? 0 : 1;
      }
      shoot(
          *target.tracer, rays_of_each, false,
          [&](std::uint64_t i, Shot& shot) {
            const Vec<Body> span = body.high - body.low;
            shot.origin = to_float3(low + Vec<Body>{uniform(1, 3 * i) * span.x,
                                                    uniform(1, 3 * i + 1) * span.y,
                                                    uniform(1, 3 * i + 2) * span.z});
            shot.direction = aim(target, i, shot.origin);
          },
          [&](std::uint64_t, const Shot& shot) {
            if (!shot.hit)
              ++lost;
            else if (!(distance_from_plane_m(target, shot.triangle, shot.point()) < near_m))
              ++misplaced;
          });
      rays += rays_of_each;
      worst.see(static_cast<double>(lost + misplaced), [&] {
        return absl::StrCat(body.name, " at ", offset, " m: ", lost, " lost, ", misplaced,
                            " hits or vertices misplaced, of ", rays_of_each);
      });
    }
  Finding out = worst.finding();
  if (out.worst_error == 0) out.where = absl::StrCat(rays, " rays");
  out.checks = rays;
  return out;
}

// 16 combinations of body and offset.
std::uint64_t rays_of_each(Effort effort) {
  return effort == Effort::kFull ? 100'000'000 / 16 : 1'000'000 / 16;
}

// Rays past a vertex are decided by exact arithmetic: dearer.
std::uint64_t aimed_rays_of_each(Effort effort) {
  return effort == Effort::kFull ? 1'000'000 / 16 : 160'000 / 16;
}

absl::StatusOr<Finding> random_rays(Effort effort) {
  return lost_rays(rays_of_each(effort), [](const Target&, std::uint64_t i, Float3) {
    return to_float3(uniform_direction(2, i));
  });
}

Float3 towards(Float3 origin, Vec<Body> at) {
  return to_float3({at.x - origin.x, at.y - origin.y, at.z - origin.z});
}

Vec<Body> corner_of(const Target& target, std::size_t triangle, std::size_t k) {
  const float* v = target.vertex.data() + 3 * target.triangle[3 * triangle + k];
  return {v[0], v[1], v[2]};
}

std::size_t some_triangle(const Target& target, std::uint64_t i) {
  return static_cast<std::size_t>(uniform(3, i) * static_cast<double>(target.facet.size()));
}

absl::StatusOr<Finding> vertex_rays(Effort effort) {
  return lost_rays(aimed_rays_of_each(effort),
                   [](const Target& target, std::uint64_t i, Float3 origin) {
                     return towards(origin, corner_of(target, some_triangle(target, i), i % 3));
                   });
}

absl::StatusOr<Finding> edge_rays(Effort effort) {
  return lost_rays(aimed_rays_of_each(effort),
                   [](const Target& target, std::uint64_t i, Float3 origin) {
                     const std::size_t triangle = some_triangle(target, i);
                     const Vec<Body> a = corner_of(target, triangle, i % 3),
                                     b = corner_of(target, triangle, (i + 1) % 3);
                     return towards(origin, a + uniform(4, i) * (b - a));
                   });
}

// The nearest facet, and what shadow rays say just before and behind it, judged by exact arithmetic
// on the same coordinates: nothing lost, nothing invented.
absl::StatusOr<Finding> exact_arithmetic(Effort effort) {
  Worst worst(0);
  std::uint64_t rays = 0;
  std::vector<NamedMesh> meshes = hard_closed_meshes(5000);
  meshes.push_back({"needle drum", needle_drum(200, 1, 50)});
  meshes.push_back({"needle slab, askew", needle_slab(200, 20, 0.2)});
  for (Vec<Body>& v : meshes.back().mesh.vertex) v = askew(v);
  for (const NamedMesh& m : meshes)
    for (const double offset : kOffsetsM) {
      // The hardest of them alone; making the judge costs most of the time.
      if (effort == Effort::kShort && offset < 6e6) continue;
      ASSIGN_OR_RETURN(const auto mesh, import_from_offset(m.mesh, offset));
      for (const AimedAt aimed : {AimedAt::kRandom, AimedAt::kEdges, AimedAt::kVertices}) {
        WatertightCheck check;
        check.aimed_at = aimed;
        check.rays = effort == Effort::kFull ? 1'000'000 / 28 : 1000;
        ASSIGN_OR_RETURN(const auto counts, check_watertight(mesh, check));
        rays += counts.rays;
        worst.see(static_cast<double>(counts.failures()), [&] {
          return absl::StrCat(m.name, " at ", offset, " m, aim ", static_cast<int>(aimed), ": ",
                              counts.lost, " lost, ", counts.invented, " invented, ",
                              counts.shadow_lost, " shadows lost, ", counts.shadow_invented,
                              " invented of ", counts.rays, "; ", counts.first_failure);
        });
      }
    }
  Finding out = worst.finding();
  out.checks = rays;
  if (out.worst_error == 0) out.where = absl::StrCat(rays, " rays");
  return out;
}

// Needles 1 : 20000, met 0.1 to 1e-4 deg from their plane: each ray must end on the upper face, no
// further from its plane than a reflected ray's start. In floats the face is askew by 1e-6 m: each
// needle is tilted by up to 0.05 deg, and some rays run within the plane of one.
absl::StatusOr<Finding> grazing_needles(Effort effort) {
  Worst worst(0);
  constexpr std::uint32_t kNeedles = 2000;
  const std::uint64_t rays = effort == Effort::kFull ? 200'000 : 10'000;
  for (const bool turned : {false, true})
    for (const double offset : {0.0, 6.4e6}) {
      const auto place = [&](Vec<Body> v) { return turned ? askew(v) : v; };
      Mesh slab = needle_slab(kNeedles, 20, 2);
      for (Vec<Body>& v : slab.vertex) v = place(v);
      ASSIGN_OR_RETURN(const auto target, target_of(moved(slab, far_away(offset))));
      const Vec<Body> up = place({0, 0, -1}),
                      centre = target.centre - far_away(offset);  // where the box says it is
      for (const double theta_deg : {89.9, 89.99, 89.9999}) {
        std::uint64_t lost = 0, through = 0, off = 0;
        shoot(
            *target.tracer, rays, false,
            [&](std::uint64_t i, Shot& shot) {
              // Along, across and askew to the needles.
              const double phi = (static_cast<double>(i % 3) * 45 + uniform(5, 3 * i)) * kRadPerDeg,
                           theta = theta_deg * kRadPerDeg;
              const Vec<Body> d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                std::cos(theta)};
              const Vec<Body> at{16 * (uniform(5, 3 * i + 1) - 0.5),
                                 1.6 * (uniform(5, 3 * i + 2) - 0.5), -0.5};
              // So near that the rounding of the direction does not carry it past the face.
              shot.origin = to_float3(place(at - d) - centre);
              shot.direction = to_float3(place(d));
            },
            [&](std::uint64_t, const Shot& shot) {
              if (!shot.hit) {
                ++lost;
              } else if (shot.triangle >= 2 * kNeedles) {
                ++through;
              } else {
                const Float3 p = shot.point();
                const double height = dot(Vec<Body>{p.x, p.y, p.z} + centre, up) - 0.5;
                off += std::abs(height) < 0.5 * target.offset_m() ? 0 : 1;
              }
            },
            static_cast<float>(target.offset_m()));
        worst.see(static_cast<double>(lost + through + off), [&] {
          return absl::StrCat(theta_deg, " deg, offset ", offset, " m",
                              turned ? ", turned: " : ": ", lost, " lost, ", through,
                              " through the face, ", off, " off it, of ", rays);
        });
      }
    }
  return worst.finding();
}

// A mesh in Earth-centred metres, written and read again as text: facets of 2 mm keep their shape.
absl::StatusOr<Finding> text_at_earth_radius(Effort) {
  Worst worst(1e-6);
  ASSIGN_OR_RETURN(auto sphere, generate_mesh({"sphere", 20000, 0.25}));
  const MeshMeasure near = measure(sphere);
  for (const double offset : kOffsetsM) {
    const std::string text = write_obj(moved(sphere, far_away(offset)));
    MeshImport how;
    how.file_name = "far.obj";
    how.reference = "bbox_center";
    ASSIGN_OR_RETURN(const auto read, import_mesh(text, how));
    const MeshMeasure far = measure(read);
    const auto where = [&] { return absl::StrCat("offset ", offset, " m"); };
    worst.require(far.open_edges == 0 && read.degenerate_triangles == 0, where);
    worst.see(std::abs(far.area_m2 / near.area_m2 - 1), where);
    worst.see(std::abs(far.volume_m3 / near.volume_m3 - 1), where);
  }
  return worst.finding();
}

// A binary STL of the same sphere: float32 at 6.4e6 m is 0.5 m coarse.
std::string binary_stl(const Mesh& mesh) {
  static_assert(std::endian::native == std::endian::little);
  std::string out(80, ' ');
  const auto put = [&](auto value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    out.append(bytes, sizeof(value));
  };
  put(static_cast<std::uint32_t>(mesh.triangle.size()));
  for (const auto& t : mesh.triangle) {
    for (int k = 0; k < 3; ++k) put(0.0f);
    for (const std::uint32_t corner : t)
      for (const double x : {mesh.vertex[corner].x, mesh.vertex[corner].y, mesh.vertex[corner].z})
        put(static_cast<float>(x));
    put(std::uint16_t{0});
  }
  return out;
}

absl::StatusOr<Finding> float_formats_refused(Effort) {
  Worst worst(0);
  ASSIGN_OR_RETURN(auto box, generate_mesh({"box", 12}));
  MeshImport how;
  how.file_name = "far.stl";
  how.reference = "bbox_center";
  const auto near = import_mesh(binary_stl(box), how);
  worst.require(near.ok() && std::abs(measure(*near).volume_m3 - 1) < 1e-6,
                [] { return "at the origin the file is good, and must be read"; });
  for (const double offset : {1e5, 6.4e6}) {
    const auto far = import_mesh(binary_stl(moved(box, far_away(offset))), how);
    worst.require(!far.ok() || std::abs(measure(*far).volume_m3 - 1) < 0.05,
                  [&] { return absl::StrCat("offset ", offset, " m: read, and distorted"); });
    if (offset > 1e6)
      worst.require(!far.ok(), [&] { return absl::StrCat("offset ", offset, " m: not refused"); });
  }
  return worst.finding();
}

// A ray that leaves a convex body never meets it again, whatever its size and place.
absl::StatusOr<Finding> self_intersection(Effort effort) {
  Worst worst(0);
  for (const double radius : {1e-3, 1.0, 1e3, 1e5})
    for (const double offset : {0.0, 5 * radius}) {
      ASSIGN_OR_RETURN(auto sphere, generate_mesh({"sphere", 5000, radius}));
      ASSIGN_OR_RETURN(
          const auto simulator,
          Simulator::create(one_body(moved(sphere, far_away(offset)), grey_paint(0.5))));
      ViewRequest r = dark_view(*simulator, 30, 20, 50 * radius, {300});
      r.max_reflections = 3;
      r.condition[0].surroundings = {SurroundingsKind::kNone, 300, 0, 0, 1, 10};
      r.accuracy.samples_per_replicate = effort == Effort::kFull ? 65536 : 2048;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
      const double again =
          view.row[0].cause_w_sr[static_cast<std::size_t>(Cause::kPartsReflected)].value;
      worst.see(again / view.row[0].intensity_w_sr.value +
                    static_cast<double>(view.guarded_backface_hits),
                [&] { return absl::StrCat("radius ", radius, " m, offset ", offset, " m"); });
    }
  return worst.finding();
}

// Area and intensity of a plate of 1 m2 (emissivity 0.5, 300 K) that looks at the sensor, with
// something done to its mesh.
absl::StatusOr<ViewResult> look_at(const Mesh& mesh, bool two_sided, double range_m,
                                   std::uint64_t samples, double azimuth_deg = 0) {
  SceneSpec scene = one_body(mesh, grey_paint(0.5));
  scene.part[0].two_sided = two_sided;
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  ViewRequest r = dark_view(*simulator, azimuth_deg, 0, range_m, {300});
  r.accuracy.samples_per_replicate = samples;
  return simulator->simulate(r);
}

// How far the plate's intensity is from emissivity x area x Planck, in standard errors.
double plate_t(const ViewResult& view, double cosine = 1) {
  const double expected = 0.5 * cosine * planck_band_radiance_w_m2_sr(8, 12, 300);
  return t_of(view.row[0].intensity_w_sr, expected, kMaskMargin * expected);
}

absl::StatusOr<Finding> duplicates(Effort effort) {
  Worst worst(student_t_bound(31, 9));
  const std::uint64_t samples = effort == Effort::kFull ? 65536 : 2048;
  const Mesh once = plate(1, 1, 10);
  const struct {
    const char* name;
    Mesh mesh;
    bool two_sided;
    double azimuth_deg;
  } variants[] = {
      {"once", once, false, 20},
      {"the same facets twice", joined(once, once, "again/"), false, 20},
      {"cut into other triangles", joined(once, plate(1, 1, 7), "again/"), false, 20},
      {"two-sided, twice, from behind", joined(once, once, "again/"), true, 160},
      {"two opposite faces, from the front", joined(once, inside_out(once), "back/"), false, 20},
      {"two opposite faces, from behind", joined(once, inside_out(once), "back/"), false, 160},
      {"opposite and cut otherwise", joined(once, inside_out(plate(1, 1, 7)), "back/"), false, 20},
      {"1 um apart, the back in front",
       joined(once, moved(inside_out(once), {1e-6, 0, 0}), "back/"), false, 20},
      {"1 um apart, facing away", joined(once, moved(inside_out(once), {-1e-6, 0, 0}), "back/"),
       false, 20},
  };
  for (const auto& v : variants) {
    ASSIGN_OR_RETURN(const auto view, look_at(v.mesh, v.two_sided, 1e5, samples, v.azimuth_deg));
    worst.see(plate_t(view, std::cos(20 * kRadPerDeg)), [&] {
      return absl::StrCat(v.name, ": ", view.row[0].projected_area_m2.value, " m2, ",
                          view.guarded_backface_hits, " of ", view.target_paths,
                          " met from behind");
    });
  }
  return worst.finding();
}

// Triangles of no area, alone and along the edges of good ones, change nothing.
absl::StatusOr<Finding> degenerate_facets(Effort) {
  Worst worst(student_t_bound(31, 2));
  Mesh mesh = plate(1, 1, 10);
  const auto before = look_at(mesh, false, 1e5, 2048);
  const auto good = static_cast<std::uint32_t>(mesh.triangle.size());
  for (std::uint32_t i = 0; i < good; ++i) {
    const auto t = mesh.triangle[i];
    mesh.triangle.push_back({t[0], t[0], t[1]});  // an edge
    mesh.triangle.push_back({t[2], t[2], t[2]});  // a point
  }
  mesh.triangle_group.resize(mesh.triangle.size(), 0);
  mesh.degenerate_triangles = count_degenerate(mesh);
  worst.require(mesh.degenerate_triangles == 2 * good, [] { return "not all are counted"; });
  const auto after = look_at(mesh, false, 1e5, 2048);
  if (!before.ok()) return before.status();
  if (!after.ok()) return after.status();
  worst.see(plate_t(*before), [] { return "without"; });
  worst.see(plate_t(*after), [] { return "with 400 of them"; });
  worst.require(after->guarded_nonfinite == 0, [] { return "not finite"; });
  return worst.finding();
}

// Facets turned the wrong way give nothing, but they are counted: every ray that they take.
absl::StatusOr<Finding> inverted_facets(Effort) {
  Worst worst(student_t_bound(31, 2));
  Mesh mesh = plate(1, 1, 10);
  for (std::size_t i = 0; i < mesh.triangle.size() / 2; ++i)
    std::swap(mesh.triangle[i][1], mesh.triangle[i][2]);
  ASSIGN_OR_RETURN(const auto view, look_at(mesh, false, 1e5, 2048));
  const double half = 0.25 * planck_band_radiance_w_m2_sr(8, 12, 300);
  worst.see(t_of(view.row[0].intensity_w_sr, half, kMaskMargin * half),
            [] { return "half the plate"; });
  const auto taken = static_cast<double>(view.guarded_backface_hits),
             all = taken + static_cast<double>(view.target_paths);
  worst.require(std::abs(taken / all - 0.5) < 0.01,
                [&] { return absl::StrCat(taken, " of ", all, " rays counted, expected half"); });
  return worst.finding();
}

// The plate's solid angle from 2 m to 100 km: rays start at the bounding sphere, in float.
absl::StatusOr<Finding> range_1e5_m(Effort effort) {
  Worst worst(student_t_bound(31, 6));
  for (const double range : {2.0, 1e2, 1e3, 1e4, 1e5, 1e6}) {
    ASSIGN_OR_RETURN(const auto view, look_at(plate(1, 1, 10), false, range,
                                              effort == Effort::kFull ? 65536 : 2048));
    // Solid angle of a rectangle seen from its axis.
    const double a = 0.5 / range;
    const double solid_angle = 4 * std::asin(a * a / (1 + a * a));
    const double expected =
        0.5 * planck_band_radiance_w_m2_sr(8, 12, 300) * solid_angle * range * range;
    worst.see(t_of(view.row[0].intensity_w_sr, expected, kMaskMargin * expected),
              [&] { return absl::StrCat("range ", range, " m"); });
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> geometry_cases() {
  const std::string kClosed =
      "a ray from inside a closed body meets it, and a hit lies on its facet to half the distance "
      "at which the next ray starts";
  return {
      {"geometry", "random_rays",
       "from inside needles, ship and sphere at 0, 1e3, 1e5, 6.4e6 m: rays lost or misplaced",
       kClosed, random_rays},
      {"geometry", "edge_rays", "the same, aimed at edges: rays lost or misplaced", kClosed,
       edge_rays},
      {"geometry", "vertex_rays", "the same, aimed at vertices: rays lost or misplaced", kClosed,
       vertex_rays},
      {"geometry", "exact_arithmetic",
       "hard meshes at 0 to 6.4e6 m, random, edges, vertices: hits and shadows lost or invented",
       "exact arithmetic on the same coordinates has no error", exact_arithmetic},
      {"geometry", "grazing_needles",
       "needles 1 : 20000 met 0.1 to 1e-4 deg from their plane: rays lost, through, or off it",
       "a closed body is met on the side from which the ray comes, to half the distance at which "
       "the next ray starts",
       grazing_needles},
      {"geometry", "text_at_earth_radius",
       "area and volume of a 0.25 m sphere read as text at 6.4e6 m, relative",
       "doubles at 6.4e6 m are 9.3e-10 m apart, against facets of 8 mm: 1.2e-7 a facet, 8 in "
       "reserve",
       text_at_earth_radius},
      {"geometry", "float_formats", "binary STL at 1e5 and 6.4e6 m: read although distorted",
       "a format that cannot hold the facets must be refused, not repaired", float_formats_refused},
      {"geometry", "self_intersection",
       "convex bodies of 1 mm to 100 km: light from the body itself, hits from behind",
       "a ray that leaves a convex body never meets it", self_intersection},
      {"geometry", "duplicates", "doubled, re-cut, opposite and nearly coincident plates [t]",
       "Student's t of 9 rows, 31 degrees of freedom: a false alarm in 1000 suites; the mask's "
       "margin of 2e-6",
       duplicates},
      {"geometry", "degenerate_facets", "a plate with 400 facets of no area [t]",
       "Student's t of 2 rows after the mask's margin", degenerate_facets},
      {"geometry", "inverted_facets",
       "half a plate turned over: intensity [t], and what is counted",
       "Student's t of 2 rows after the mask's margin; a facet met from behind is counted, never "
       "silent",
       inverted_facets},
      {"geometry", "range_1e5_m", "a plate's solid angle from 2 m to 1e6 m [t]",
       "Student's t of 6 rows after the mask's margin", range_1e5_m},
  };
}

}  // namespace irsig

#include "core/scene/generate/generate_particles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/scene/generate/settle_spheres.h"
#include "fmt/format.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostTriangles = 20'000'000;  // 3 GB in the ray tracer
constexpr double kMostLayers = 50;
constexpr std::size_t kHeightGrid = 1024;

// Numbers in [0, 1) that depend on a seed and their place alone.
class Stream {
 public:
  explicit Stream(std::uint64_t seed) : state_(mix64(seed)) {}
  double next() {
    state_ = mix64(state_);
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

// An icosahedron whose facets were divided into four, several times: unit vectors, and for each
// vertex after the first twelve the ends of the edge that it halves.
struct DividedIcosahedron {
  std::vector<Vec<Body>> direction;
  std::vector<std::array<std::uint32_t, 2>> parent;
  std::vector<std::uint32_t> level;
  std::vector<std::array<std::uint32_t, 3>> triangle;
};

DividedIcosahedron divided_icosahedron(std::uint32_t subdivisions) {
  constexpr double g = std::numbers::phi;
  DividedIcosahedron out;
  for (const Vec<Body> v : {Vec<Body>{-1, g, 0},
                            {1, g, 0},
                            {-1, -g, 0},
                            {1, -g, 0},
                            {0, -1, g},
                            {0, 1, g},
                            {0, -1, -g},
                            {0, 1, -g},
                            {g, 0, -1},
                            {g, 0, 1},
                            {-g, 0, -1},
                            {-g, 0, 1}})
    out.direction.push_back(normalized(v));
  out.triangle = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                  {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                  {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                  {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  out.parent.assign(12, {0, 0});
  out.level.assign(12, 0);
  for (std::uint32_t level = 1; level <= subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> half;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, fresh] =
          half.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(out.direction.size()));
      if (fresh) {
        out.direction.push_back(normalized(out.direction[a] + out.direction[b]));
        out.parent.push_back({a, b});
        out.level.push_back(level);
      }
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : out.triangle) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    out.triangle = std::move(finer);
  }
  return out;
}

// The vertices of one grain about its centre, turned at random, with the volume of the sphere of
// radius 1.
std::vector<Vec<Body>> grain_vertices(const DividedIcosahedron& form, const ParticleBed& bed,
                                      Stream& random) {
  const std::size_t n = form.direction.size();
  std::vector<double> radius(n, 1.0);
  if (bed.shape == GrainShape::kIrregular)
    for (std::size_t i = 0; i < n; ++i) {  // midpoint displacement: finer levels vary less
      const double base =
          form.level[i] == 0 ? 1.0 : 0.5 * (radius[form.parent[i][0]] + radius[form.parent[i][1]]);
      const double amplitude = bed.irregularity * std::pow(0.5, form.level[i]);
      radius[i] = base + amplitude * (2 * random.next() - 1);
    }
  // A uniformly random rotation, as a unit quaternion. [shoemake1992]
  const double u = random.next(), a = 2 * std::numbers::pi * random.next(),
               b = 2 * std::numbers::pi * random.next();
  const double qx = std::sqrt(1 - u) * std::sin(a), qy = std::sqrt(1 - u) * std::cos(a),
               qz = std::sqrt(u) * std::sin(b), qw = std::sqrt(u) * std::cos(b);
  const Vec<Body> q{qx, qy, qz};
  std::vector<Vec<Body>> vertex(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<Body> v = radius[i] * form.direction[i];
    const Vec<Body> t = 2.0 * cross(q, v);
    vertex[i] = v + qw * t + cross(q, t);
  }
  double six_volumes = 0;
  for (const auto& [i, j, k] : form.triangle)
    six_volumes += dot(vertex[i], cross(vertex[j], vertex[k]));
  const double scale = std::cbrt(8 * std::numbers::pi / six_volumes);
  for (Vec<Body>& v : vertex) v = scale * v;
  return vertex;
}

// The upper surface over one cell, periodic.
class HeightGrid {
 public:
  explicit HeightGrid(double cell_m) : cell_m_(cell_m), height_m_(kHeightGrid * kHeightGrid, 0.0) {}

  // A triangle with x, y relative to the cell and heights up.
  void add(const std::array<Vec<Body>, 3>& t) {
    const double step = cell_m_ / kHeightGrid;
    const double twice =
        (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
    if (twice == 0) return;
    const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto n = static_cast<long>(kHeightGrid);
    for (long i = std::lround(std::ceil(x0 / step - 0.5));
         (static_cast<double>(i) + 0.5) * step <= x1; ++i)
      for (long j = std::lround(std::ceil(y0 / step - 0.5));
           (static_cast<double>(j) + 0.5) * step <= y1; ++j) {
        const double x = (static_cast<double>(i) + 0.5) * step,
                     y = (static_cast<double>(j) + 0.5) * step;
        const auto weight = [&](const Vec<Body>& p, const Vec<Body>& q) {
          return ((p.x - x) * (q.y - y) - (p.y - y) * (q.x - x)) / twice;
        };
        const double a = weight(t[1], t[2]), b = weight(t[2], t[0]), c = weight(t[0], t[1]);
        if (a < 0 || b < 0 || c < 0) continue;
        double& at = height_m_[static_cast<std::size_t>(((i % n) + n) % n * n + ((j % n) + n) % n)];
        const double height = a * t[0].z + b * t[1].z + c * t[2].z;
        if (at == 0 && height > 0) ++covered_;
        at = std::max(at, height);
      }
  }

  [[nodiscard]] double coverage() const {
    return static_cast<double>(covered_) / static_cast<double>(height_m_.size());
  }

  void measure(ParticleReport& report) const {
    double sum = 0, squares = 0;
    for (const double h : height_m_) {
      sum += h;
      report.top_m = std::max(report.top_m, h);
    }
    const auto n = static_cast<double>(height_m_.size());
    report.mean_height_m = sum / n;
    for (const double h : height_m_)
      squares += (h - report.mean_height_m) * (h - report.mean_height_m);
    report.rms_height_m = std::sqrt(squares / n);
    report.coverage = coverage();
  }

 private:
  double cell_m_;
  std::vector<double> height_m_;
  std::size_t covered_ = 0;
};

// The vertices of the grain that is the `index`-th to be dropped, where its sphere rests; z is up.
std::vector<Vec<Body>> grain_at_rest(const DividedIcosahedron& form, const ParticleBed& bed,
                                     const SettledSphere& sphere, std::size_t index) {
  Stream shape(mix64(bed.seed ^ 0x5a17) + index);
  std::vector<Vec<Body>> vertex = grain_vertices(form, bed, shape);
  for (Vec<Body>& v : vertex)
    v = sphere.radius_m * v + Vec<Body>{sphere.x_m, sphere.y_m, sphere.z_m};
  return vertex;
}

// The part of a sphere's volume below a height.
double volume_below(const SettledSphere& s, double height_m) {
  const double h = std::clamp(height_m - (s.z_m - s.radius_m), 0.0, 2 * s.radius_m);
  return std::numbers::pi * h * h * (s.radius_m - h / 3);
}

absl::Status check(const ParticleBed& bed) {
  const auto wrong = [](const std::string& what) { return absl::InvalidArgumentError(what); };
  if (bed.size.empty()) return wrong("no grain size, expected one or more");
  double largest_m = 0, sum = 0;
  for (const GrainSize& s : bed.size) {
    if (!(s.diameter_m >= 1e-7 && s.diameter_m <= 10))
      return wrong(fmt::format("diameter_m = {}, expected 1e-7 to 10", s.diameter_m));
    if (!(s.fraction >= 0) || !std::isfinite(s.fraction))
      return wrong(fmt::format("fraction = {}, expected 0 or more", s.fraction));
    largest_m = std::max(largest_m, s.diameter_m);
    sum += s.fraction;
  }
  if (!(sum > 0)) return wrong("the fractions add up to 0");
  if (!(bed.width_m >= 4 * largest_m) || !std::isfinite(bed.width_m))
    return wrong(fmt::format("width_m = {}, expected at least 4 largest diameters, {}", bed.width_m,
                             4 * largest_m));
  if (bed.coverage > 0 && bed.layers > 0)
    return wrong("both coverage and layers are positive, expected one of them");
  if (!(bed.coverage >= 0 && bed.coverage <= 0.99))
    return wrong(fmt::format("coverage = {}, expected 0 to 0.99", bed.coverage));
  if (!(bed.layers >= 0 && bed.layers <= kMostLayers))
    return wrong(fmt::format("layers = {}, expected 0 to {}", bed.layers, kMostLayers));
  if (bed.tiles < 1) return wrong("tiles = 0, expected 1 or more");
  if (bed.subdivisions > 3)
    return wrong(fmt::format("subdivisions = {}, expected 0 to 3", bed.subdivisions));
  if (!(bed.irregularity >= 0 && bed.irregularity <= 0.4))
    return wrong(fmt::format("irregularity = {}, expected 0 to 0.4", bed.irregularity));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ParticleModel> generate_particles(const ParticleBed& bed) {
  RETURN_IF_ERROR(check(bed));
  std::vector<double> share;  // by number
  double largest_m = 0, sum = 0;
  for (const GrainSize& s : bed.size) {
    share.push_back(bed.fractions_by_mass ? s.fraction / std::pow(s.diameter_m, 3) : s.fraction);
    sum += share.back();
    largest_m = std::max(largest_m, s.diameter_m);
  }
  const std::uint64_t facets = 20ull << (2 * bed.subdivisions);
  const std::uint64_t most_grains =
      kMostTriangles / (facets * bed.tiles * static_cast<std::uint64_t>(bed.tiles));

  ParticleModel out;
  ParticleReport& report = out.report;
  report.grains_of_size.assign(bed.size.size(), 0);
  SettlingBed settling(bed.width_m, 0.5 * largest_m);
  const DividedIcosahedron form = divided_icosahedron(bed.subdivisions);
  HeightGrid surface(bed.width_m);
  Stream random(bed.seed);
  std::vector<std::uint32_t> size_of;
  double layers = 0;
  while (bed.coverage > 0 ? surface.coverage() < bed.coverage : layers < bed.layers) {
    if (report.grains >= most_grains || layers > kMostLayers)
      return absl::InvalidArgumentError(
          fmt::format("more than {} grains would be needed, expected fewer or larger grains, a "
                      "smaller bed, fewer tiles or fewer subdivisions",
                      report.grains));
    // The size that is furthest behind its share.
    std::size_t size = 0;
    double behind = -1;
    for (std::size_t i = 0; i < share.size(); ++i) {
      const double lack = share[i] / sum * static_cast<double>(report.grains + 1) -
                          static_cast<double>(report.grains_of_size[i]);
      if (share[i] > 0 && lack > behind) {
        behind = lack;
        size = i;
      }
    }
    const double x = bed.width_m * random.next(), y = bed.width_m * random.next();
    const double r = 0.5 * bed.size[size].diameter_m;
    const std::vector<Vec<Body>> vertex =
        grain_at_rest(form, bed, settling.drop(x, y, r), report.grains);
    for (const auto& [i, j, k] : form.triangle) surface.add({vertex[i], vertex[j], vertex[k]});
    layers += std::numbers::pi * r * r / (bed.width_m * bed.width_m);
    size_of.push_back(static_cast<std::uint32_t>(size));
    ++report.grains_of_size[size];
    ++report.grains;
  }

  Mesh& mesh = out.mesh;
  const double half_m = 0.5 * bed.width_m * bed.tiles;
  if (bed.plate) {
    mesh.group.emplace_back("plate");
    mesh.vertex = {
        {half_m, half_m, 0}, {half_m, -half_m, 0}, {-half_m, -half_m, 0}, {-half_m, half_m, 0}};
    mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_group = {0, 0};
  }
  const auto first_group = static_cast<std::uint32_t>(mesh.group.size());
  for (const GrainSize& s : bed.size)
    mesh.group.push_back(fmt::format("grain_{:g}um", 1e6 * s.diameter_m));

  // Sorted by size, so that each group is one run of triangles.
  const std::vector<SettledSphere>& sphere = settling.spheres();
  for (std::uint32_t size = 0; size < bed.size.size(); ++size)
    for (std::size_t g = 0; g < sphere.size(); ++g) {
      if (size_of[g] != size) continue;
      // The body frame is half a turn about x away.
      const std::vector<Vec<Body>> vertex = grain_at_rest(form, bed, sphere[g], g);
      for (std::uint32_t tx = 0; tx < bed.tiles; ++tx)
        for (std::uint32_t ty = 0; ty < bed.tiles; ++ty) {
          const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
          for (const Vec<Body>& v : vertex)
            mesh.vertex.push_back(
                {v.x + tx * bed.width_m - half_m, -(v.y + ty * bed.width_m - half_m), -v.z});
          for (const auto& [i, j, k] : form.triangle) {
            mesh.triangle.push_back({base + i, base + j, base + k});
            mesh.triangle_group.push_back(first_group + size);
          }
        }
    }
  surface.measure(report);
  report.largest_overlap = settling.largest_overlap();
  const double low = 0.25 * report.mean_height_m, high = 0.75 * report.mean_height_m;
  double solid = 0;
  for (const SettledSphere& s : sphere) solid += volume_below(s, high) - volume_below(s, low);
  if (high > low) report.packing_fraction = solid / (bed.width_m * bed.width_m * (high - low));
  return out;
}

}  // namespace irsig

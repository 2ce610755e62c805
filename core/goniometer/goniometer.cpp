#include "core/goniometer/goniometer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/problems.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/transport/path_tracer.h"
#include "core/transport/primary_rays.h"

namespace irsig {
namespace {

// The far field's sensor stands this many radii of the scene away: its rays then converge by less
// than 1e-4 rad, and the plane that they start from is still well resolved in float.
constexpr double kFarField = 2e4;

// The values of one channel are sums over the tracer's nodes.
struct ChannelWeights {
  GoniometerChannel channel;
  std::size_t first_node = 0;
  std::vector<double> weight;  // adds up to 1
};

Vec<Body> direction(double zenith_deg, double azimuth_deg) {
  const double z = zenith_deg * kRadPerDeg, a = azimuth_deg * kRadPerDeg;
  return {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)};
}

// Data that all views share.
struct Bench {
  const GoniometerSpec& spec;
  const Target& target;
  const std::vector<Material>& material;
  const std::vector<ChannelWeights>& channel;
  std::vector<SunDirection> source;
  // Weights of a source are per irradiance normal to its beam at the target's centre; divided by
  // this they are per irradiance of the reference plane.
  std::vector<double> irradiance;
  Vec<Body> middle;

  [[nodiscard]] FootprintView view(double zenith_deg, double azimuth_deg) const {
    const double range_m =
        spec.sensor_range_m > 0 ? spec.sensor_range_m : kFarField * target.radius_m;
    const double height_m =
        spec.field_height_m *
        (spec.field == FieldOfView::kOnPlate ? std::cos(zenith_deg * kRadPerDeg) : 1.0);
    return make_footprint_view(target, middle + range_m * direction(zenith_deg, azimuth_deg),
                               middle, spec.field_width_m, height_m);
  }
};

struct ViewResult {
  std::vector<Estimate> brdf_per_sr;  // [channel][source]
  std::vector<Estimate> emissivity, dhr, emissivity_plus_dhr;
  double last_reflection = 0, leaked = 0, missed_field = 0;
  PathCounts counts;
};

ViewResult measure_view(const Bench& bench, double zenith_deg, double azimuth_deg,
                        std::uint64_t seed) {
  const GoniometerSpec& spec = bench.spec;
  const FootprintView footprint = bench.view(zenith_deg, azimuth_deg);
  PathSettings settings;
  settings.max_reflections = spec.max_reflections;
  settings.seed = seed;
  settings.samples = spec.samples_per_replicate;
  settings.replicates = spec.replicates;
  settings.background = true;
  settings.always_last = true;
  SourceGeometry around;
  around.sun = bench.source;
  const PathTracer tracer(bench.target, bench.material, footprint.view, around, settings);
  ViewResult out;
  const std::vector<PathWeights> traced = tracer.trace(out.counts);

  const SourceLayout& layout = tracer.layout();
  const std::size_t parts = bench.target.part.size(), sources = bench.source.size(),
                    channels = bench.channel.size();
  const std::size_t per_channel = sources + 5;  // emissivity, dhr, their sum, leaked, last
  ReplicateStatistics statistics(channels * per_channel);
  std::vector<double> row(channels * per_channel);
  const double inverse_area = 1 / footprint.footprint_m2;
  const double inverse_replicates = 1.0 / spec.replicates;
  for (const PathWeights& w : traced) {
    const auto mean_in = [&](const SourceWeights& table, const ChannelWeights& c,
                             std::uint32_t first, SourceId id) {
      const double* node = table.find(first, id);
      if (node == nullptr) return 0.0;
      if (!tracer.spectral()) return inverse_area * *node;
      double sum = 0;
      for (std::size_t i = 0; i < c.weight.size(); ++i) sum += c.weight[i] * node[c.first_node + i];
      return inverse_area * sum;
    };
    const auto mean_of = [&](const ChannelWeights& c, std::uint32_t first, SourceId id) {
      return mean_in(w.weight, c, first, id);
    };
    std::fill(row.begin(), row.end(), 0.0);
    for (std::size_t k = 0; k < channels; ++k) {
      const ChannelWeights& c = bench.channel[k];
      double* at = row.data() + k * per_channel;
      for (std::uint32_t f = 0; f < parts; ++f) {
        for (std::uint32_t j = 0; j < sources; ++j)
          at[j] += mean_of(c, f, layout.sun(j)) / bench.irradiance[j];
        at[sources] += mean_of(c, f, layout.seen(f));
        for (std::uint32_t q = 0; q < parts; ++q) at[sources] += mean_of(c, f, layout.reflected(q));
        const double leaked = mean_of(c, f, layout.first_lower());
        at[sources + 1] += mean_of(c, f, layout.first_sky()) + leaked;
        at[sources + 3] += leaked;
        for (const SourceId id : layout.without_sun()) at[sources + 4] += mean_in(w.last, c, f, id);
      }
      at[sources + 2] = at[sources] + at[sources + 1];
    }
    statistics.add(row);
    out.missed_field += inverse_replicates * (1 - inverse_area * w.projected_area_m2);
  }
  for (std::size_t k = 0; k < channels; ++k) {
    const std::size_t at = k * per_channel;
    for (std::size_t j = 0; j < sources; ++j)
      out.brdf_per_sr.push_back(statistics.estimate(at + j));
    out.emissivity.push_back(statistics.estimate(at + sources));
    out.dhr.push_back(statistics.estimate(at + sources + 1));
    out.emissivity_plus_dhr.push_back(statistics.estimate(at + sources + 2));
    out.last_reflection =
        std::max(out.last_reflection, statistics.estimate(at + sources + 4).value);
    const double dhr = out.dhr.back().value;
    if (dhr > 0)
      out.leaked = std::max(out.leaked, statistics.estimate(at + sources + 3).value / dhr);
  }
  return out;
}

absl::Status check(const GoniometerScene& scene, const GoniometerSpec& spec) {
  const auto angles = [](const std::vector<double>& list, const char* name, double most) {
    if (list.empty())
      return absl::InvalidArgumentError(absl::StrCat(name, " is empty, expected angles"));
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!(list[i] >= 0 && list[i] <= most))
        return absl::InvalidArgumentError(
            absl::StrCat(name, "[", i, "] = ", list[i], ", expected 0 to ", most));
      if (i > 0 && !(list[i] > list[i - 1]))
        return absl::InvalidArgumentError(
            absl::StrCat(name, "[", i, "] = ", list[i], ", expected increasing angles"));
    }
    return absl::OkStatus();
  };
  for (const absl::Status& status : {angles(spec.view_zenith_deg, "view_zenith_deg", 89.9),
                                     angles(spec.view_azimuth_deg, "view_azimuth_deg", 360),
                                     angles(spec.source_zenith_deg, "source_zenith_deg", 89.9)})
    if (!status.ok()) return status;
  if (scene.band.empty()) return absl::InvalidArgumentError("band is missing, expected a band");
  if (!(spec.field_width_m > 0 && spec.field_height_m > 0))
    return absl::InvalidArgumentError("the field of view is empty");
  if (spec.samples_per_replicate < 1 || spec.replicates < 2)
    return absl::InvalidArgumentError("no samples, or fewer than two replicates");
  return absl::OkStatus();
}

// Compares the fields of view on the reference plane with the mesh's extent.
absl::Status check_border(const Bench& bench, const Mesh& mesh, GoniometerResult& result) {
  Vec<Body> low = mesh.vertex.front(), high = low;
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  result.border_m = std::numeric_limits<double>::infinity();
  const GoniometerSpec& spec = bench.spec;
  for (const double zenith_deg : spec.view_zenith_deg)
    for (const double azimuth_deg : spec.view_azimuth_deg) {
      const FootprintView footprint = bench.view(zenith_deg, azimuth_deg);
      const ViewFrame& frame = footprint.view.frame;
      const Vec<Body> sensor = frame.sensor + bench.target.centre;
      for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) {
          const Vec<Body> ray = frame.plane_m * frame.forward + (x * frame.width_m) * frame.right +
                                (y * frame.height_m) * frame.up;
          // A ray that does not come down meets the plane nowhere.
          if (!(ray.z > 0))
            return absl::InvalidArgumentError(
                absl::StrCat("the field of view reaches the horizon at view zenith ", zenith_deg,
                             " deg, expected a smaller field or smaller zeniths"));
          const Vec<Body> p = sensor + ((bench.middle.z - sensor.z) / ray.z) * ray;
          const double border = std::min({p.x - low.x, high.x - p.x, p.y - low.y, high.y - p.y});
          result.border_m = std::min(result.border_m, border);
          if (border < -1e-6 * bench.target.radius_m)
            return absl::InvalidArgumentError(
                absl::StrCat("at view zenith ", zenith_deg, " deg, azimuth ", azimuth_deg,
                             " deg the field of view reaches ", -border,
                             " m beyond the model, expected a smaller field or a larger model"));
        }
    }
  const double height_m = std::max(0.0, bench.middle.z - low.z);
  result.wanted_border_m =
      height_m *
      std::tan(kRadPerDeg * std::max(spec.view_zenith_deg.back(), spec.source_zenith_deg.back()));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GoniometerResult> run_goniometer(const GoniometerScene& scene,
                                                const GoniometerSpec& spec) {
  RETURN_IF_ERROR(check(scene, spec));
  ASSIGN_OR_RETURN(auto target, make_target(scene.mesh, scene.part, scene.isa));

  GoniometerResult out;
  out.spec = spec;
  std::vector<double> node_um;
  std::vector<ChannelWeights> channel;
  double lambda_min_um = std::numeric_limits<double>::infinity(), lambda_max_um = 0;
  for (const GoniometerBand& b : scene.band) {
    const auto grid = make_band_grid(b.band);
    if (!grid.ok())
      return problem_status(
          {{"", absl::StrCat("band[", &b - scene.band.data(), "]"),
            absl::StrCat("band \"", b.band.name, "\": ", grid.status().message())}});
    lambda_min_um = std::min(lambda_min_um, b.band.lambda_min_um);
    lambda_max_um = std::max(lambda_max_um, b.band.lambda_max_um);
    if (b.spectral) {
      for (std::size_t k = 0; k < grid->lambda_um.size(); ++k) {
        const std::size_t begin = grid->bin_first[k], end = grid->bin_first[k + 1];
        const auto weight = grid->bin_weight.begin();
        channel.push_back({{b.band.name, grid->lambda_um[k], true},
                           node_um.size() + begin,
                           {weight + static_cast<std::ptrdiff_t>(begin),
                            weight + static_cast<std::ptrdiff_t>(end)}});
      }
    } else {
      ChannelWeights c{{b.band.name, 0, false}, node_um.size(), grid->band_weight};
      double sum = 0;
      for (const double w : c.weight) sum += w;
      for (std::size_t i = 0; i < c.weight.size(); ++i) {
        c.weight[i] /= sum;
        c.channel.lambda_um += c.weight[i] * grid->node_um[i];
      }
      channel.push_back(std::move(c));
    }
    node_um.insert(node_um.end(), grid->node_um.begin(), grid->node_um.end());
  }
  for (const ChannelWeights& c : channel) out.channel.push_back(c.channel);
  std::vector<Material> material;
  for (std::size_t i = 0; i < scene.material.size(); ++i) {
    auto m = Material::prepare(scene.material[i], node_um, lambda_min_um, lambda_max_um);
    if (!m.ok()) return at_key(absl::StrCat("material[", i, "]"), m.status());
    const bool allowed = i < scene.allow_energy_gain.size() && scene.allow_energy_gain[i];
    if (m->creates_energy() && !allowed)
      return keyed_problem(
          absl::StrCat("material[", i, "].allow_energy_gain"),
          absl::StrCat("is not true, but \"", scene.material[i].name,
                       "\" emits and reflects more than it receives in these bands, expected "
                       "allow_energy_gain = true or another material"));
    out.creates_energy |= m->creates_energy();
    material.push_back(*std::move(m));
  }

  Bench bench{spec, target, material, channel, {}, {}, {0, 0, -spec.reference_height_m}};
  for (const double zenith_deg : spec.source_zenith_deg) {
    const Vec<Body> towards = direction(zenith_deg, 0);
    const double cos_zenith = std::cos(zenith_deg * kRadPerDeg);
    const double radius_rad = spec.source_angular_radius_deg * kRadPerDeg;
    if (spec.source_distance_m > 0) {
      const Vec<Body> from_centre = bench.middle + spec.source_distance_m * towards - target.centre;
      const double distance_m = length(from_centre);
      const double ratio = distance_m / spec.source_distance_m;
      bench.source.push_back({normalized(from_centre), radius_rad, distance_m});
      bench.irradiance.push_back(ratio * ratio * cos_zenith);
    } else {
      bench.source.push_back({towards, radius_rad, 0});
      bench.irradiance.push_back(cos_zenith);
    }
  }
  RETURN_IF_ERROR(check_border(bench, scene.mesh, out));

  // Each view that is different from the others is a job.
  struct Job {
    std::size_t zenith, azimuth;
  };
  std::vector<Job> job;
  for (std::size_t z = 0; z < spec.view_zenith_deg.size(); ++z)
    for (std::size_t a = 0; a < spec.view_azimuth_deg.size(); ++a)
      if (a == 0 || spec.view_zenith_deg[z] > 0) job.push_back({z, a});
  std::vector<ViewResult> measured(job.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < job.size(); i = next++)
      measured[i] = measure_view(bench, spec.view_zenith_deg[job[i].zenith],
                                 spec.view_azimuth_deg[job[i].azimuth],
                                 mix64(spec.seed ^ mix64(out.view(job[i].zenith, job[i].azimuth))));
  };
  std::vector<std::thread> pool;
  for (std::uint32_t t = 1; t < spec.threads; ++t) pool.emplace_back(work);
  work();
  for (std::thread& t : pool) t.join();

  const std::size_t sources = spec.source_zenith_deg.size(), views = out.views();
  out.brdf_per_sr.resize(channel.size() * sources * views);
  for (auto* v : {&out.emissivity, &out.dhr, &out.emissivity_plus_dhr})
    v->resize(channel.size() * views);
  for (std::size_t i = 0; i < job.size(); ++i) {
    const ViewResult& m = measured[i];
    const bool zenith_view = spec.view_zenith_deg[job[i].zenith] == 0;
    const std::size_t last = zenith_view ? spec.view_azimuth_deg.size() : job[i].azimuth + 1;
    for (std::size_t a = job[i].azimuth; a < last; ++a) {
      const std::size_t view = out.view(job[i].zenith, a);
      for (std::size_t k = 0; k < channel.size(); ++k) {
        for (std::size_t j = 0; j < sources; ++j)
          out.brdf_per_sr[(k * sources + j) * views + view] = m.brdf_per_sr[k * sources + j];
        out.emissivity[k * views + view] = m.emissivity[k];
        out.dhr[k * views + view] = m.dhr[k];
        out.emissivity_plus_dhr[k * views + view] = m.emissivity_plus_dhr[k];
      }
    }
    out.last_reflection = std::max(out.last_reflection, m.last_reflection);
    out.leaked = std::max(out.leaked, m.leaked);
    out.missed_field = std::max(out.missed_field, m.missed_field);
    out.rays += m.counts.rays;
    out.guarded +=
        m.counts.guarded_backface_hits + m.counts.guarded_nonfinite + m.counts.guarded_negative;
  }
  return out;
}

}  // namespace irsig

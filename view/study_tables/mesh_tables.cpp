#include "view/study_tables/mesh_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>

#include "core/accuracy/cost_model.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "view/base/table.h"

namespace irsig {
namespace {

// Less than sums over facets are exact to is nothing.
std::string mesh_percent(double fraction) {
  return fmt::format("{:.2g} %", std::abs(fraction) < 1e-12 ? 0 : 100 * fraction);
}
std::string mesh_seconds(double s) {
  return s < 0.1 ? fmt::format("{:.3g} ms", 1e3 * s) : fmt::format("{:.3g} s", s);
}

// Something of a view, for each mesh.
struct MeshQuantity {
  std::string name;
  std::function<MeshValue(const MeshView&)> of;
};

class Tables {
 public:
  explicit Tables(const MeshComparison& comparison) : c_(comparison) {
    quantity_.push_back({"projected area", [](const MeshView& v) { return v.projected_area_m2; }});
    for (std::size_t band = 0; band < c_.band.size(); ++band)
      quantity_.push_back({c_.band[band] + " intensity",
                           [band](const MeshView& v) { return v.intensity_w_sr[band]; }});
  }

  [[nodiscard]] std::string text() const {
    std::vector<PageTable> tables{meshes(), deviations()};
    if (c_.mesh.size() >= 3) tables.push_back(limits());
    return fmt::format("### {}, {} ({}), {} meshes, {} viewpoint{}\n\n{}", c_.sweep, c_.season,
                       c_.time_utc, c_.mesh.size(), c_.viewpoint.size(),
                       c_.viewpoint.size() == 1 ? "" : "s", markdown_tables(tables));
  }

 private:
  // Returns the views in which every mesh has a value above 0.
  [[nodiscard]] std::vector<std::size_t> views_of(const MeshQuantity& quantity) const {
    std::vector<std::size_t> out;
    for (std::size_t view = 0; view < c_.viewpoint.size(); ++view)
      if (std::all_of(c_.mesh.begin(), c_.mesh.end(), [&](const MeasuredMesh& mesh) {
            return quantity.of(mesh.view[view]).value > 0;
          }))
        out.push_back(view);
    return out;
  }

  [[nodiscard]] PageTable meshes() const {
    PageTable t{
        "Means over the views with their numerical errors; CPU time once for all views "
        "(scene, materials, air) and, median, of a view with its pilots, air, sky and sea",
        {"mesh", "facets", "surface area [m2]"},
        {}};
    for (const MeshQuantity& q : quantity_)
      t.header.push_back(q.name + (&q == &quantity_.front() ? " [m2]" : " [W/sr]"));
    t.header.insert(t.header.end(), {"rays of a view", "time, once", "time, a view"});
    for (const MeasuredMesh& mesh : c_.mesh) {
      std::vector<std::string> cells{mesh.name, fmt::format("{}", mesh.facets),
                                     fmt::format("{:.8g}", mesh.surface_area_m2)};
      const auto views = static_cast<double>(mesh.view.size());
      for (const MeshQuantity& q : quantity_) {
        double value = 0, square = 0;
        for (const MeshView& v : mesh.view) {
          value += q.of(v).value / views;
          square += q.of(v).error * q.of(v).error;
        }
        cells.push_back(fmt::format("{:.7g} ({:.2g})", value, std::sqrt(square) / views));
      }
      std::vector<double> samples, cpu_s;
      for (const MeshView& v : mesh.view) {
        samples.push_back(v.samples);
        cpu_s.push_back(v.cpu_s);
      }
      cells.insert(cells.end(),
                   {fmt::format("{:.2g}", quantile(samples, 0.5)), mesh_seconds(mesh.setup_cpu_s),
                    mesh_seconds(quantile(cpu_s, 0.5))});
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable deviations() const {
    const MeasuredMesh& finest = c_.mesh.back();
    PageTable t{fmt::format("Deviation from the finest mesh ({}), over the views. Error: of both "
                            "meshes together, as if no part of it were common to them; what is "
                            "nothing but errors has deviation / error = 1 (rms)",
                            finest.name),
                {"quantity", "mesh", "rms", "rms of the errors", "deviation / error, rms",
                 "more than errors", "largest", "of its error", "its aspect [deg]"},
                {}};
    for (std::size_t i = 0; i + 1 < c_.mesh.size(); ++i) {
      const double d =
          deviation({c_.mesh[i].surface_area_m2, 0}, {finest.surface_area_m2, 0}).value;
      t.row.push_back({"surface area", c_.mesh[i].name, mesh_percent(std::abs(d)), "exact", "-",
                       "-", mesh_percent(d), "-", "-"});
    }
    for (const MeshQuantity& q : quantity_) {
      const std::vector<std::size_t> views = views_of(q);
      for (std::size_t i = 0; i + 1 < c_.mesh.size() && !views.empty(); ++i) {
        std::vector<MeshDeviation> d;
        for (const std::size_t view : views)
          d.push_back(deviation(q.of(c_.mesh[i].view[view]), q.of(finest.view[view])));
        const DeviationSummary s = summary_of(d);
        const Viewpoint& where = c_.viewpoint[views[s.largest]];
        t.row.push_back(
            {q.name, c_.mesh[i].name, mesh_percent(s.rms), mesh_percent(s.rms_error),
             fmt::format("{:.2f}", s.rms_significance), s.significant ? "yes" : "no",
             mesh_percent(d[s.largest].value), fmt::format("{:.2f}", d[s.largest].significance()),
             fmt::format("{:.4g}, {:.4g}", where.aspect_azimuth_deg, where.aspect_elevation_deg)});
      }
    }
    return t;
  }

  [[nodiscard]] PageTable limits() const {
    PageTable t{
        "The limit of ever more facets N: limit + factor x N^-order, one order for all "
        "views; what each mesh is off by that, rms over the views",
        {"quantity", "order", "chi-square / degrees of freedom"},
        {}};
    for (const MeasuredMesh& mesh : c_.mesh) t.header.push_back(mesh.name);
    t.header.push_back("error of the limit");
    std::vector<MeshValue> surface;
    for (const MeasuredMesh& mesh : c_.mesh) surface.push_back({mesh.surface_area_m2, 0});
    t.row.push_back(limit_row("surface area", {surface}));
    for (const MeshQuantity& q : quantity_) {
      std::vector<std::vector<MeshValue>> values;
      for (const std::size_t view : views_of(q)) {
        std::vector<MeshValue>& of_view = values.emplace_back();
        for (const MeasuredMesh& mesh : c_.mesh) of_view.push_back(q.of(mesh.view[view]));
      }
      if (!values.empty()) t.row.push_back(limit_row(q.name, values));
    }
    return t;
  }

  [[nodiscard]] std::vector<std::string> limit_row(
      const std::string& name, const std::vector<std::vector<MeshValue>>& values) const {
    std::vector<std::string> cells{name};
    const auto nothing = [&](const char* why, const std::string& chi_square) {
      cells.insert(cells.end(), {why, chi_square});
      cells.insert(cells.end(), c_.mesh.size() + 1, "-");
      return cells;
    };
    if (!varies(values)) return nothing("no change beyond errors", "-");
    std::vector<double> facets;
    for (const MeasuredMesh& mesh : c_.mesh) facets.push_back(static_cast<double>(mesh.facets));
    const std::optional<MeshLimit> limit = mesh_limit(facets, values);
    if (!limit) return nothing("irregular", "-");
    const bool exact = values.front().front().error == 0;
    const std::size_t degrees = limit->degrees_of_freedom;
    const std::string chi_square =
        exact || degrees == 0
            ? "-"
            : fmt::format("{:.2g}", limit->chi_square / static_cast<double>(degrees));
    if (!exact && beyond_errors(limit->chi_square, std::max<std::size_t>(degrees, 1)))
      return nothing("irregular", chi_square);
    // Three exact values always have an order, and nothing to tell its error by.
    const bool solved = exact && degrees == 0;
    cells.push_back(solved
                        ? fmt::format("{:.2g}", limit->order)
                        : fmt::format("{:.2g} ({:.2g} to {}{:.2g})", limit->order, limit->order_low,
                                      limit->order_high_open ? "over " : "", limit->order_high));
    cells.push_back(chi_square);
    double error = 0;
    for (const MeshValue& v : limit->limit)
      error += std::pow(v.error / v.value, 2) / static_cast<double>(values.size());
    error = std::sqrt(error);
    // How little is left is not known better than the limit.
    for (const double n : facets)
      cells.push_back(solved || limit->rms_off(n) > error ? mesh_percent(limit->rms_off(n))
                                                          : "< " + mesh_percent(error));
    cells.push_back(solved ? "-" : mesh_percent(error));
    return cells;
  }

  const MeshComparison& c_;
  std::vector<MeshQuantity> quantity_;
};

}  // namespace

std::string mesh_tables(const MeshComparison& comparison) { return Tables(comparison).text(); }

absl::StatusOr<std::string> mesh_csv(const MeshComparison& comparison) {
  std::ostringstream out;
  auto table = make_table_writer("csv",
                                 {{"mesh"},
                                  {"triangles_asked"},
                                  {"facets"},
                                  {"surface_area_m2"},
                                  {"season"},
                                  {"time_utc"},
                                  {"band"},
                                  {"aspect_azimuth_deg"},
                                  {"aspect_elevation_deg"},
                                  {"range_m"},
                                  {"intensity_w_sr"},
                                  {"numerical_error_w_sr"},
                                  {"intensity_deviation"},
                                  {"intensity_deviation_error"},
                                  {"projected_area_m2"},
                                  {"projected_area_stderr_m2"},
                                  {"projected_area_deviation"},
                                  {"projected_area_deviation_error"},
                                  {"samples"},
                                  {"cpu_s"},
                                  {"setup_cpu_s"}},
                                 out);
  if (!table.ok()) return table.status();
  const MeasuredMesh& finest = comparison.mesh.back();
  // A value that is 0 for the finest mesh has no relative deviation.
  const auto append = [](const MeshValue& value, const MeshValue& reference,
                         std::vector<Cell>& cells) {
    cells.insert(cells.end(), {Cell(value.value), Cell(value.error)});
    if (reference.value == 0) {
      cells.insert(cells.end(), 2, Cell());
      return;
    }
    const MeshDeviation d = deviation(value, reference);
    cells.insert(cells.end(), {Cell(d.value), Cell(d.error)});
  };
  for (const MeasuredMesh& mesh : comparison.mesh)
    for (std::size_t view = 0; view < comparison.viewpoint.size(); ++view)
      for (std::size_t band = 0; band < comparison.band.size(); ++band) {
        const Viewpoint& where = comparison.viewpoint[view];
        const MeshView &here = mesh.view[view], &there = finest.view[view];
        std::vector<Cell> cells{mesh.name,
                                mesh.asked_triangles > 0 ? Cell(mesh.asked_triangles) : Cell(),
                                mesh.facets,
                                mesh.surface_area_m2,
                                comparison.season,
                                comparison.time_utc,
                                comparison.band[band],
                                where.aspect_azimuth_deg,
                                where.aspect_elevation_deg,
                                where.range_m};
        append(here.intensity_w_sr[band], there.intensity_w_sr[band], cells);
        append(here.projected_area_m2, there.projected_area_m2, cells);
        cells.insert(cells.end(), {Cell(here.samples), Cell(here.cpu_s), Cell(mesh.setup_cpu_s)});
        (*table)->row(cells);
      }
  RETURN_IF_ERROR((*table)->finish());
  return out.str();
}

}  // namespace irsig

#include "view/study_tables/accuracy_tables.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "fmt/format.h"

namespace irsig {
namespace {

std::string number(double value) { return fmt::format("{:.2g}", value); }
std::string seconds(double s) {
  return s < 0.1 ? fmt::format("{:.3g} ms", 1e3 * s) : fmt::format("{:.3g} s", s);
}
std::string percent(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

std::string time_cell(const std::optional<WorkToTarget>& work) {
  if (!work) return "never";
  return (work->extrapolated ? "~" : "") + seconds(work->work);
}
std::string ratio_cell(const std::optional<WorkToTarget>& plain,
                       const std::optional<WorkToTarget>& ours, double plain_setup_s,
                       double our_setup_s) {
  if (!plain || !ours) return "-";
  return fmt::format("{}{:.3g}", plain->extrapolated || ours->extrapolated ? "~" : "",
                     (plain->work + plain_setup_s) / (ours->work + our_setup_s));
}

constexpr double kOnePercent = 0.01, kOnePerMille = 0.001;

class Presentation {
 public:
  explicit Presentation(const RowMeasurements& measured) : m_(measured) {}

  [[nodiscard]] StudiedRow row() const {
    StudiedRow out;
    out.season = m_.season;
    out.time_utc = m_.time_utc;
    out.band = m_.band;
    out.aspect_azimuth_deg = m_.viewpoint.aspect_azimuth_deg;
    out.aspect_elevation_deg = m_.viewpoint.aspect_elevation_deg;
    out.range_m = m_.viewpoint.range_m;
    const RowValue& v = m_.reference.value;
    out.paragraph.push_back(fmt::format(
        "Reference: {:.7g} W/sr in the band, relative standard error {:.2g}; emitted {:.7g} W/sr, "
        "projected "
        "area {:.7g} m2 ({:.2g}). Up to {} reflections.",
        v.intensity_w_sr, m_.reference.relative_stderr[0], v.emitted_w_sr, v.projected_area_m2,
        m_.reference.relative_stderr[static_cast<std::size_t>(StudiedQuantity::kArea)],
        m_.max_reflections));
    WorkPanel in_band =
        panel("In-band intensity", {"methods", "precomputation"}, StudiedQuantity::kIntensity);
    out.panel = {
        std::move(in_band),
        panel("Stored spectrum (rms over wavelengths)", {"methods"}, StudiedQuantity::kSpectrum),
        convergence(),
        panel("Number of reflections (in-band)", {"reflections"}, StudiedQuantity::kIntensity),
        panel("Sharing paths; ray tracing (in-band)", {"sharing", "tracing"},
              StudiedQuantity::kIntensity),
        effects_panel(),
        asked_panel(),
        step_panel()};
    out.table = {targets(), equal_times(), effects_table(), slopes(), others(), step_table()};
    for (const WorkMeasurement& m : m_.work)
      for (const WorkPoint& p : m.point)
        absl::StrAppend(
            &out.csv,
            fmt::format("{},{},{},{:.10g},{:.10g},{:.10g},{},\"{}\",{},{:.10g},{:.6g},{},{:.6g},"
                        "{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
                        out.season, out.time_utc, out.band, out.aspect_azimuth_deg,
                        out.aspect_elevation_deg, out.range_m, m.group, m.name,
                        p.samples_per_replicate, p.samples, p.cpu_s, p.seeds, p.relative_error[0],
                        p.relative_error[1], p.relative_error[2], p.relative_error[3],
                        p.asked_relative_error, p.relative_numerical_error));
    return out;
  }

 private:
  [[nodiscard]] double floor(StudiedQuantity what) const {
    return 3 * m_.reference.relative_stderr[static_cast<std::size_t>(what)];
  }
  [[nodiscard]] const WorkMeasurement& of(const std::string& name) const {
    return *std::find_if(m_.work.begin(), m_.work.end(),
                         [&](const WorkMeasurement& m) { return m.name == name; });
  }
  [[nodiscard]] std::optional<WorkToTarget> time_to(const WorkMeasurement& m, StudiedQuantity what,
                                                    double target) const {
    return work_to_target(against_time(m.point, what), target, floor(what));
  }

  [[nodiscard]] WorkPanel panel(const std::string& title, const std::vector<std::string>& groups,
                                StudiedQuantity what) const {
    WorkPanel out{title,
                  "CPU time [s]",
                  "relative error (rms over seeds)",
                  {},
                  0,
                  {kOnePercent, kOnePerMille}};
    out.reference_error = m_.reference.relative_stderr[static_cast<std::size_t>(what)];
    for (const std::string& group : groups)
      for (const WorkMeasurement& m : m_.work) {
        if (m.group != group) continue;
        WorkSeries s{m.name, {}, {}, true};
        for (const WorkError& p : against_time(m.point, what)) {
          s.x.push_back(p.work);
          s.y.push_back(p.error);
        }
        out.series.push_back(std::move(s));
      }
    return out;
  }

  [[nodiscard]] WorkPanel effects_panel() const {
    WorkPanel out = panel("Whole runs: pilots, air, sky and sea included", {"effects"},
                          StudiedQuantity::kIntensity);
    WorkPanel traced = panel("", {"methods"}, StudiedQuantity::kIntensity);
    for (WorkSeries& s : traced.series)
      if (s.name == kQuasi) {
        s.name = "tracing and shading alone";
        out.series.push_back(std::move(s));
      }
    return out;
  }

  // Returns the panel of requested, stated and true errors.
  [[nodiscard]] WorkPanel asked_panel() const {
    WorkPanel out{"Asked, stated and true errors (in-band)",
                  "relative error asked",
                  "relative error (rms over seeds)",
                  {},
                  0,
                  {kOnePercent, kOnePerMille}};
    out.reference_error =
        m_.reference.relative_stderr[static_cast<std::size_t>(StudiedQuantity::kIntensity)];
    WorkSeries asked{"asked", {}, {}, true};
    for (const WorkMeasurement& m : m_.work) {
      if (m.group != "effects") continue;
      const std::string which = m.name == kAutomatic ? "automatic" : "all effects";
      WorkSeries stated{which + ": stated", {}, {}, true}, found{which + ": true", {}, {}, true};
      for (const WorkPoint& p : m.point) {
        if (m.name == kAutomatic) {
          asked.x.push_back(p.asked_relative_error);
          asked.y.push_back(p.asked_relative_error);
        }
        stated.x.push_back(p.asked_relative_error);
        stated.y.push_back(p.relative_numerical_error);
        found.x.push_back(p.asked_relative_error);
        found.y.push_back(p.relative_error[static_cast<std::size_t>(StudiedQuantity::kIntensity)]);
      }
      out.series.push_back(std::move(found));
      out.series.push_back(std::move(stated));
    }
    out.series.push_back(std::move(asked));
    return out;
  }

  [[nodiscard]] WorkPanel convergence() const {
    WorkPanel out{"Convergence: error against primary rays",
                  "primary rays, all replicates",
                  "relative error (rms over seeds)",
                  {},
                  0,
                  {kOnePerMille}};
    out.reference_error =
        m_.reference.relative_stderr[static_cast<std::size_t>(StudiedQuantity::kArea)];
    for (const char* name : {kPseudo, kUnmasked, kQuasi})
      for (const auto& [what, of_what] : {std::pair{StudiedQuantity::kArea, "projected area"},
                                          std::pair{StudiedQuantity::kEmitted, "emission"}}) {
        WorkSeries s{fmt::format("{}: {}",
                                 name == kQuasi      ? "quasi"
                                 : name == kUnmasked ? "quasi, no masks"
                                                     : "pseudo",
                                 of_what),
                     {},
                     {},
                     true};
        for (const WorkError& p : against_samples(of(name).point, what)) {
          s.x.push_back(p.work);
          s.y.push_back(p.error);
        }
        out.series.push_back(std::move(s));
      }
    return out;
  }

  [[nodiscard]] WorkPanel step_panel() const {
    WorkPanel out{"Spectral step: error of the quadrature alone",
                  "step [um]",
                  "relative error",
                  {},
                  0,
                  {kOnePercent, kOnePerMille}};
    out.series = {{"ours (Gauss nodes in each bin)", {}, {}, true},
                  {"trapezoid over stored values", {}, {}, true},
                  {"rectangles, both ends (the paper's)", {}, {}, true}};
    for (const StepMeasurement& s : m_.step) {
      const double errors[] = {s.ours, s.trapezoid, s.rectangles};
      for (std::size_t k = 0; k < 3; ++k) {
        out.series[k].x.push_back(s.step_um);
        out.series[k].y.push_back(errors[k]);
      }
    }
    return out;
  }

  [[nodiscard]] PageTable targets() const {
    PageTable t{
        "CPU time to a target (\"~\": extrapolated along the fitted line). Ratio: plain / this; "
        "with set-up: " +
            seconds(m_.scene_cpu_s) + " once a sweep (scene, materials, air) and " +
            seconds(m_.view_cpu_s) +
            " for each view (its air, sky and sea, all conditions), added to both; whole runs "
            "have the "
            "latter in them, and pilots.",
        {"method", "in-band 1 %", "ratio", "with set-up", "in-band 0.1 %", "ratio", "with set-up",
         "spectrum 1 %", "ratio", "spectrum 0.1 %", "ratio"},
        {}};
    const double setup_s = m_.scene_cpu_s + m_.view_cpu_s;
    for (const WorkMeasurement& m : m_.work) {
      const bool whole = m.group == "effects";
      if (m.group != "methods" && !whole) continue;
      std::vector<std::string> cells{m.name};
      for (const StudiedQuantity what : {StudiedQuantity::kIntensity, StudiedQuantity::kSpectrum})
        for (const double target : {kOnePercent, kOnePerMille}) {
          const auto plain = time_to(of(kPlain), what, target), here = time_to(m, what, target);
          cells.push_back(time_cell(here));
          cells.push_back(whole ? "-" : ratio_cell(plain, here, 0, 0));
          if (what == StudiedQuantity::kIntensity)
            cells.push_back(ratio_cell(plain, here, setup_s, whole ? m_.scene_cpu_s : setup_s));
        }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable equal_times() const {
    PageTable t{"Error after equal CPU times (in-band / stored spectrum; \"-\": outside the curve)",
                {"method"},
                {}};
    constexpr double kTimes_s[] = {0.003, 0.01, 0.03, 0.1, 0.3};
    for (const double s : kTimes_s) t.header.push_back(seconds(s));
    for (const WorkMeasurement& m : m_.work) {
      if (m.point.size() < 2 || m.group == "sharing") continue;
      std::vector<std::string> cells{m.name};
      for (const double s : kTimes_s) {
        const auto in_band = error_at_work(against_time(m.point, StudiedQuantity::kIntensity), s),
                   spectrum = error_at_work(against_time(m.point, StudiedQuantity::kSpectrum), s);
        cells.push_back((in_band ? percent(*in_band) : "-") + " / " +
                        (spectrum ? percent(*spectrum) : "-"));
      }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  // The points of both curves have the same asked errors as far as both go.
  [[nodiscard]] PageTable effects_table() const {
    PageTable t{
        "Effects chosen by the program and all effects: this row by itself from its request to its "
        "stored errors, CPU time of pilots, air, sky and sea included (in-band; stated: numerical "
        "error)",
        {"asked", "automatic: true error", "stated", "time", "all effects: true error", "stated",
         "time", "time, automatic / all", "left out"},
        {}};
    const std::vector<WorkPoint>&automatic = of(kAutomatic).point, &all = of(kAllEffects).point;
    for (std::size_t i = 0; i < automatic.size(); ++i) {
      const WorkPoint& a = automatic[i];
      const auto error = [](const WorkPoint& p) {
        return percent(p.relative_error[static_cast<std::size_t>(StudiedQuantity::kIntensity)]);
      };
      std::vector<std::string> cells{percent(a.asked_relative_error), error(a),
                                     percent(a.relative_numerical_error), seconds(a.cpu_s)};
      if (i < all.size()) {
        const WorkPoint& b = all[i];
        cells.insert(cells.end(), {error(b), percent(b.relative_numerical_error), seconds(b.cpu_s),
                                   fmt::format("{:.2f}", a.cpu_s / b.cpu_s)});
      } else {
        cells.insert(cells.end(), 4, "-");
      }
      const auto left_out =
          std::find_if(m_.left_out.begin(), m_.left_out.end(), [&](const LeftOutEffects& l) {
            return l.asked_relative_error == a.asked_relative_error;
          });
      const bool nothing = left_out == m_.left_out.end() || left_out->effects.empty();
      cells.push_back(nothing ? "nothing" : left_out->effects);
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable slopes() const {
    PageTable t{
        "Slope of the random error against the samples of a replicate (from the replicates' "
        "spread; plain: "
        "rms over seeds), and the primary rays, all replicates included, to 0.1 %",
        {"method", "projected area", "emission", "intensity", "rays to 0.1 % of area",
         "of emission", "of intensity"},
        {}};
    for (const WorkMeasurement& m : m_.work) {
      if (m.group != "methods") continue;
      std::vector<std::string> cells{m.name};
      const StudiedQuantity all[] = {StudiedQuantity::kArea, StudiedQuantity::kEmitted,
                                     StudiedQuantity::kIntensity};
      for (const StudiedQuantity what : all) {
        const auto slope = error_slope(against_main_samples(m.point, what), floor(what));
        cells.push_back(slope ? fmt::format("{:.2f}", *slope) : "-");
      }
      for (const StudiedQuantity what : all) {
        const auto rays = work_to_target(against_samples(m.point, what), kOnePerMille, floor(what));
        cells.push_back(rays ? (rays->extrapolated ? "~" : "") + number(rays->work) : "never");
      }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable others() const {
    PageTable t{"Reflections, sharing and ray tracing: in-band intensity",
                {"method", "least error reached", "after", "time to 1 %", "time to 0.1 %"},
                {}};
    for (const WorkMeasurement& m : m_.work) {
      if (m.group == "methods" || m.group == "effects") continue;
      const WorkPoint& end = m.point.back();
      t.row.push_back(
          {m.name,
           percent(end.relative_error[static_cast<std::size_t>(StudiedQuantity::kIntensity)]),
           seconds(end.cpu_s), time_cell(time_to(m, StudiedQuantity::kIntensity, kOnePercent)),
           time_cell(time_to(m, StudiedQuantity::kIntensity, kOnePerMille))});
    }
    return t;
  }

  [[nodiscard]] PageTable step_table() const {
    PageTable t{
        "Spectral step: relative error of the in-band integral on the same paths, against a step "
        "of 0.0125 um",
        {"step [um]", "ours", "trapezoid", "rectangles, both ends", "CPU time"},
        {}};
    for (const StepMeasurement& s : m_.step)
      t.row.push_back({number(s.step_um), number(s.ours), number(s.trapezoid), number(s.rectangles),
                       seconds(s.cpu_s)});
    return t;
  }

  const RowMeasurements& m_;
};

}  // namespace

StudiedRow present(const RowMeasurements& measured) { return Presentation(measured).row(); }

std::string accuracy_csv_header() {
  return "season,time_utc,band,aspect_azimuth_deg,aspect_elevation_deg,range_m,group,method,"
         "samples_per_replicate,samples,cpu_s,seeds,relative_error_intensity,relative_error_"
         "spectrum,"
         "relative_error_emitted,relative_error_projected_area,relative_error_asked,"
         "relative_numerical_error\n";
}

std::string stated_errors_table(std::span<const StatedRow> rows) {
  constexpr const char* kStatedName[kStated] = {"intensity_w_sr", "apparent_intensity_w_sr",
                                                "contrast_intensity_w_sr", "projected_area_m2",
                                                "spectral_intensity_w_sr_um"};
  std::string out =
      "|stored - longer run| / stored standard error (true errors: 0.67, 2.0), and / numerical "
      "error\n"
      "| value | values | median | 95th percentile | largest | beyond 2 numerical errors | beyond "
      "5 | largest |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t q = 0; q < kStated; ++q) {
    const StatedErrorSummary s = summary_of(rows, static_cast<Stated>(q));
    out += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | ", kStatedName[q], s.values,
                       s.median, s.percentile_95, s.largest);
    if (s.with_numerical_error == 0) {
      out += "- | - | - |\n";
      continue;
    }
    const auto share = [&](std::size_t n) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(s.with_numerical_error);
    };
    out += fmt::format("{} ({:.2g} %) | {} ({:.2g} %) | {:.2f} |\n", s.beyond_2, share(s.beyond_2),
                       s.beyond_5, share(s.beyond_5), s.largest_of_numerical_error);
  }
  return out;
}

}  // namespace irsig

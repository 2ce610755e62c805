#include "core/goniometer/goniometer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "cli/commands.h"
#include "core/base/printable.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/goniometer/coverage_trend.h"
#include "core/goniometer/goniometer_tables.h"
#include "core/scene/generate/generate_particles.h"
#include "core/scene/import/model_file.h"
#include "fmt/format.h"
#include "jobs/files/material_files.h"
#include "jobs/goniometer_file.h"
#include "jobs/keys/expand.h"
#include "messages/scene/goniometer_from_message.h"
#include "runner/job_runner.h"
#include "runner/spec_to_request.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/plot/plot_curves.h"
#include "view/plot/plot_hemisphere.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

std::string channel_name(const GoniometerChannel& c) {
  return c.spectral ? fmt::format("{} {:.4g} um", c.band, c.lambda_um) : c.band;
}

// Reflectance factors in the source's plane and across it, a curve for each channel.
std::string plane_curves(const GoniometerResult& r, std::size_t source, const std::string& title) {
  const GoniometerSpec& s = r.spec;
  const auto azimuth = [&](double wanted) {
    std::optional<std::size_t> found;
    for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a)
      if (std::abs(s.view_azimuth_deg[a] - wanted) < 1e-6) found = a;
    return found;
  };
  std::vector<CurvePanel> panels;
  for (const double side : {0.0, 90.0}) {
    const auto low = azimuth(side), high = azimuth(side + 180);
    if (!low || !high) continue;
    CurvePanel panel;
    panel.title = side == 0 ? "The source's plane" : "Across it";
    panel.x_label = side == 0 ? "View zenith [deg], below 0 on the source's side"
                              : "View zenith [deg], below 0 at azimuth 90 deg";
    panel.y_label = "Reflectance factor";
    for (std::size_t ch = 0; ch < r.channel.size(); ++ch) {
      Curve curve{channel_name(r.channel[ch]), {}, {}};
      const auto add = [&](double x, const Estimate& e) {
        curve.x.push_back(x);
        curve.y.push_back(std::numbers::pi * e.value);
        panel.y_high = std::max(panel.y_high, 1.05 * curve.y.back());
      };
      for (std::size_t z = s.view_zenith_deg.size(); z-- > 0;)
        if (s.view_zenith_deg[z] > 0) add(-s.view_zenith_deg[z], r.brdf(ch, source, z, *low));
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z)
        add(s.view_zenith_deg[z], r.brdf(ch, source, z, *high));
      panel.curve.push_back(std::move(curve));
    }
    panels.push_back(std::move(panel));
  }
  double common = 0;
  for (const CurvePanel& panel : panels) common = std::max(common, panel.y_high);
  for (CurvePanel& panel : panels) panel.y_high = common;
  return plot_curves(title, fmt::format("source zenith {:g}\u00b0", s.source_zenith_deg[source]),
                     panels, 2);
}

// The mean of a band's channels: a spectral band has one picture, too.
HemisphereValues band_values(const GoniometerResult& r, const std::string& band,
                             std::size_t source) {
  HemisphereValues out{r.spec.view_zenith_deg, r.spec.view_azimuth_deg, {}};
  out.value.assign(r.views(), 0.0);
  double channels = 0;
  for (const GoniometerChannel& c : r.channel) channels += c.band == band ? 1 : 0;
  for (std::size_t ch = 0; ch < r.channel.size(); ++ch) {
    if (r.channel[ch].band != band) continue;
    for (std::size_t z = 0; z < out.zenith_deg.size(); ++z)
      for (std::size_t a = 0; a < out.azimuth_deg.size(); ++a)
        out.value[r.view(z, a)] += std::numbers::pi * r.brdf(ch, source, z, a).value / channels;
  }
  return out;
}

// A name of the user's as a part of a file name.
std::string file_part(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_') c = '_';
  return name;
}

class GoniometerCommand {
 public:
  std::string spec_path, out;
  std::uint32_t threads = 0;

  [[nodiscard]] absl::Status run() {
    const auto text = read_user_file(spec_path, kMostSpecBytes);
    if (!text.ok())
      return absl::InvalidArgumentError(absl::StrCat(spec_path, ": ", text.status().message()));
    ASSIGN_OR_RETURN(auto file, parse_goniometer(*text, spec_path));
    const auto read_table = [&](const std::string& name) {
      return read_file_beside(spec_path, name, kMostTableBytes);
    };
    RETURN_IF_ERROR(read_material_files(file.scene, read_table));
    std::string model_bytes;
    if (file.spec.model().has_file()) {
      auto bytes = read_model_beside(spec_path, file.spec.model().file(), kMostModelBytes);
      if (!bytes.ok())
        return placed_problem(file.scene.location("model.file"),
                              absl::StrCat("model.file \"", one_line(file.spec.model().file()),
                                           "\": ", bytes.status().message()));
      model_bytes = *std::move(bytes);
    }
    ASSIGN_OR_RETURN(auto resolved, resolve_goniometer(file, model_bytes));
    spec_ = resolved.spec;
    provenance_ = {
        absl::StrCat("irsig goniometer, build ", build_id(), ", physics version ",
                     physics_version()),
        absl::StrCat("spec ", fs::path(spec_path).filename().string(), ", sha256 ",
                     sha256_hex(*text)),
        absl::StrCat("name ", spec_.name(), ", seed ", spec_.seed(), ", ",
                     spec_.accuracy().replicates(), " replicates of ",
                     spec_.accuracy().samples_per_replicate(), " samples a view"),
        "angles: zeniths from the plate's normal; azimuth 0 on the source's side, 180 on the "
        "mirror's"};

    auto scene = scene_from_sweep(resolved.scene, model_alone(resolved.scene, model_bytes), {});
    if (!scene.ok()) return located(file.scene, scene.status());
    GoniometerScene under;
    under.mesh = std::move(scene->mesh);
    under.part = std::move(scene->part);
    under.material = std::move(scene->material);
    for (const schema::Material& m : resolved.scene.sweep().material())
      under.allow_energy_gain.push_back(m.allow_energy_gain());
    for (int i = 0; i < spec_.band_size(); ++i)
      under.band.push_back({scene->band[static_cast<std::size_t>(i)], spec_.band(i).spectral()});

    std::error_code error;
    fs::create_directories(out, error);
    if (error)
      return absl::InvalidArgumentError(absl::StrCat("--out ", out, ": ", error.message()));
    if (!spec_.has_particles() || spec_.particles().coverage_size() == 0)
      return located(file.scene, measure(under, std::nullopt, fs::path(out)));
    for (const double coverage : spec_.particles().coverage()) {
      const fs::path folder = spec_.particles().coverage_size() == 1
                                  ? fs::path(out)
                                  : fs::path(out) / fmt::format("coverage_{:g}", coverage);
      if (const auto status = measure(under, coverage, folder); !status.ok())
        return located(file.scene, status);
    }
    return spec_.particles().coverage_size() > 2 ? write_trend() : absl::OkStatus();
  }

 private:
  absl::Status measure(GoniometerScene& under, std::optional<double> coverage,
                       const fs::path& folder) {
    std::string about;
    double covered = coverage.value_or(0);
    if (spec_.has_particles()) {
      ASSIGN_OR_RETURN(const auto bed, bed_of(spec_, coverage));
      auto model = generate_particles(bed);
      if (!model.ok()) return at_key("particles", model.status());
      const ParticleReport& p = model->report;
      covered = p.coverage;
      about = fmt::format(
          "{} grains a cell, {} tiles; coverage {:.4f}, packing fraction {:.4f}, mean height "
          "{:.4g} m, rms height {:.4g} m, top {:.4g} m, largest overlap {:.2g}",
          p.grains, spec_.particles().tiles() * spec_.particles().tiles(), p.coverage,
          p.packing_fraction, p.mean_height_m, p.rms_height_m, p.top_m, p.largest_overlap);
      under.mesh = std::move(model->mesh);
    }
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t cores = std::max(1u, std::thread::hardware_concurrency());
    ASSIGN_OR_RETURN(const auto instrument, instrument_of(spec_, threads > 0 ? threads : cores));
    ASSIGN_OR_RETURN(auto result, run_goniometer(under, instrument));
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
      return absl::InvalidArgumentError(absl::StrCat(folder.string(), ": ", error.message()));
    std::vector<std::string> provenance = provenance_;
    if (!about.empty()) provenance.push_back(about);
    const std::string summary =
        absl::StrCat(spec_.name(), about.empty() ? "" : "\n", about, "\n", summary_text(result));
    print_text("{}: {:.1f} s\n{}\n", folder.string(), seconds, summary);
    std::fflush(stdout);
    RETURN_IF_ERROR(write(result, provenance, summary, folder));
    for (std::size_t ch = 0; ch < result.channel.size(); ++ch)
      for (std::size_t j = 0; j < result.spec.source_zenith_deg.size(); ++j)
        if (const auto mean = plane_mean(result, ch, j); mean.ok())
          trend_.push_back({covered, ch, j, *mean});
    channel_ = result.channel;
    source_zenith_deg_ = result.spec.source_zenith_deg;
    return absl::OkStatus();
  }

  absl::Status write(const GoniometerResult& r, const std::vector<std::string>& provenance,
                     const std::string& summary, const fs::path& folder) const {
    const auto to = [&](const std::string& name, const std::string& text) {
      return replace_file((folder / name).string(), text);
    };
    RETURN_IF_ERROR(to("brdf.csv", brdf_csv(r, provenance)));
    RETURN_IF_ERROR(to("emissivity.csv", emissivity_csv(r, provenance)));
    RETURN_IF_ERROR(to("summary.txt", summary));
    const auto material = material_csv(r, provenance);
    if (material.ok()) {
      RETURN_IF_ERROR(to("material.csv", *material));
    } else {
      print_note("irsig: no material.csv: {}\n", std::string(material.status().message()));
    }
    for (std::size_t j = 0; j < r.spec.source_zenith_deg.size(); ++j) {
      const double source_deg = r.spec.source_zenith_deg[j];
      RETURN_IF_ERROR(
          to(fmt::format("planes_source{:g}.svg", source_deg), plane_curves(r, j, spec_.name())));
      for (const schema::GoniometerBand& b : spec_.band())
        RETURN_IF_ERROR(to(fmt::format("brdf_{}_source{:g}.svg", file_part(b.name()), source_deg),
                           plot_hemisphere(fmt::format("{}, {}, source at {:g}\u00b0", spec_.name(),
                                                       b.name(), source_deg),
                                           "pi x BRDF", band_values(r, b.name(), j), source_deg)));
    }
    return absl::OkStatus();
  }

  // The mean over the planes against coverage: is it a straight line?
  [[nodiscard]] absl::Status write_trend() const {
    std::string csv;
    for (const std::string& line : provenance_) csv += "# " + line + "\n";
    csv += fmt::format(
        "# mean of pi x BRDF over the source's plane and the one across it, zeniths up to {:g}\n"
        "coverage,source_zenith_deg,band,lambda_um,reflectance_factor,reflectance_factor_stderr\n",
        kTrendZenithDeg);
    for (const TrendPoint& p : trend_)
      csv += fmt::format("{:.5g},{:g},{},{:.6g},{:.7g},{:.3g}\n", p.coverage,
                         source_zenith_deg_[p.source], channel_[p.channel].band,
                         channel_[p.channel].lambda_um, p.mean.value, p.mean.stderr_);
    RETURN_IF_ERROR(replace_file((fs::path(out) / "coverage.csv").string(), csv));
    std::vector<CurvePanel> panels;
    std::printf("mean over the planes against coverage: departure from a straight line (rms)\n");
    for (std::size_t j = 0; j < source_zenith_deg_.size(); ++j) {
      CurvePanel panel;
      panel.title = fmt::format("Source at {:g}\u00b0", source_zenith_deg_[j]);
      panel.x_label = "Coverage";
      panel.y_label = "Mean reflectance factor";
      for (std::size_t ch = 0; ch < channel_.size(); ++ch) {
        Curve curve{channel_name(channel_[ch]), {}, {}};
        std::vector<Estimate> y;
        for (const TrendPoint& p : trend_) {
          if (p.channel != ch || p.source != j) continue;
          curve.x.push_back(p.coverage);
          curve.y.push_back(p.mean.value);
          y.push_back(p.mean);
          panel.y_high = std::max(panel.y_high, 1.1 * p.mean.value);
        }
        if (y.size() < 3) continue;
        const LineFit fit = fit_line(curve.x, y);
        double mean = 0;
        for (const Estimate& e : y) mean += e.value / static_cast<double>(y.size());
        std::printf(
            "  source %5.3g deg  %-18s slope %8.4f  departure %5.2f %% of the mean (noise "
            "%.2f %%)\n",
            source_zenith_deg_[j], channel_name(channel_[ch]).c_str(), fit.slope,
            100 * fit.rms_residual / mean, 100 * fit.rms_noise / mean);
        panel.curve.push_back(std::move(curve));
      }
      panels.push_back(std::move(panel));
    }
    return replace_file(
        (fs::path(out) / "coverage.svg").string(),
        plot_curves(spec_.name(), "mean over the source's plane and the one across it", panels,
                    std::min<std::size_t>(3, panels.size())));
  }

  struct TrendPoint {
    double coverage;
    std::size_t channel, source;
    Estimate mean;
  };
  schema::Goniometer spec_;
  std::vector<std::string> provenance_;
  std::vector<TrendPoint> trend_;
  std::vector<GoniometerChannel> channel_;
  std::vector<double> source_zenith_deg_;
};

}  // namespace

void add_goniometer(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "goniometer", "BRDF and directional emissivity of a scene on a plate, seen from all sides");
  const auto options = std::make_shared<GoniometerCommand>();
  command->add_option("SPEC", options->spec_path, "What is measured: docs/reference/goniometer.md")
      ->required()
      ->type_name("SPEC");
  command->add_option("-o,--out", options->out, "Folder for tables, pictures and the material")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--threads", options->threads, "Threads (default: one for each core)")
      ->type_name("N")
      ->check(CLI::Range(1u, 1024u));
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig

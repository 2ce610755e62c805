#include "view/report/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "view/query/query.h"
#include "view/query/query_table.h"
#include "view/report/effect_ledger.h"
#include "view/report/error_budget.h"
#include "view/report/heat_effects.h"
#include "view/report/outcome.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

struct Explained {
  QueryRow row;
  StoredLedger ledger;
  std::vector<StoredInput> input;
  std::vector<StoredPart> part;
  std::vector<StoredTemperature> temperature;  // computed, of the row's condition
  std::vector<HeatEffects::Kelvin> left_out;   // of these temperatures
  schema::Accuracy accuracy;                   // of the sweep
  std::vector<schema::Slice> slice = {};
  schema::Weather weather = {};  // of the row's condition; without a cover if it is not known
  bool land = false;             // around the target
  struct Fraction {
    std::string material;
    double fraction;
  };
  std::vector<Fraction> land_seen = {};  // of the background around the target

  [[nodiscard]] const StoredSignature& signature() const { return row.signature; }
};

absl::StatusOr<QueryRow> find_one(StoreReader& reader, const std::string& sweep,
                                  std::uint64_t row) {
  Query query;
  query.sweep = sweep;
  query.row = row;
  ASSIGN_OR_RETURN(auto rows, run_query(reader, query));
  if (rows.empty())
    return absl::NotFoundError(sweep.empty()
                                   ? fmt::format("no row {}: this database holds no signature", row)
                                   : fmt::format("sweep \"{}\" has no row {}", sweep, row));
  if (rows.size() > 1) {
    std::vector<std::string> names;
    for (const QueryRow& r : rows) names.push_back(r.signature.sweep);
    return absl::InvalidArgumentError(
        fmt::format("{} sweeps have a row {}: choose one of {} with --sweep", names.size(), row,
                    fmt::join(names, ", ")));
  }
  return rows.front();
}

absl::StatusOr<Explained> read(StoreReader& reader, const std::string& sweep, std::uint64_t row) {
  ASSIGN_OR_RETURN(auto found, find_one(reader, sweep, row));
  Explained out{std::move(found), {}, {}, {}, {}, {}, {}};
  const std::int64_t id = out.signature().signature_id;
  ASSIGN_OR_RETURN(auto ledger, reader.ledger(id));
  out.ledger = std::move(ledger);
  ASSIGN_OR_RETURN(out.input, reader.inputs(id));
  ASSIGN_OR_RETURN(out.part, reader.parts(id));
  const StoredSignature& s = out.signature();
  if (!s.superseded) {
    ASSIGN_OR_RETURN(out.temperature,
                     reader.computed_temperatures(
                         {.sweep = s.sweep, .season = s.season, .time_utc = s.time_utc}));
  }
  ASSIGN_OR_RETURN(const auto stored,
                   reader.sweep(out.signature().sweep, SweepFiles::kTemperatures));
  out.accuracy = stored.resolved.sweep().accuracy();
  out.slice.assign(stored.resolved.slice().begin(), stored.resolved.slice().end());
  if (!s.superseded) {
    for (const schema::Condition& c : stored.resolved.condition())
      if (c.season() == s.season && c.time_utc() == s.time_utc) out.weather = c.weather();
  }
  const schema::Land& land = stored.resolved.sweep().land();
  out.land = stored.resolved.sweep().has_land();
  ASSIGN_OR_RETURN(const auto clutter, reader.clutter(id));
  if (clutter && clutter->material_fraction_size() == land.material_size())
    for (int m = 0; m < land.material_size(); ++m)
      out.land_seen.push_back({land.material(m).material(), clutter->material_fraction(m)});
  ASSIGN_OR_RETURN(const auto heat, HeatEffects::make(stored));
  if (!out.ledger.effect.empty())
    for (StoredEffect& effect : heat.of(s)) out.ledger.effect.push_back(std::move(effect));
  out.left_out = heat.kelvin_of(s);
  return out;
}

// One line of an account: what, how much, which part of the whole.
std::string line(std::string_view what, double value, double whole, std::string_view note = "") {
  if (std::isnan(value)) return fmt::format("  {:<29} {:>12}\n", what, "not stored");
  const std::string share =
      std::abs(whole) > 0 ? fmt::format("{:>10.3g} %", 100 * value / std::abs(whole)) : "";
  return fmt::format("  {:<29} {:>12.6g} {:>12}{}{}\n", what, value, share,
                     note.empty() ? "" : "  ", note);
}

std::string head(std::string_view what, double value, std::string_view unit) {
  if (std::isnan(value)) return fmt::format("{:<31} {:>12}\n", what, "not stored");
  return fmt::format("{:<31} {:>12.6g} {}\n", what, value, unit);
}

// The layer of cloud as a line; empty without a cover.
std::string cloud_line(const schema::Weather& weather) {
  if (weather.cloud_cover() <= 0) return "";
  const schema::CloudLayer& layer = weather.cloud();
  return fmt::format(
      "cloud: {}covers {:g} of the sky, {:g} to {:g} m above the surface{}, {:g} g/m2 of {} with "
      "an "
      "effective radius of {:g} um\n",
      layer.type().empty() ? "" : layer.type() + " ", weather.cloud_cover(), layer.base_m(),
      layer.top_m(), layer.base_from_weather() ? " (base at twice the level of condensation)" : "",
      layer.water_path_g_m2(), layer.phase(), layer.effective_radius_um());
}

std::string title(const Explained& e) {
  const StoredSignature& s = e.signature();
  std::string out =
      fmt::format("row {} of {}: {} {}, {} ({:g} to {:g} um), aspect {:.2f},{:.2f} deg at {:g} m\n",
                  s.row, s.sweep, s.season, s.time_utc, s.band, s.lambda_min_um, s.lambda_max_um,
                  s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m);
  out += cloud_line(e.weather);
  if (s.superseded) out += "of an earlier version of the sweep: it waits for its replacement\n";
  for (const schema::Slice& slice : e.slice) out += slice_text(slice) + "\n";
  if (!s.warning.empty())
    out += "warning: " + absl::StrReplaceAll(s.warning, {{"\n", "\nwarning: "}}) + "\n";
  return out;
}

// Returns the lines about the parts of a numerical error.
std::string errors(const StoredSignature& row, IntensityOf intensity, double value, double stderr_,
                   double numerical_error) {
  std::string out = line("standard error", stderr_, value);
  out += line("undersampling, estimate", stored_undersampling_stderr(row, intensity), value,
              "a standard error for the brightest that a sample could have met");
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    // At the target there is no depth of air; a stored row was not moved.
    if (which == BoundOf::kMoved ||
        (which == BoundOf::kDepth && intensity == IntensityOf::kSource) ||
        (which == BoundOf::kBackground && intensity != IntensityOf::kContrast))
      continue;
    out += line(fmt::format("{} bound", info_of(which).name), stored_bound(row, intensity, which),
                value, info_of(which).what);
  }
  return out + line("numerical error", numerical_error, value,
                    "sqrt(standard error^2 + undersampling^2 + (sum of bounds)^2 / 3)");
}

// The background around the target, and what of it the target must be told from.
std::string clutter(const Explained& e) {
  const StoredSignature& s = e.signature();
  if (std::isnan(s.clutter_patch_sigma_w_m2_sr)) return "";
  std::string out =
      head("clutter", s.clutter_patch_sigma_w_m2_sr,
           fmt::format("W/(m2 sr), scatter of means over squares of {:.3g} m, the target's size",
                       s.clutter_patch_m));
  out +=
      line("standard error", s.clutter_patch_sigma_stderr_w_m2_sr, s.clutter_patch_sigma_w_m2_sr);
  const auto other = [&](std::string_view what, double value, double error, std::string_view note) {
    out += fmt::format("  {:<20} {:>12.6g} +- {:<9.2g}  {}\n", what, value, error, note);
  };
  other("mean", s.clutter_mean_w_m2_sr, s.clutter_mean_stderr_w_m2_sr,
        fmt::format("W/(m2 sr), in a window of {:.3g} m", s.clutter_window_m));
  other("scatter of pixels", s.clutter_sigma_w_m2_sr, s.clutter_sigma_stderr_w_m2_sr,
        fmt::format("W/(m2 sr), of {:.3g} m", s.clutter_pixel_m));
  other("skewness", s.clutter_skewness, s.clutter_skewness_stderr, "");
  other("correlation length", s.clutter_correlation_m, s.clutter_correlation_stderr_m,
        fmt::format("m; {:.3g} independent values in the window", s.clutter_cells));
  for (const Explained::Fraction& f : e.land_seen)
    if (f.fraction > 0)
      out += fmt::format("  {:<20} {:>12.3g} % of the window\n", f.material, 100 * f.fraction);
  return out + fmt::format("  {:<20} {:>12.3g} % of the target's silhouette\n", "in sight",
                           100 * s.visible_fraction);
}

std::string values(const Explained& e) {
  const std::string_view around = e.land ? "sky and ground" : "sky and sea";
  const StoredSignature& s = e.signature();
  const double i = s.intensity_w_sr, a = s.apparent_intensity_w_sr, c = s.contrast_intensity_w_sr;
  std::string out = head("intensity", i, "W/sr, at the target");
  out += errors(s, IntensityOf::kSource, i, s.intensity_stderr_w_sr, s.numerical_error_w_sr);
  out += line("model error", s.model_error_w_sr, i,
              fmt::format("{}; no part of the numerical error", around));
  out += head("apparent intensity", a, "W/sr, at the sensor");
  out += errors(s, IntensityOf::kApparent, a, s.apparent_intensity_stderr_w_sr,
                s.apparent_numerical_error_w_sr);
  out += line("model error", s.apparent_model_error_w_sr, a, fmt::format("air, {}", around));
  out += head("contrast intensity", c, "W/sr, at the sensor");
  out += errors(s, IntensityOf::kContrast, c, s.contrast_intensity_stderr_w_sr,
                s.contrast_numerical_error_w_sr);
  out += line("model error", s.contrast_model_error_w_sr, c,
              fmt::format("air, {}, {} behind the target", around, e.land ? "land" : "glitter"));
  out += head("background radiance", s.background_radiance_w_m2_sr, "W/(m2 sr), at the sensor");
  out +=
      line("standard error", s.background_radiance_stderr_w_m2_sr, s.background_radiance_w_m2_sr);
  out += head("projected area", s.projected_area_m2, "m2");
  out += line("standard error", s.projected_area_stderr_m2, s.projected_area_m2);
  if (s.backface_fraction > 0)
    out += head("seen from behind", 100 * s.backface_fraction,
                "% of the silhouette: one-sided facets, which send nothing");
  if (s.source_radiance_temperature_k > 0)
    out += head("source radiance temp.", s.source_radiance_temperature_k, "K, without air");
  if (s.apparent_temperature_k > 0)
    out += head("apparent temperature", s.apparent_temperature_k, "K, at the sensor");
  return out + clutter(e);
}

std::string effort(const Explained& e) {
  const StoredSignature& s = e.signature();
  std::string out;
  if (s.superseded) {
    out += "asked     by an earlier version of the sweep\n";
  } else if (e.accuracy.has_relative_error()) {
    out += fmt::format("asked     {:g} % of the intensity: {:.4g} W/sr",
                       100 * e.accuracy.relative_error(),
                       e.accuracy.relative_error() * std::abs(s.intensity_w_sr));
    if (!std::isnan(s.absolute_floor_w_sr))
      out += e.accuracy.absolute_error_k() > 0
                 ? fmt::format(", or the floor of {:g} K: {:.4g} W/sr",
                               e.accuracy.absolute_error_k(), s.absolute_floor_w_sr)
                 : std::string(", without a floor");
    out += "\n";
  } else {
    out += "asked     a number of samples\n";
  }
  out += fmt::format("stopped   {}\n", s.stop_reason);
  if (!s.limiting_bound.empty())
    out += fmt::format("limit     {}\n",
                       limit_text(s.limiting_bound, s.stop_reason == "sample_limit"));
  out += fmt::format("samples   {} in {} replicates, {} met the target, {} rays in all\n",
                     s.samples, s.replicates, s.target_paths, s.rays);
  if (s.reflections) out += fmt::format("paths     of at most {} reflections\n", *s.reflections);
  return out;
}

std::string energy(const std::optional<StoredEnergy>& energy) {
  if (!energy) return "none: nothing of the target is seen\n";
  std::string out;
  const auto share = [&](std::string_view what, double value, double error) {
    out += fmt::format("  {:<20} {:>12.6g} +- {:.2g}\n", what, value, error);
  };
  share("absorbed", energy->absorbed, energy->absorbed_stderr);
  share("to the sky", energy->escaped_to_sky, energy->escaped_to_sky_stderr);
  share("to sea or ground", energy->escaped_to_surface, energy->escaped_to_surface_stderr);
  share("cut off", energy->cut_off, energy->cut_off_stderr);
  share("sum", energy->balance, energy->balance_stderr);
  return out;
}

std::string causes(const StoredSignature& s) {
  std::string out;
  const auto cause = [&](std::string_view what, double value, double error) {
    out += line(what, value, s.intensity_w_sr, fmt::format("+- {:.2g}", error));
  };
  cause("emitted", s.emitted_w_sr, s.emitted_stderr_w_sr);
  cause("sun reflected", s.sun_reflected_w_sr, s.sun_reflected_stderr_w_sr);
  cause("sky reflected", s.sky_reflected_w_sr, s.sky_reflected_stderr_w_sr);
  cause("sea reflected", s.surface_reflected_w_sr, s.surface_reflected_stderr_w_sr);
  cause("parts reflected", s.interreflected_w_sr, s.interreflected_stderr_w_sr);
  return out;
}

// Returns the lines about uncertain inputs, the one that contributes most to the intensity first.
std::string inputs(const Explained& e) {
  if (e.input.empty()) return "";
  const StoredSignature& s = e.signature();
  std::string out = fmt::format(
      "\nuncertain inputs: what the row gains if one is a sigma higher, in W/sr; no part of any "
      "error above\n  {:<22} {:>20} {:>20} {:>20}\n",
      "", "intensity", "apparent", "contrast");
  std::vector<StoredInput> sorted = e.input;
  std::stable_sort(sorted.begin(), sorted.end(), [](const StoredInput& a, const StoredInput& b) {
    return std::abs(a.source.contribution_w_sr) > std::abs(b.source.contribution_w_sr);
  });
  const auto gain = [](const StoredInput::Gain& g) {
    return fmt::format("{:+.4g} +- {:.1g}", g.contribution_w_sr, g.stderr_w_sr);
  };
  for (const StoredInput& i : sorted)
    out += fmt::format("  {:<22} {:>20} {:>20} {:>20}\n", i.input, gain(i.source), gain(i.apparent),
                       gain(i.contrast));
  const auto together = [](const char* name, double source, double apparent, double contrast) {
    if (std::isnan(source)) return std::string();
    return fmt::format("  {:<22} {:>20.4g} {:>20.4g} {:>20.4g}\n", name, source, apparent,
                       contrast);
  };
  return out +
         together("together, one sigma", s.input_uncertainty_w_sr,
                  s.apparent_input_uncertainty_w_sr, s.contrast_input_uncertainty_w_sr) +
         together("heat model, one sigma", s.heat_model_error_w_sr,
                  s.apparent_heat_model_error_w_sr, s.contrast_heat_model_error_w_sr);
}

std::string text_of(const Explained& e) {
  const StoredSignature& s = e.signature();
  std::string out = title(e) + "\n" + values(e) + inputs(e) + "\n" + effort(e) + "\n";
  if (e.ledger.effect.empty()) {
    out +=
        "no ledger of effects: an older irsig stored this row (format version 4 or less), and "
        "what was\nleft out is not known; run the sweep again to have it\n";
  } else {
    out +=
        "effects: bounds relative to the intensity, the apparent intensity and the contrast; "
        "share of the\nintensity; time of the whole view, estimated\n" +
        ledger_table(s, e.ledger.effect) + "\nlight that the sensor would send out ends\n" +
        energy(e.ledger.energy);
  }
  out += "\nintensity by cause\n" + causes(s) + "\nintensity by the part that the sensor sees\n";
  for (const StoredPart& part : e.part)
    out += line(part.part, part.intensity_w_sr, s.intensity_w_sr,
                fmt::format("+- {:.2g}", part.intensity_stderr_w_sr));
  if (e.temperature.empty()) return out;
  out += "\ntemperatures that a job has computed, of each part's facets\n";
  for (const StoredTemperature& t : e.temperature)
    out += fmt::format("  {:<20} {:>8.2f} K, {:.2f} to {:.2f} K, +- {:.2g} K\n", t.part, t.mean_k,
                       t.coldest_k, t.hottest_k, t.error_k);
  for (const HeatEffects::Kelvin& k : e.left_out)
    out += fmt::format("  {:<20} {}, facets would be warmer or colder by {:.3g} K at most{}\n",
                       k.effect, k.off ? "off: with it" : "on: without it", k.largest_k,
                       k.off ? ", which is in their errors" : "");
  return out;
}

// One array of objects in an object.
absl::Status write_array(std::string_view name, const std::vector<std::string>& columns,
                         const std::vector<std::vector<Cell>>& rows, std::ostream& out) {
  out << "\"" << name << "\": ";
  std::vector<Column> heads;
  for (const std::string& column : columns) heads.push_back({column});
  ASSIGN_OR_RETURN(auto writer, make_table_writer("json", heads, out));
  for (const auto& row : rows) writer->row(row);
  return writer->finish();
}

Cell known(double value) { return std::isnan(value) ? Cell() : Cell(value); }

absl::Status write_json(StoreReader& reader, const Explained& e, std::ostream& out) {
  out << "{\"signature\": ";
  QueryContent content;
  content.causes = true;
  RETURN_IF_ERROR(write_rows(reader, {e.row}, content, "json", out));
  std::vector<std::vector<Cell>> budget, effects, shares, parts;
  for (const auto quantity : {SignatureQuantity::kIntensity, SignatureQuantity::kApparentIntensity,
                              SignatureQuantity::kContrastIntensity})
    for (const ErrorPart& part : error_budget(e.row, columns_of(quantity)))
      budget.push_back({std::string(columns_of(quantity).name), part.name, part.bound,
                        known(part.error_w_sr), known(part.share)});
  for (const StoredEffect& f : e.ledger.effect)
    effects.push_back({f.effect, f.state, f.reason, known(f.bound_w_sr),
                       known(f.apparent_bound_w_sr), known(f.contrast_bound_w_sr),
                       known(f.fraction_w_sr), known(f.time_s)});
  if (const auto& n = e.ledger.energy)
    shares.push_back({n->absorbed, n->absorbed_stderr, n->escaped_to_sky, n->escaped_to_sky_stderr,
                      n->escaped_to_surface, n->escaped_to_surface_stderr, n->cut_off,
                      n->cut_off_stderr, n->balance, n->balance_stderr});
  for (const StoredPart& part : e.part)
    parts.push_back({part.part, part.intensity_w_sr, part.intensity_stderr_w_sr});
  out << ",\n";
  RETURN_IF_ERROR(write_array(
      "error_budget", {"quantity", "name", "is_bound", "error_w_sr", "share"}, budget, out));
  out << ",\n";
  RETURN_IF_ERROR(write_array("effects",
                              {"effect", "state", "reason", "bound_w_sr", "apparent_bound_w_sr",
                               "contrast_bound_w_sr", "fraction_w_sr", "time_s"},
                              effects, out));
  out << ",\n";
  RETURN_IF_ERROR(
      write_array("energy",
                  {"absorbed", "absorbed_stderr", "escaped_to_sky", "escaped_to_sky_stderr",
                   "escaped_to_surface", "escaped_to_surface_stderr", "cut_off", "cut_off_stderr",
                   "balance", "balance_stderr"},
                  shares, out));
  out << ",\n";
  RETURN_IF_ERROR(write_array(
      "parts", {"part", "part_intensity_w_sr", "part_intensity_stderr_w_sr"}, parts, out));
  out << ",\n";
  std::vector<std::vector<Cell>> inputs;
  for (const StoredInput& i : e.input) {
    std::vector<Cell>& cells = inputs.emplace_back(std::vector<Cell>{i.input});
    for (const StoredInput::Gain* g : {&i.source, &i.apparent, &i.contrast})
      for (const double v : {g->contribution_w_sr, g->stderr_w_sr, g->curvature_w_sr})
        cells.push_back(known(v));
  }
  RETURN_IF_ERROR(
      write_array("inputs",
                  {"input", "contribution_w_sr", "contribution_stderr_w_sr", "curvature_w_sr",
                   "apparent_contribution_w_sr", "apparent_contribution_stderr_w_sr",
                   "apparent_curvature_w_sr", "contrast_contribution_w_sr",
                   "contrast_contribution_stderr_w_sr", "contrast_curvature_w_sr"},
                  inputs, out));
  out << ",\n";
  std::vector<std::vector<Cell>> temperatures;
  for (const StoredTemperature& t : e.temperature)
    temperatures.push_back({t.part, t.mean_k, t.coldest_k, t.hottest_k, t.error_k});
  RETURN_IF_ERROR(write_array(
      "temperatures", {"part", "mean_k", "coldest_k", "hottest_k", "error_k"}, temperatures, out));
  out << ",\n";
  std::vector<std::vector<Cell>> slices;
  for (const schema::Slice& slice : e.slice)
    slices.push_back({slice.source(), slice.sweep_sha256(), slice.source_rows(),
                      slice.source_digest(), slice.filter(), slice.rows()});
  RETURN_IF_ERROR(write_array(
      "slices", {"source", "sweep_sha256", "source_rows", "source_digest", "filter", "rows"},
      slices, out));
  out << ",\n";
  std::vector<std::vector<Cell>> materials;
  for (const Explained::Fraction& f : e.land_seen) materials.push_back({f.material, f.fraction});
  RETURN_IF_ERROR(write_array("land_seen", {"material", "fraction"}, materials, out));
  out << ",\n";
  std::vector<std::vector<Cell>> clouds;
  if (const double cover = e.weather.cloud_cover(); cover > 0) {
    const schema::CloudLayer& layer = e.weather.cloud();
    clouds.push_back({cover, layer.type(), layer.phase(), layer.base_m(), layer.top_m(),
                      layer.water_path_g_m2(), layer.effective_radius_um()});
  }
  RETURN_IF_ERROR(write_array(
      "cloud",
      {"cover", "type", "phase", "base_m", "top_m", "water_path_g_m2", "effective_radius_um"},
      clouds, out));
  out << "}\n";
  return out.flush() ? absl::OkStatus() : absl::UnavailableError("cannot write the output");
}

}  // namespace

absl::Status explain_row(StoreReader& reader, const std::string& sweep, std::uint64_t row,
                         std::string_view format, std::ostream& out) {
  if (format != "text" && format != "json")
    return absl::InvalidArgumentError(
        fmt::format("unknown format \"{}\": expected text or json", format));
  ASSIGN_OR_RETURN(const auto explained, read(reader, sweep, row));
  if (format == "json") return write_json(reader, explained, out);
  out << printable(text_of(explained));
  return out.flush() ? absl::OkStatus() : absl::UnavailableError("cannot write the output");
}

}  // namespace irsig

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "absl/strings/str_join.h"
#include "bridge/environment/sweep_environment.h"
#include "core/accuracy/spectral_modes.h"
#include "core/geo/sun.h"
#include "core/spectral/band.h"
#include "view/export.h"
#include "view/netcdf_file.h"
#include "view/progress.h"

namespace irsig {
namespace {

using S = StoredSignature;

// Each distinct key gets the next place, in order of appearance (rows come in row order).
template <typename Key>
class Places {
 public:
  std::size_t place(const Key& key, const S& first) {
    const auto [at, fresh] = place_.try_emplace(key, first_.size());
    if (fresh) first_.push_back(&first);
    return at->second;
  }
  [[nodiscard]] std::size_t size() const { return first_.size(); }
  // The signature that each place appeared with first.
  [[nodiscard]] const std::vector<const S*>& first() const { return first_; }

 private:
  std::map<Key, std::size_t> place_;
  std::vector<const S*> first_;
};

template <typename T, typename Get>
std::vector<T> collected(const std::vector<const S*>& from, const Get& get) {
  std::vector<T> out;
  for (const S* s : from) out.push_back(get(*s));
  return out;
}

// The cube that a file holds. A condition is a season at a time of day ("01:30:00Z"); where a
// season has several dates, at an instant.
struct Layout {
  Places<std::tuple<double, double, double>> viewpoint;  // at its stored range
  Places<std::string> season, time, band;
  Places<double> range;  // of moved rows; else one for all
  bool moved;
  struct Cell {
    std::size_t viewpoint, season, time, band, range;
  };
  std::vector<Cell> cell;  // of each row

  static double stored_range_m(const QueryRow& r) {
    return r.range_change ? r.range_change->stored_range_m : r.signature.range_m;
  }

  explicit Layout(const std::vector<QueryRow>& rows)
      : moved(rows.front().range_change.has_value()) {
    std::set<double> ranges;  // increasing, whatever the order they were asked for in
    for (const QueryRow& r : rows) ranges.insert(moved ? r.signature.range_m : 0);
    for (const double r : ranges) range.place(r, rows.front().signature);
    range_m.assign(ranges.begin(), ranges.end());
    std::map<std::pair<std::string, std::string>, std::string> instant;
    const auto clock = [](const S& s) { return s.time_utc.substr(s.time_utc.find('T') + 1); };
    bool dated = false;
    for (const QueryRow& r : rows) {
      const S& s = r.signature;
      dated |= instant.try_emplace({s.season, clock(s)}, s.time_utc).first->second != s.time_utc;
    }
    std::set<std::string> times;  // in their order
    for (const QueryRow& r : rows) times.insert(dated ? r.signature.time_utc : clock(r.signature));
    for (const std::string& t : times) time.place(t, rows.front().signature);
    for (const QueryRow& r : rows) {
      const S& s = r.signature;
      const double stored_m = stored_range_m(r);
      const std::tuple key(s.aspect_azimuth_deg, s.aspect_elevation_deg, stored_m);
      const std::size_t views = viewpoint.size();
      cell.push_back({viewpoint.place(key, s), season.place(s.season, s),
                      time.place(dated ? s.time_utc : clock(s), s), band.place(s.band, s),
                      range.place(moved ? s.range_m : 0, s)});
      if (viewpoint.size() > views) viewpoint_range_m.push_back(stored_m);
    }
    time_name.assign(times.begin(), times.end());
  }
  std::vector<std::string> time_name;
  std::vector<double> range_m, viewpoint_range_m;

  [[nodiscard]] std::size_t condition(const Cell& c) const {
    return c.season * time.size() + c.time;
  }
  [[nodiscard]] std::size_t conditions() const { return season.size() * time.size(); }
  // Among those of a viewpoint.
  [[nodiscard]] std::size_t place(const Cell& c) const {
    return (condition(c) * band.size() + c.band) * range.size() + c.range;
  }
  [[nodiscard]] std::size_t places() const { return conditions() * band.size() * range.size(); }
  [[nodiscard]] std::size_t index(const Cell& c) const { return c.viewpoint * places() + place(c); }
  [[nodiscard]] std::size_t size() const { return viewpoint.size() * places(); }
};

using Sp = schema::Spectrum;
struct SpectralColumn {
  const char* name;
  const google::protobuf::RepeatedField<float>& (Sp::*values)() const;
};
constexpr SpectralColumn kSpectra[] = {
    {"spectral_intensity_w_sr_um", &Sp::spectral_intensity_w_sr_um},
    {"spectral_intensity_stderr_w_sr_um", &Sp::spectral_intensity_stderr_w_sr_um},
    {"spectral_emitted_w_sr_um", &Sp::emitted_w_sr_um},
    {"spectral_emitted_stderr_w_sr_um", &Sp::emitted_stderr_w_sr_um},
    {"spectral_sun_reflected_w_sr_um", &Sp::sun_reflected_w_sr_um},
    {"spectral_sun_reflected_stderr_w_sr_um", &Sp::sun_reflected_stderr_w_sr_um},
    {"spectral_sky_reflected_w_sr_um", &Sp::sky_reflected_w_sr_um},
    {"spectral_sky_reflected_stderr_w_sr_um", &Sp::sky_reflected_stderr_w_sr_um},
    {"spectral_sea_reflected_w_sr_um", &Sp::sea_reflected_w_sr_um},
    {"spectral_sea_reflected_stderr_w_sr_um", &Sp::sea_reflected_stderr_w_sr_um},
    {"spectral_parts_reflected_w_sr_um", &Sp::parts_reflected_w_sr_um},
    {"spectral_parts_reflected_stderr_w_sr_um", &Sp::parts_reflected_stderr_w_sr_um},
    {"apparent_spectral_intensity_w_sr_um", &Sp::apparent_spectral_intensity_w_sr_um},
    {"apparent_spectral_intensity_stderr_w_sr_um", &Sp::apparent_spectral_intensity_stderr_w_sr_um},
    {"contrast_spectral_intensity_w_sr_um", &Sp::contrast_spectral_intensity_w_sr_um},
    {"contrast_spectral_intensity_stderr_w_sr_um", &Sp::contrast_spectral_intensity_stderr_w_sr_um},
    {"background_radiance_w_m2_sr_um", &Sp::background_radiance_w_m2_sr_um},
    {"background_radiance_stderr_w_m2_sr_um", &Sp::background_radiance_stderr_w_m2_sr_um},
    {"path_transmittance", &Sp::path_transmittance},
    {"path_radiance_w_m2_sr_um", &Sp::path_radiance_w_m2_sr_um},
};

struct ModeColumn {
  const char* name;
  const std::string& (Sp::*encoded)() const;
  const google::protobuf::RepeatedField<float>& (Sp::*value_stderr)() const;
};
constexpr ModeColumn kModes[] = {
    {"spectral_intensity_modes_w_sr_um", &Sp::spectral_intensity_modes,
     &Sp::spectral_intensity_stderr_w_sr_um},
    {"apparent_spectral_intensity_modes_w_sr_um", &Sp::apparent_spectral_intensity_modes,
     &Sp::apparent_spectral_intensity_stderr_w_sr_um},
    {"contrast_spectral_intensity_modes_w_sr_um", &Sp::contrast_spectral_intensity_modes,
     &Sp::contrast_spectral_intensity_stderr_w_sr_um},
};

using Dimension = NetcdfFile::Dimension;
struct Dimensions {
  Dimension viewpoint, season, time, band;
  std::optional<Dimension> range;  // of moved rows
  [[nodiscard]] std::vector<Dimension> cube() const {
    std::vector<Dimension> out{viewpoint, season, time, band};
    if (range) out.push_back(*range);
    return out;
  }
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kCoordinates = "aspect_azimuth_deg aspect_elevation_deg range_m time";

// What is known of each condition: when it is, the sun, the weather. [season][time]
void write_conditions(NetcdfFile& file, const std::vector<QueryRow>& rows,
                      const schema::ResolvedSweep& sweep, const Layout& layout,
                      const Dimensions& d) {
  std::vector<const S*> any(layout.conditions());
  for (std::size_t i = 0; i < rows.size(); ++i)
    any[layout.condition(layout.cell[i])] = &rows[i].signature;
  const auto each = [&](const auto& get) {
    std::vector<double> out;
    for (const S* s : any) out.push_back(s == nullptr ? kNan : get(*s));
    return out;
  };
  const std::vector<Dimension> plane{d.season, d.time};
  file.times({"time", "instant of the condition", ""}, plane, each([](const S& s) {
               const auto t = parse_rfc3339(s.time_utc);
               return t.ok() ? unix_seconds(*t) : kNan;
             }));
  file.doubles(
      {"sun_azimuth_deg", "azimuth of the sun seen from the target, clockwise from north", ""},
      plane, each([](const S& s) { return s.sun_azimuth_deg; }));
  file.doubles({"sun_zenith_deg", "zenith angle of the sun seen from the target", ""}, plane,
               each([](const S& s) { return s.sun_zenith_deg; }));
  const auto condition_of = [&](const S& s) -> const schema::Condition* {
    for (const schema::Condition& c : sweep.condition())
      if (c.season() == s.season && c.time_utc() == s.time_utc) return &c;
    return nullptr;  // of an earlier version of the sweep
  };
  // 0: the sweep does not say.
  const auto stated = [&](const char* name, const auto& get) {
    auto values = each([&](const S& s) {
      const schema::Condition* c = condition_of(s);
      return c == nullptr || get(*c) == 0 ? kNan : get(*c);
    });
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      file.doubles({name, "", ""}, plane, values);
  };
  using C = schema::Condition;
  stated("air_temperature_k", [](const C& c) {
    return c.weather().surface_stated() ? c.weather().air_temperature_k() : c.air_temperature_k();
  });
  stated("relative_humidity_percent",
         [](const C& c) { return c.weather().relative_humidity_percent(); });
  stated("pressure_pa", [](const C& c) { return c.weather().pressure_pa(); });
  stated("wind_speed_m_s", [](const C& c) { return c.weather().wind_speed_m_s(); });
  stated("visibility_m", [](const C& c) { return c.weather().visibility_m(); });
  stated("sea_temperature_k", [](const C& c) { return c.surroundings().sea_temperature_k(); });
  stated("ground_temperature_k",
         [](const C& c) { return c.surroundings().ground_temperature_k(); });
  stated("sun_irradiance_w_m2", [](const C& c) { return c.sun_irradiance_w_m2(); });
  std::vector<std::string> warning;
  for (const S* s : any) {
    const schema::Condition* c = s == nullptr ? nullptr : condition_of(*s);
    warning.push_back(c == nullptr ? "" : absl::StrJoin(c->warning(), "\n"));
  }
  file.strings({"warning", "what is odd about the condition, one line each", ""}, plane, warning);
}

void write_axes(NetcdfFile& file, const Layout& layout, const Dimensions& d) {
  const auto& views = layout.viewpoint.first();
  file.doubles({"aspect_azimuth_deg",
                "azimuth of the sensor seen from the target, clockwise from the bow", ""},
               {d.viewpoint},
               collected<double>(views, [](const S& s) { return s.aspect_azimuth_deg; }));
  file.doubles({"aspect_elevation_deg", "elevation of the sensor seen from the target", ""},
               {d.viewpoint},
               collected<double>(views, [](const S& s) { return s.aspect_elevation_deg; }));
  file.doubles({layout.moved ? "stored_range_m" : "range_m",
                layout.moved ? "slant range that the signature was computed at"
                             : "slant range from the target's reference point to the aperture",
                ""},
               {d.viewpoint}, layout.viewpoint_range_m);
  if (d.range)
    file.doubles({"range_m", "slant range from the target's reference point to the aperture", ""},
                 {*d.range}, layout.range_m);
  file.strings({"season", "", ""}, {d.season},
               collected<std::string>(layout.season.first(), [](const S& s) { return s.season; }));
  file.strings(
      {"time_of_day", "time of day, UTC; date and time where a season has several dates", ""},
      {d.time}, layout.time_name);
  const auto& bands = layout.band.first();
  file.strings({"band", "", ""}, {d.band},
               collected<std::string>(bands, [](const S& s) { return s.band; }));
  file.doubles({"lambda_min_um", "lower limit of the band", ""}, {d.band},
               collected<double>(bands, [](const S& s) { return s.lambda_min_um; }));
  file.doubles({"lambda_max_um", "upper limit of the band", ""}, {d.band},
               collected<double>(bands, [](const S& s) { return s.lambda_max_um; }));
}

void write_scalars(NetcdfFile& file, const std::vector<QueryRow>& rows, const Layout& layout,
                   const Dimensions& d) {
  for (std::size_t q = 0; q < kQuantities.size(); ++q) {
    std::vector<double> values(layout.size(), kNan);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double v = rows[i].signature.*kQuantityMember[q];
      // 0 K stands for "no projected area": there is no such temperature.
      if (kQuantityMember[q] == &S::apparent_temperature_k && v == 0) continue;
      values[layout.index(layout.cell[i])] = v;
    }
    file.doubles({kQuantities[q].name.data(), "", "", kCoordinates}, d.cube(), values);
  }
  if (layout.moved) {
    std::vector<double> values(layout.size(), kNan);
    for (std::size_t i = 0; i < rows.size(); ++i)
      values[layout.index(layout.cell[i])] = rows[i].range_change->range_bound_w_sr;
    file.doubles({"range_bound_w_sr", "what moving to the range adds to the apparent error", "",
                  kCoordinates},
                 d.cube(), values);
  }
  std::vector<long long> row(layout.size(), -1), samples = row;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    row[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.row);
    samples[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.samples);
  }
  file.counts({"row", "place in the sweep, -1: not computed", ""}, d.cube(), row);
  file.counts({"samples", "primary rays of all replicates, -1: not computed", ""}, d.cube(),
              samples);
}

// Of rows with uncertain inputs: what each contributes, as a cube for each input. Interpolated rows
// have none.
absl::Status write_inputs(StoreReader& reader, NetcdfFile& file, const std::vector<QueryRow>& rows,
                          const Layout& layout, const Dimensions& d) {
  std::vector<std::string> names;
  std::vector<std::vector<StoredInput>> inputs_of_row;
  for (const QueryRow& r : rows) {
    std::vector<StoredInput>& of_row = inputs_of_row.emplace_back();
    if (r.interpolation || std::isnan(r.signature.input_uncertainty_w_sr)) continue;
    auto inputs = reader.inputs(r.signature.signature_id);
    if (!inputs.ok()) return inputs.status();
    of_row = *std::move(inputs);
    for (const StoredInput& i : of_row)
      if (std::find(names.begin(), names.end(), i.input) == names.end()) names.push_back(i.input);
  }
  if (names.empty()) return absl::OkStatus();
  std::vector<double> value(layout.size() * names.size(), kNan), value_stderr = value;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const StoredInput& input : inputs_of_row[i]) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), input.input) -
                                               names.begin());
      const std::size_t to = layout.index(layout.cell[i]) * names.size() + at;
      value[to] = input.source.contribution_w_sr;
      value_stderr[to] = input.source.stderr_w_sr;
    }
  const auto input = file.dimension("input", names.size());
  file.strings({"input", "uncertain input of the sweep", ""}, {input}, names);
  std::vector<Dimension> cube = d.cube();
  cube.push_back(input);
  file.doubles({"input_contribution_w_sr", "what the intensity gains by one sigma of the input", "",
                kCoordinates},
               cube, value);
  file.doubles({"input_contribution_stderr_w_sr", "", "", kCoordinates}, cube, value_stderr);
  return absl::OkStatus();
}

absl::Status write_parts(StoreReader& reader, NetcdfFile& file, const std::vector<QueryRow>& rows,
                         const Layout& layout, const Dimensions& d) {
  std::vector<std::string> names;
  std::vector<std::vector<RowPart>> parts_of_row;
  LoopProgress progress("parts read, rows", rows.size());
  for (const QueryRow& r : rows) {
    progress.step();
    auto parts = parts_of(reader, r);
    if (!parts.ok()) return parts.status();
    for (const RowPart& p : *parts) {
      if (std::find(names.begin(), names.end(), p.part.part) == names.end()) {
        names.push_back(p.part.part);
      }
    }
    parts_of_row.push_back(std::move(*parts));
  }
  if (names.empty()) return absl::OkStatus();
  std::vector<double> value(layout.size() * names.size(), kNan), value_stderr = value;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const RowPart& p : parts_of_row[i]) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), p.part.part) -
                                               names.begin());
      const std::size_t to = layout.index(layout.cell[i]) * names.size() + at;
      value[to] = p.part.intensity_w_sr;
      value_stderr[to] = p.part.intensity_stderr_w_sr;
    }
  }
  const auto part = file.dimension("part", names.size());
  file.strings({"part", "part of the target", ""}, {part}, names);
  std::vector<Dimension> cube = d.cube();
  cube.push_back(part);
  file.doubles({"part_intensity_w_sr", "", "", kCoordinates}, cube, value);
  file.doubles({"part_intensity_stderr_w_sr", "", "", kCoordinates}, cube, value_stderr);
  return absl::OkStatus();
}

// What each bin of a band adds to the in-band integral of a spectrum of bin means, response
// included: exact where the spectrum is a straight line. (Only half of the first and last bin lies
// inside the band; its mean is not that of the half.)
std::vector<double> bin_weights(const BandGrid& grid) {
  const std::size_t bins = grid.lambda_um.size();
  std::vector<double> weight(bins, 0.0);
  for (std::size_t k = 0; k < bins; ++k) {
    double moment = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      weight[k] += grid.band_weight[i];
      moment += grid.band_weight[i] * (grid.node_um[i] - grid.lambda_um[k]);
    }
    // Times the slope, from the bins beside it.
    const std::size_t below = k == 0 ? 0 : k - 1, above = std::min(k + 1, bins - 1);
    if (above == below) continue;
    const double per_mean = moment / (grid.lambda_um[above] - grid.lambda_um[below]);
    weight[above] += per_mean;
    weight[below] -= per_mean;
  }
  return weight;
}

// The bins of a band's stored wavelengths: their limits and weights.
absl::Status write_bins(NetcdfFile& file, const schema::ResolvedSweep& sweep, const Layout& layout,
                        const std::vector<std::vector<double>>& lambda_um, Dimension band,
                        Dimension bin, std::size_t bins) {
  std::vector<double> axis(layout.band.size() * bins, kNan), weight = axis,
                                                             bounds(2 * axis.size(), kNan);
  for (std::size_t b = 0; b < layout.band.size(); ++b) {
    for (std::size_t k = 0; k < lambda_um[b].size(); ++k) axis[b * bins + k] = lambda_um[b][k];
    const auto& bands = sweep.sweep().band();
    const auto of = std::find_if(bands.begin(), bands.end(), [&](const schema::Band& message) {
      return message.name() == layout.band.first()[b]->band;
    });
    if (of == bands.end()) continue;
    Band stated{of->name(), of->lambda_min_um(), of->lambda_max_um(), of->step_um(), {}};
    for (const schema::SpectralPoint& p : of->response())
      stated.response.push_back({p.lambda_um(), p.value()});
    const auto grid = make_band_grid(stated, spectral_breaks_um(sweep));
    if (!grid.ok()) return grid.status();
    if (grid->lambda_um.size() != lambda_um[b].size()) continue;  // of an earlier version
    const std::vector<double> of_bin = bin_weights(*grid);
    for (std::size_t k = 0; k < of_bin.size(); ++k) {
      bounds[2 * (b * bins + k)] = grid->lambda_um[k] - grid->step_um / 2;
      bounds[2 * (b * bins + k) + 1] = grid->lambda_um[k] + grid->step_um / 2;
      weight[b * bins + k] = of_bin[k];
    }
  }
  file.doubles({"lambda_um", "wavelength in vacuum, middle of the bin", ""}, {band, bin}, axis);
  file.doubles({"lambda_bounds_um", "limits of the bin, over which spectra are means", ""},
               {band, bin, file.dimension("edge", 2)}, bounds);
  file.doubles({"in_band_weight_um",
                "response x width inside the band: sums of these times a spectrum are in-band", ""},
               {band, bin}, weight);
  return absl::OkStatus();
}

// A viewpoint at a time, so that memory does not grow with the number of rows.
absl::Status write_spectra(StoreReader& reader, NetcdfFile& file,
                           const schema::ResolvedSweep& sweep, const std::vector<QueryRow>& rows,
                           const Layout& layout, const Dimensions& d, std::optional<Dimension>& bin,
                           std::size_t& bins) {
  std::vector<std::vector<double>> lambda_um(layout.band.size());
  std::vector<std::vector<std::size_t>> of_viewpoint(layout.viewpoint.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    of_viewpoint[layout.cell[i].viewpoint].push_back(i);
    std::vector<double>& axis = lambda_um[layout.cell[i].band];
    if (!axis.empty()) continue;
    const auto first = spectrum_of(reader, rows[i]);
    if (!first.ok()) return first.status();
    axis.assign(first->spectrum.lambda_um().begin(), first->spectrum.lambda_um().end());
    bins = std::max(bins, axis.size());
  }
  if (bins == 0) return absl::OkStatus();
  bin = file.dimension("bin", bins);
  if (absl::Status s = write_bins(file, sweep, layout, lambda_um, d.band, *bin, bins); !s.ok())
    return s;
  std::vector<Dimension> cube = d.cube();
  cube.push_back(*bin);
  std::vector<NetcdfFile::Variable> variable;
  for (const SpectralColumn& column : kSpectra) {
    // A name of its own where it is also that of an in-band quantity.
    const std::string name = column.name;
    const bool taken = std::any_of(kQuantities.begin(), kQuantities.end(),
                                   [&](const QuantityInfo& q) { return q.name == name; });
    variable.push_back(file.slabs(
        {taken ? "spectral_" + name : name, "", name, fmt::format("{} lambda_um", kCoordinates)},
        cube));
  }
  const std::size_t slab = layout.places() * bins;
  std::vector<std::vector<float>> values(std::size(kSpectra));
  LoopProgress progress("spectra written, viewpoints", of_viewpoint.size());
  for (std::size_t v = 0; v < of_viewpoint.size(); ++v) {
    progress.step();
    for (auto& column : values) column.assign(slab, std::numeric_limits<float>::quiet_NaN());
    for (const std::size_t i : of_viewpoint[v]) {
      const Layout::Cell& cell = layout.cell[i];
      const auto got = spectrum_of(reader, rows[i]);
      if (!got.ok()) return got.status();
      const auto& axis = got->spectrum.lambda_um();
      if (!std::equal(axis.begin(), axis.end(), lambda_um[cell.band].begin(),
                      lambda_um[cell.band].end()))
        return absl::InternalError(
            fmt::format("row {}: other wavelengths than the first row of band \"{}\"",
                        rows[i].signature.row, rows[i].signature.band));
      const std::size_t to = layout.place(cell) * bins;
      for (std::size_t c = 0; c < values.size(); ++c) {
        const auto& of_row = (got->spectrum.*kSpectra[c].values)();
        std::copy_n(of_row.begin(),
                    std::min<std::size_t>(static_cast<std::size_t>(of_row.size()), bins),
                    values[c].begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
    for (std::size_t c = 0; c < values.size(); ++c) file.put(variable[c], v, values[c]);
  }
  return absl::OkStatus();
}

// Of rows that have them: the covariance of a spectrum's errors is the sum over modes of m m^T.
absl::Status write_modes(StoreReader& reader, NetcdfFile& file, const std::vector<QueryRow>& rows,
                         const Layout& layout, const Dimensions& d, std::optional<Dimension> bin,
                         std::size_t bins) {
  if (!bin) return absl::OkStatus();
  std::vector<std::vector<std::size_t>> of_viewpoint(layout.viewpoint.size());
  std::size_t most = 0;
  const auto modes_of = [&](const QueryRow& row, const schema::Spectrum& spectrum,
                            const ModeColumn& column) -> absl::StatusOr<SpectralSet> {
    if (row.interpolation) return SpectralSet{};
    const auto& stderrs = (spectrum.*column.value_stderr)();
    auto errors = SumErrors::make({stderrs.data(), static_cast<std::size_t>(stderrs.size())},
                                  (spectrum.*column.encoded)());
    if (!errors.ok()) return errors.status();
    return errors->modes();
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto got = spectrum_of(reader, rows[i]);
    if (!got.ok()) return got.status();
    for (const ModeColumn& column : kModes) {
      const auto modes = modes_of(rows[i], got->spectrum, column);
      if (!modes.ok()) return modes.status();
      most = std::max(most, modes->size());
    }
    of_viewpoint[layout.cell[i].viewpoint].push_back(i);
  }
  if (most == 0) return absl::OkStatus();
  std::vector<Dimension> cube = d.cube();
  cube.push_back(file.dimension("mode", most));
  cube.push_back(*bin);
  std::vector<NetcdfFile::Variable> variable;
  for (const ModeColumn& column : kModes)
    variable.push_back(file.slabs(
        {column.name, "", column.name, fmt::format("{} lambda_um", kCoordinates)}, cube));
  const std::size_t of_row = most * bins;
  for (std::size_t v = 0; v < of_viewpoint.size(); ++v)
    for (std::size_t c = 0; c < std::size(kModes); ++c) {
      std::vector<float> values(layout.places() * of_row, std::numeric_limits<float>::quiet_NaN());
      for (const std::size_t i : of_viewpoint[v]) {
        const auto got = spectrum_of(reader, rows[i]);
        if (!got.ok()) return got.status();
        const auto modes = modes_of(rows[i], got->spectrum, kModes[c]);
        if (!modes.ok()) return modes.status();
        if (modes->empty()) continue;
        const Layout::Cell& cell = layout.cell[i];
        const std::size_t to = layout.place(cell) * of_row;
        // Fewer modes than others have: the rest of them are 0.
        for (std::size_t m = 0; m < most; ++m)
          for (std::size_t k = 0; k < modes->front().size(); ++k)
            values[to + m * bins + k] =
                m < modes->size() ? static_cast<float>((*modes)[m][k]) : 0.0f;
      }
      file.put(variable[c], v, values);
    }
  return absl::OkStatus();
}

}  // namespace

absl::Status write_netcdf(StoreReader& reader, const std::vector<QueryRow>& rows,
                          const std::string& path) {
  const S& any = rows.front().signature;
  const auto sweep = reader.sweep(any.sweep);
  if (!sweep.ok()) return sweep.status();
  const Layout layout(rows);
  NetcdfFile file(path);
  file.attribute("Conventions", "CF-1.10");
  file.attribute("title", "Infrared signatures of sweep " + any.sweep);
  file.attribute("source", fmt::format("irsig build {}, physics version {}", any.build_id,
                                       any.physics_version));
  file.attribute("determinism_class", any.determinism_class);
  file.attribute("comment",
                 "Intensities are at the target unless a name starts with apparent or contrast (at "
                 "the sensor's aperture; contrast is the target less its background). Standard "
                 "errors, numerical errors and model errors are one sigma. NaN: not computed.");
  Dimensions d{file.dimension("viewpoint", layout.viewpoint.size()),
               file.dimension("season", layout.season.size()),
               file.dimension("time_of_day", layout.time.size()),
               file.dimension("band", layout.band.size()),
               {}};
  if (layout.moved) d.range = file.dimension("range_m", layout.range.size());
  write_axes(file, layout, d);
  write_conditions(file, rows, sweep->resolved, layout, d);
  write_scalars(file, rows, layout, d);
  if (absl::Status status = write_inputs(reader, file, rows, layout, d); !status.ok())
    return status;
  if (absl::Status status = write_parts(reader, file, rows, layout, d); !status.ok()) return status;
  std::optional<Dimension> bin;
  std::size_t bins = 0;
  if (absl::Status status =
          write_spectra(reader, file, sweep->resolved, rows, layout, d, bin, bins);
      !status.ok())
    return status;
  if (absl::Status status = write_modes(reader, file, rows, layout, d, bin, bins); !status.ok())
    return status;
  return file.close();
}

}  // namespace irsig

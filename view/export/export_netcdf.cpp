#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "absl/strings/str_join.h"
#include "core/accuracy/spectral_modes.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "view/base/progress.h"
#include "view/export/export.h"
#include "view/export/netcdf_bands.h"
#include "view/export/netcdf_file.h"

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

// The cube that a sweep's rows make. A condition is a season at a time of day ("01:30:00Z"), which
// seasons share; where one season is alone, or one has several dates, at an instant: an axis of
// dates, on which readers choose by date.
struct Layout {
  Places<std::tuple<double, double, double>> viewpoint;  // at its stored range
  Places<std::string> season, time, band;
  Places<double> range;  // of moved rows; else one for all
  bool moved;
  bool dated = false;  // times are instants
  struct Cell {
    std::size_t viewpoint, season, time, band, range;
  };
  std::vector<Cell> cell;  // of each row

  static std::string clock(const std::string& time_utc) {
    return time_utc.substr(time_utc.find('T') + 1);
  }
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
    std::set<std::string> seasons;
    for (const QueryRow& r : rows) {
      const S& s = r.signature;
      seasons.insert(s.season);
      dated |= instant.try_emplace({s.season, clock(s.time_utc)}, s.time_utc).first->second !=
               s.time_utc;
    }
    dated |= seasons.size() == 1;
    std::set<std::string> times;  // in their order
    for (const QueryRow& r : rows)
      times.insert(dated ? r.signature.time_utc : clock(r.signature.time_utc));
    for (const std::string& t : times) time.place(t, rows.front().signature);
    for (const QueryRow& r : rows) {
      const S& s = r.signature;
      const double stored_m = stored_range_m(r);
      const std::tuple key(s.aspect_azimuth_deg, s.aspect_elevation_deg, stored_m);
      const std::size_t views = viewpoint.size();
      cell.push_back({viewpoint.place(key, s), season.place(s.season, s),
                      time.place(dated ? s.time_utc : clock(s.time_utc), s), band.place(s.band, s),
                      range.place(moved ? s.range_m : 0, s)});
      if (viewpoint.size() > views) viewpoint_range_m.push_back(stored_m);
    }
    time_name.assign(times.begin(), times.end());
  }
  std::vector<std::string> time_name;  // in their order
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
    {"spectral_surface_reflected_w_sr_um", &Sp::surface_reflected_w_sr_um},
    {"spectral_surface_reflected_stderr_w_sr_um", &Sp::surface_reflected_stderr_w_sr_um},
    {"spectral_interreflected_w_sr_um", &Sp::interreflected_w_sr_um},
    {"spectral_interreflected_stderr_w_sr_um", &Sp::interreflected_stderr_w_sr_um},
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
  std::string coordinates;         // of the cube, for CF: those that are no axis
  [[nodiscard]] std::vector<Dimension> cube() const {
    std::vector<Dimension> out{viewpoint, season, time, band};
    if (range) out.push_back(*range);
    return out;
  }
};

constexpr const char* kConventions = "CF-1.10";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double instant_of(const std::string& time_utc) {
  const auto t = parse_rfc3339(time_utc);
  return t.ok() ? unix_seconds(*t) : kNan;
}

// Returns true if a condition's wind is stated, which may be calm. Weather without a stated wind
// has a speed of 0, too.
bool wind_is_stated(const schema::ResolvedSweep& sweep, const schema::Condition& c) {
  if (c.weather().wind_speed_m_s() > 0) return true;
  const std::uint32_t at = c.season_index();
  if (!c.has_weather() || at >= static_cast<std::uint32_t>(sweep.sweep().season_size()))
    return false;
  const schema::Season& season = sweep.sweep().season(static_cast<int>(at));
  return season.name() == c.season() &&
         (season.has_wind_speed_m_s() || season.has_weather_file() || season.has_day());
}

// Writes the facts of each condition: its time, the sun, the weather. [season][time]
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
  if (!layout.dated)  // else an axis
    file.times({"time", "instant of the condition", ""}, plane,
               each([](const S& s) { return instant_of(s.time_utc); }));
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
  // nullopt: the sweep does not say. Zero is a value where it is said.
  const auto stated = [&](const char* name, const auto& get) {
    auto values = each([&](const S& s) {
      const schema::Condition* c = condition_of(s);
      return c == nullptr ? kNan : get(*c).value_or(kNan);
    });
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
      file.doubles({name, "", ""}, plane, values);
  };
  using C = schema::Condition;
  using Value = std::optional<double>;
  const auto said = [](bool is_said, double value) { return is_said ? Value(value) : Value(); };
  // Values that cannot be 0 (jobs/text/number_bounds.cpp): 0 stands for "not stated".
  const auto nonzero = [&](double value) { return said(value != 0, value); };
  stated("air_temperature_k", [&](const C& c) {
    return nonzero(c.weather().surface_stated() ? c.weather().air_temperature_k()
                                                : c.air_temperature_k());
  });
  // The three values at the surface are stated together.
  stated("relative_humidity_percent", [&](const C& c) {
    return said(c.weather().surface_stated() || c.weather().pressure_pa() != 0,
                c.weather().relative_humidity_percent());
  });
  stated("pressure_pa", [&](const C& c) { return nonzero(c.weather().pressure_pa()); });
  stated("wind_speed_m_s",
         [&](const C& c) { return said(wind_is_stated(sweep, c), c.weather().wind_speed_m_s()); });
  stated("visibility_m", [&](const C& c) { return nonzero(c.weather().visibility_m()); });
  stated("sea_temperature_k", [&](const C& c) {
    return said(c.surroundings().has_sea_temperature_k(), c.surroundings().sea_temperature_k());
  });
  stated("ground_temperature_k", [&](const C& c) {
    return said(c.surroundings().has_ground_temperature_k(),
                c.surroundings().ground_temperature_k());
  });
  stated("sun_irradiance_w_m2", [&](const C& c) {
    return said(sweep.sweep().transport().sun(), c.sun_irradiance_w_m2());
  });
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
  std::vector<std::string> clock;
  for (const std::string& name : layout.time_name)
    clock.push_back(layout.dated ? Layout::clock(name) : name);
  file.strings({"time_of_day", "time of day, UTC", ""}, {d.time}, clock);
  if (layout.dated) {
    std::vector<double> instant;
    for (const std::string& name : layout.time_name) instant.push_back(instant_of(name));
    file.times({"time", "instant of the condition", ""}, {d.time}, instant);
  }
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
      if (v == 0 && (kQuantityMember[q] == &S::source_radiance_temperature_k ||
                     kQuantityMember[q] == &S::apparent_temperature_k))
        continue;
      values[layout.index(layout.cell[i])] = v;
    }
    file.doubles({kQuantities[q].name.data(), "", "", d.coordinates}, d.cube(), values);
  }
  if (layout.moved) {
    std::vector<double> values(layout.size(), kNan);
    for (std::size_t i = 0; i < rows.size(); ++i)
      values[layout.index(layout.cell[i])] = rows[i].range_change->range_bound_w_sr;
    file.doubles({"range_bound_w_sr", "what moving to the range adds to the apparent error", "",
                  d.coordinates},
                 d.cube(), values);
  }
  std::vector<long long> row(layout.size(), -1), samples = row;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    row[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.row);
    samples[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.samples);
  }
  std::vector<std::string> limit(layout.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i].interpolation)
      limit[layout.index(layout.cell[i])] = rows[i].signature.limiting_bound;
  file.strings(
      {"limiting_bound",
       "largest part of the numerical error where that misses the accuracy, empty: reached", ""},
      d.cube(), limit);
  file.counts({"row", "place in the sweep, -1: not computed", ""}, d.cube(), row);
  file.counts({"samples", "primary rays of all replicates, -1: not computed", ""}, d.cube(),
              samples);
}

// Writes the contributions of uncertain inputs, as a cube for each input. Interpolated rows have
// none.
absl::Status write_inputs(StoreReader& reader, NetcdfFile& file, const std::vector<QueryRow>& rows,
                          const Layout& layout, const Dimensions& d) {
  std::vector<std::string> names;
  std::vector<std::vector<StoredInput>> inputs_of_row;
  for (const QueryRow& r : rows) {
    std::vector<StoredInput>& of_row = inputs_of_row.emplace_back();
    if (r.interpolation || (std::isnan(r.signature.input_uncertainty_w_sr) &&
                            std::isnan(r.signature.heat_model_error_w_sr)))
      continue;
    ASSIGN_OR_RETURN(of_row, reader.inputs(r.signature.signature_id));
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
                d.coordinates},
               cube, value);
  file.doubles({"input_contribution_stderr_w_sr", "", "", d.coordinates}, cube, value_stderr);
  return absl::OkStatus();
}

absl::Status write_parts(StoreReader& reader, NetcdfFile& file, const std::vector<QueryRow>& rows,
                         const Layout& layout, const Dimensions& d) {
  std::vector<std::string> names;
  std::vector<std::vector<RowPart>> parts_of_row;
  LoopProgress progress("parts read, rows", rows.size());
  for (const QueryRow& r : rows) {
    progress.step();
    ASSIGN_OR_RETURN(auto parts, parts_of(reader, r));
    for (const RowPart& p : parts) {
      if (std::find(names.begin(), names.end(), p.part.part) == names.end()) {
        names.push_back(p.part.part);
      }
    }
    parts_of_row.push_back(std::move(parts));
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
  file.doubles({"part_intensity_w_sr", "", "", d.coordinates}, cube, value);
  file.doubles({"part_intensity_stderr_w_sr", "", "", d.coordinates}, cube, value_stderr);
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
    ASSIGN_OR_RETURN(const auto first, spectrum_of(reader, rows[i]));
    axis.assign(first.spectrum.lambda_um().begin(), first.spectrum.lambda_um().end());
    bins = std::max(bins, axis.size());
  }
  if (bins == 0) return absl::OkStatus();
  bin = file.dimension("bin", bins);
  const auto bands = collected<std::string>(layout.band.first(), [](const S& s) { return s.band; });
  RETURN_IF_ERROR(write_bins(file, sweep, bands, lambda_um, d.band, *bin, bins));
  std::vector<Dimension> cube = d.cube();
  cube.push_back(*bin);
  std::vector<NetcdfFile::Variable> variable;
  for (const SpectralColumn& column : kSpectra) {
    // A name of its own where it is also that of an in-band quantity.
    const std::string name = column.name;
    const bool taken = std::any_of(kQuantities.begin(), kQuantities.end(),
                                   [&](const QuantityInfo& q) { return q.name == name; });
    variable.push_back(file.slabs(
        {taken ? "spectral_" + name : name, "", name, d.coordinates + " lambda_um"}, cube));
  }
  const std::size_t slab = layout.places() * bins;
  std::vector<std::vector<float>> values(std::size(kSpectra));
  LoopProgress progress("spectra written, viewpoints", of_viewpoint.size());
  for (std::size_t v = 0; v < of_viewpoint.size(); ++v) {
    progress.step();
    for (auto& column : values) column.assign(slab, std::numeric_limits<float>::quiet_NaN());
    for (const std::size_t i : of_viewpoint[v]) {
      const Layout::Cell& cell = layout.cell[i];
      ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, rows[i]));
      const auto& axis = got.spectrum.lambda_um();
      if (!std::equal(axis.begin(), axis.end(), lambda_um[cell.band].begin(),
                      lambda_um[cell.band].end()))
        return absl::InternalError(
            fmt::format("row {}: other wavelengths than the first row of band \"{}\"",
                        rows[i].signature.row, rows[i].signature.band));
      const std::size_t to = layout.place(cell) * bins;
      for (std::size_t c = 0; c < values.size(); ++c) {
        const auto& of_row = (got.spectrum.*kSpectra[c].values)();
        std::copy_n(of_row.begin(),
                    std::min<std::size_t>(static_cast<std::size_t>(of_row.size()), bins),
                    values[c].begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
    for (std::size_t c = 0; c < values.size(); ++c) file.put(variable[c], v, values[c]);
  }
  return absl::OkStatus();
}

// Writes the modes of rows that have them: the covariance of a spectrum's errors is the sum over
// modes of m m^T.
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
    ASSIGN_OR_RETURN(auto errors,
                     SumErrors::make({stderrs.data(), static_cast<std::size_t>(stderrs.size())},
                                     (spectrum.*column.encoded)()));
    return errors.modes();
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, rows[i]));
    for (const ModeColumn& column : kModes) {
      ASSIGN_OR_RETURN(const auto modes, modes_of(rows[i], got.spectrum, column));
      most = std::max(most, modes.size());
    }
    of_viewpoint[layout.cell[i].viewpoint].push_back(i);
  }
  if (most == 0) return absl::OkStatus();
  std::vector<Dimension> cube = d.cube();
  cube.push_back(file.dimension("mode", most));
  cube.push_back(*bin);
  std::vector<NetcdfFile::Variable> variable;
  for (const ModeColumn& column : kModes)
    variable.push_back(
        file.slabs({column.name, "", column.name, d.coordinates + " lambda_um"}, cube));
  const std::size_t of_row = most * bins;
  for (std::size_t v = 0; v < of_viewpoint.size(); ++v)
    for (std::size_t c = 0; c < std::size(kModes); ++c) {
      std::vector<float> values(layout.places() * of_row, std::numeric_limits<float>::quiet_NaN());
      for (const std::size_t i : of_viewpoint[v]) {
        ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, rows[i]));
        ASSIGN_OR_RETURN(const auto modes, modes_of(rows[i], got.spectrum, kModes[c]));
        if (modes.empty()) continue;
        const Layout::Cell& cell = layout.cell[i];
        const std::size_t to = layout.place(cell) * of_row;
        // Fewer modes than others have: the rest of them are 0.
        for (std::size_t m = 0; m < most; ++m)
          for (std::size_t k = 0; k < modes.front().size(); ++k)
            values[to + m * bins + k] = m < modes.size() ? static_cast<float>(modes[m][k]) : 0.0f;
      }
      file.put(variable[c], v, values);
    }
  return absl::OkStatus();
}

// One sweep's cube, where the file is.
absl::Status write_cube(StoreReader& reader, const std::vector<QueryRow>& rows, NetcdfFile& file) {
  const S& any = rows.front().signature;
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(any.sweep, SweepFiles::kNone));
  const Layout layout(rows);
  file.attribute("Conventions", kConventions);
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
               file.dimension(layout.dated ? "time" : "time_of_day", layout.time.size()),
               file.dimension("band", layout.band.size()),
               {},
               fmt::format("aspect_azimuth_deg aspect_elevation_deg {} {}",
                           layout.moved ? "stored_range_m" : "range_m",
                           layout.dated ? "time_of_day" : "time")};
  if (layout.moved) d.range = file.dimension("range_m", layout.range.size());
  write_axes(file, layout, d);
  write_conditions(file, rows, sweep.resolved, layout, d);
  write_scalars(file, rows, layout, d);
  RETURN_IF_ERROR(write_inputs(reader, file, rows, layout, d));
  RETURN_IF_ERROR(write_parts(reader, file, rows, layout, d));
  std::optional<Dimension> bin;
  std::size_t bins = 0;
  RETURN_IF_ERROR(write_spectra(reader, file, sweep.resolved, rows, layout, d, bin, bins));
  return write_modes(reader, file, rows, layout, d, bin, bins);
}

}  // namespace

absl::Status write_netcdf(StoreReader& reader, std::vector<QueryRow> rows,
                          const std::string& path) {
  // Rows by sweep, in the order in which the sweeps appear.
  std::vector<std::vector<QueryRow>> of_sweep;
  std::map<std::string, std::size_t> place;
  for (QueryRow& row : rows) {
    const auto [at, is_new] = place.try_emplace(row.signature.sweep, of_sweep.size());
    if (is_new) of_sweep.emplace_back();
    of_sweep[at->second].push_back(std::move(row));
  }
  rows.clear();
  rows.shrink_to_fit();
  NetcdfFile file(path);
  if (of_sweep.size() > 1) {
    file.attribute("Conventions", kConventions);
    file.attribute("title", "Infrared signatures of several sweeps, each a group");
  }
  for (const std::vector<QueryRow>& cube : of_sweep) {
    if (of_sweep.size() > 1) file.group(cube.front().signature.sweep);
    RETURN_IF_ERROR(write_cube(reader, cube, file));
  }
  return file.close();
}

}  // namespace irsig

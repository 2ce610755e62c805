#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

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

// netCDF names that every reader can take: letters, digits and underscores.
std::string plain_name(const std::string& name) {
  std::string out;
  for (char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += plain ? c : '_';
  }
  return out;
}

struct Layout {
  Places<std::tuple<double, double, double>> viewpoint;
  Places<std::pair<std::string, std::string>> condition;
  Places<std::string> band;
  struct Cell {
    std::size_t viewpoint, condition, band;
  };
  std::vector<Cell> cell;  // of each row

  explicit Layout(const std::vector<QueryRow>& rows) {
    for (const QueryRow& r : rows) {
      const S& s = r.signature;
      cell.push_back({viewpoint.place({s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m}, s),
                      condition.place({s.season, s.time_utc}, s), band.place(s.band, s)});
    }
  }
  [[nodiscard]] std::size_t index(const Cell& c) const {
    return (c.viewpoint * condition.size() + c.condition) * band.size() + c.band;
  }
  [[nodiscard]] std::size_t size() const {
    return viewpoint.size() * condition.size() * band.size();
  }
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

struct Dimensions {
  NetcdfFile::Dimension viewpoint, condition, band;
};

void write_axes(NetcdfFile& file, const Layout& layout, const Dimensions& d) {
  const auto& views = layout.viewpoint.first();
  file.doubles({"aspect_azimuth_deg",
                "azimuth of the sensor seen from the target, clockwise from the bow", ""},
               {d.viewpoint},
               collected<double>(views, [](const S& s) { return s.aspect_azimuth_deg; }));
  file.doubles({"aspect_elevation_deg", "elevation of the sensor seen from the target", ""},
               {d.viewpoint},
               collected<double>(views, [](const S& s) { return s.aspect_elevation_deg; }));
  file.doubles({"range_m", "slant range from the target's reference point to the aperture", ""},
               {d.viewpoint}, collected<double>(views, [](const S& s) { return s.range_m; }));
  const auto& conditions = layout.condition.first();
  file.strings({"season", "", ""}, {d.condition},
               collected<std::string>(conditions, [](const S& s) { return s.season; }));
  file.strings({"time_utc", "time, RFC 3339", ""}, {d.condition},
               collected<std::string>(conditions, [](const S& s) { return s.time_utc; }));
  file.doubles(
      {"sun_azimuth_deg", "azimuth of the sun seen from the target, clockwise from north", ""},
      {d.condition}, collected<double>(conditions, [](const S& s) { return s.sun_azimuth_deg; }));
  file.doubles({"sun_zenith_deg", "zenith angle of the sun seen from the target", ""},
               {d.condition},
               collected<double>(conditions, [](const S& s) { return s.sun_zenith_deg; }));
  const auto& bands = layout.band.first();
  file.strings({"band", "", ""}, {d.band},
               collected<std::string>(bands, [](const S& s) { return s.band; }));
  file.doubles({"lambda_min_um", "lower limit of the band", ""}, {d.band},
               collected<double>(bands, [](const S& s) { return s.lambda_min_um; }));
  file.doubles({"lambda_max_um", "upper limit of the band", ""}, {d.band},
               collected<double>(bands, [](const S& s) { return s.lambda_max_um; }));
}

constexpr const char* kCoordinates =
    "aspect_azimuth_deg aspect_elevation_deg range_m season time_utc";

void write_scalars(NetcdfFile& file, const std::vector<QueryRow>& rows, const Layout& layout,
                   const Dimensions& d) {
  const std::vector<NetcdfFile::Dimension> cube{d.viewpoint, d.condition, d.band};
  for (std::size_t q = 0; q < kQuantities.size(); ++q) {
    std::vector<double> values(layout.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double v = rows[i].signature.*kQuantityMember[q];
      // 0 K stands for "no projected area": there is no such temperature.
      if (kQuantityMember[q] == &S::apparent_temperature_k && v == 0) continue;
      values[layout.index(layout.cell[i])] = v;
    }
    file.doubles({kQuantities[q].name.data(), "", "", kCoordinates}, cube, values);
  }
  std::vector<long long> row(layout.size(), -1), samples = row;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    row[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.row);
    samples[layout.index(layout.cell[i])] = static_cast<long long>(rows[i].signature.samples);
  }
  file.counts({"row", "place in the sweep, -1: not computed", ""}, cube, row);
  file.counts({"samples", "primary rays of all replicates, -1: not computed", ""}, cube, samples);
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
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> value(layout.size() * names.size(), nan), value_stderr = value;
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
  const std::vector<NetcdfFile::Dimension> cube{d.viewpoint, d.condition, d.band, part};
  file.doubles({"part_intensity_w_sr", "", "", kCoordinates}, cube, value);
  file.doubles({"part_intensity_stderr_w_sr", "", "", kCoordinates}, cube, value_stderr);
  return absl::OkStatus();
}

// One band: its wavelength axis and a (viewpoint, condition, lambda) cube for each spectral
// quantity.
absl::Status write_band_spectra(StoreReader& reader, NetcdfFile& file,
                                const std::vector<QueryRow>& rows, const Layout& layout,
                                const Dimensions& d, std::size_t band) {
  const std::string band_name = layout.band.first()[band]->band;
  std::string suffix = plain_name(band_name);
  for (std::size_t other = 0; other < band; ++other) {
    if (plain_name(layout.band.first()[other]->band) == suffix) suffix += fmt::format("_{}", band);
  }
  std::vector<double> lambda_um;
  std::vector<std::vector<float>> cubes(std::size(kSpectra));
  LoopProgress progress(fmt::format("spectra of {} read, rows", band_name), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    progress.step();
    if (layout.cell[i].band != band) continue;
    auto got = spectrum_of(reader, rows[i]);
    if (!got.ok()) return got.status();
    const Sp& spectrum = got->spectrum;
    const std::vector<double> axis(spectrum.lambda_um().begin(), spectrum.lambda_um().end());
    if (lambda_um.empty()) {
      lambda_um = axis;
      for (auto& cube : cubes) {
        cube.assign(layout.viewpoint.size() * layout.condition.size() * axis.size(),
                    std::numeric_limits<float>::quiet_NaN());
      }
    } else if (axis != lambda_um) {
      return absl::InternalError(
          fmt::format("row {}: other wavelengths than the first row of band \"{}\"",
                      rows[i].signature.row, band_name));
    }
    const std::size_t to =
        (layout.cell[i].viewpoint * layout.condition.size() + layout.cell[i].condition) *
        lambda_um.size();
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      const auto& values = (spectrum.*kSpectra[c].values)();
      std::copy_n(values.begin(), std::min<std::ptrdiff_t>(values.size(), std::ssize(lambda_um)),
                  cubes[c].begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  if (lambda_um.empty()) return absl::OkStatus();
  const std::string axis_name = "lambda_um_" + suffix;
  const auto lambda = file.dimension(axis_name, lambda_um.size());
  file.doubles({axis_name, fmt::format("wavelength in vacuum, band {}", band_name), "lambda_um"},
               {lambda}, lambda_um);
  for (std::size_t c = 0; c < cubes.size(); ++c) {
    const std::string name = kSpectra[c].name;
    file.floats({name + "_" + suffix, "", name, kCoordinates}, {d.viewpoint, d.condition, lambda},
                cubes[c]);
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status write_netcdf(StoreReader& reader, const std::vector<QueryRow>& rows,
                          const std::string& path) {
  const Layout layout(rows);
  const S& any = rows.front().signature;
  NetcdfFile file(path);
  file.attribute("Conventions", "CF-1.10");
  file.attribute("title", "Infrared signatures of sweep " + any.sweep);
  file.attribute("source", fmt::format("irsig build {}, physics version {}", any.build_id,
                                       any.physics_version));
  file.attribute("determinism_class", any.determinism_class);
  file.attribute("comment",
                 "Intensities are at the target unless a name starts with apparent or contrast (at "
                 "the sensor's "
                 "aperture; contrast is the target less its background). Standard errors, "
                 "numerical errors and "
                 "model errors are one sigma. NaN: not computed.");
  Dimensions d{};
  d.viewpoint = file.dimension("viewpoint", layout.viewpoint.size());
  d.condition = file.dimension("condition", layout.condition.size());
  d.band = file.dimension("band", layout.band.size());
  write_axes(file, layout, d);
  write_scalars(file, rows, layout, d);
  if (absl::Status status = write_parts(reader, file, rows, layout, d); !status.ok()) return status;
  for (std::size_t band = 0; band < layout.band.size(); ++band) {
    if (absl::Status status = write_band_spectra(reader, file, rows, layout, d, band);
        !status.ok()) {
      return status;
    }
  }
  return file.close();
}

}  // namespace irsig

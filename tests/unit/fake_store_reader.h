#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"
#include "schema/store/store.h"

namespace irsig {

inline double relative_error(const StoredSignature& s, SignatureQuantity of) {
  switch (of) {
    case SignatureQuantity::kIntensity:
      return s.numerical_error_w_sr / std::abs(s.intensity_w_sr);
    case SignatureQuantity::kApparentIntensity:
      return s.apparent_numerical_error_w_sr / std::abs(s.apparent_intensity_w_sr);
    case SignatureQuantity::kContrastIntensity:
      return s.contrast_numerical_error_w_sr / std::abs(s.contrast_intensity_w_sr);
    case SignatureQuantity::kBackgroundRadiance:
      return s.background_radiance_stderr_w_m2_sr / std::abs(s.background_radiance_w_m2_sr);
  }
  return NAN;
}

// A database in memory: signatures given by the test, filtered as store.h promises.
class FakeStoreReader : public StoreReader {
 public:
  std::vector<StoredSignature> signatures;
  std::map<std::int64_t, schema::Spectrum> spectra;
  std::map<std::int64_t, std::vector<StoredPart>> stored_parts;
  std::map<std::int64_t, std::vector<StoredInput>> input;
  std::map<std::int64_t, StoredLedger> ledgers;
  std::map<std::int64_t, schema::Thumbnail> thumbnails;
  std::map<std::string, StoredSweep> sweeps;
  std::vector<StoredTemperature> temperatures;

  absl::StatusOr<std::vector<StoredTemperature>> computed_temperatures(
      const TemperatureFilter& f) override {
    std::vector<StoredTemperature> out;
    for (const StoredTemperature& t : temperatures)
      if ((f.sweep.empty() || f.sweep == t.sweep) && (f.season.empty() || f.season == t.season) &&
          (f.time_utc.empty() || f.time_utc == t.time_utc))
        out.push_back(t);
    return out;
  }
  absl::StatusOr<std::vector<StoredHeatJob>> heat_jobs(const std::string& /*sweep*/) override {
    return std::vector<StoredHeatJob>();
  }

  absl::StatusOr<std::vector<StoredSignature>> find(const SignatureFilter& f) override {
    std::vector<StoredSignature> out;
    for (const auto& s : signatures) {
      const bool match =
          (f.sweep.empty() || f.sweep == s.sweep) && (f.season.empty() || f.season == s.season) &&
          (f.time_utc.empty() || f.time_utc == s.time_utc) &&
          (f.band.empty() || f.band == s.band) && (!f.row || *f.row == s.row) &&
          (!f.range_m || *f.range_m == s.range_m) &&
          (!f.max_relative_error || relative_error(s, f.error_of) <= *f.max_relative_error);
      if (match) out.push_back(s);
    }
    if (!f.direction) return out;
    const Vec<Body> where =
        body_from_aspect(f.direction->aspect_azimuth_deg, f.direction->aspect_elevation_deg);
    const auto angle_deg = [&](const StoredSignature& s) {
      const double c = where.x * s.unit_x + where.y * s.unit_y + where.z * s.unit_z;
      return std::acos(std::clamp(c, -1.0, 1.0)) * 180 / std::numbers::pi;
    };
    std::stable_sort(out.begin(), out.end(),
                     [&](const auto& a, const auto& b) { return angle_deg(a) < angle_deg(b); });
    if (f.within_deg) {
      std::erase_if(out, [&](const auto& s) { return angle_deg(s) > *f.within_deg; });
    }
    if (f.nearest > 0) {
      std::vector<std::pair<double, double>> seen;
      std::erase_if(out, [&](const auto& s) {
        const std::pair<double, double> at{s.aspect_azimuth_deg, s.aspect_elevation_deg};
        if (std::find(seen.begin(), seen.end(), at) == seen.end()) seen.push_back(at);
        return static_cast<std::size_t>(std::find(seen.begin(), seen.end(), at) - seen.begin()) >=
               f.nearest;
      });
    }
    return out;
  }
  // Places in the list, from 1 on: a test may give one id to several signatures.
  absl::StatusOr<std::vector<std::int64_t>> find_ids(const SignatureFilter& f) override {
    const auto found = find(f);
    std::vector<std::int64_t> out;
    std::vector<bool> taken(signatures.size());
    for (const StoredSignature& s : *found) {
      std::size_t i = 0;
      const auto same = [&](const StoredSignature& other) {
        return other.signature_id == s.signature_id && other.sweep == s.sweep && other.row == s.row;
      };
      while (taken[i] || !same(signatures[i])) ++i;
      taken[i] = true;
      out.push_back(static_cast<std::int64_t>(i) + 1);
    }
    return out;
  }
  absl::StatusOr<std::vector<StoredSignature>> read(std::span<const std::int64_t> ids) override {
    std::vector<StoredSignature> out;
    for (const std::int64_t id : ids)
      out.push_back(signatures.at(static_cast<std::size_t>(id) - 1));
    return out;
  }
  absl::StatusOr<std::vector<SweepContents>> contents() override {
    std::vector<SweepContents> out;
    std::map<std::string, std::size_t> place;
    const auto add = [](auto& list, const auto& value, const auto& same) {
      if (std::none_of(list.begin(), list.end(), same)) list.push_back(value);
    };
    for (const StoredSignature& s : signatures) {
      const auto [at, fresh] = place.try_emplace(s.sweep, out.size());
      if (fresh) out.emplace_back().name = s.sweep;
      SweepContents& sweep = out[at->second];
      ++sweep.rows;
      sweep.whole_rows = std::max(sweep.whole_rows, s.row);
      add(sweep.condition, SweepContents::Condition{s.season, s.time_utc},
          [&](const auto& c) { return c.season == s.season && c.time_utc == s.time_utc; });
      add(sweep.band, SweepContents::Band{s.band, s.lambda_min_um, s.lambda_max_um},
          [&](const auto& b) { return b.name == s.band; });
      add(sweep.range_m, s.range_m, [&](double r) { return r == s.range_m; });
    }
    return out;
  }
  absl::StatusOr<std::vector<StoredValue>> values(const ValueFilter&) override {
    return std::vector<StoredValue>();
  }
  absl::StatusOr<schema::Spectrum> spectrum(std::int64_t id) override { return spectra.at(id); }
  absl::StatusOr<StoredSweep> sweep(const std::string& name, SweepFiles /*files*/) override {
    if (!sweeps.contains(name)) return absl::NotFoundError("no sweep " + name);
    return sweeps.at(name);
  }
  absl::StatusOr<std::vector<StoredPart>> parts(std::int64_t id) override {
    return stored_parts.at(id);
  }
  absl::StatusOr<std::vector<StoredInput>> inputs(std::int64_t id) override {
    return input.contains(id) ? input.at(id) : std::vector<StoredInput>();
  }
  absl::StatusOr<StoredLedger> ledger(std::int64_t id) override {
    return ledgers.contains(id) ? ledgers.at(id) : StoredLedger{};
  }
  absl::StatusOr<std::optional<schema::Thumbnail>> thumbnail(std::int64_t id) override {
    if (!thumbnails.contains(id)) return std::nullopt;
    return thumbnails.at(id);
  }
  absl::StatusOr<std::vector<StoredProfileRow>> profiles(const ProfileFilter&) override {
    return std::vector<StoredProfileRow>();
  }
  absl::StatusOr<std::vector<StoredPublished>> published(const std::string&) override {
    return std::vector<StoredPublished>();
  }
  absl::StatusOr<std::vector<SweepProgress>> progress() override {
    return std::vector<SweepProgress>();
  }
  absl::StatusOr<std::optional<StoredPrediction>> prediction(const std::string&) override {
    return std::nullopt;
  }
  absl::StatusOr<std::vector<StoredJobCost>> job_costs(const std::string&) override {
    return std::vector<StoredJobCost>();
  }
  absl::StatusOr<StoredOutcome> outcome(const std::string&) override { return StoredOutcome(); }
  absl::StatusOr<std::map<std::string, std::uint64_t>> rows_of_jobs(const std::string&) override {
    return std::map<std::string, std::uint64_t>();
  }
  absl::StatusOr<std::uint64_t> bytes() override { return std::uint64_t{0}; }
  absl::StatusOr<std::string> digest() override { return std::string("fake"); }
};

struct FakeSeason {
  std::string name, time_utc;
  double factor;
};

struct FakeSweep {
  std::vector<Viewpoint> viewpoint = fibonacci_viewpoints(191, 5000, 0, 90);
  std::vector<FakeSeason> season = {{"winter", "2025-12-21T01:30:00Z", 1},
                                    {"spring", "2025-03-20T01:30:00Z", 1.2},
                                    {"summer", "2025-06-21T01:30:00Z", 1.45}};
  double relative_stderr = 1e-3;
};

// In-band intensity of a box-like ship of 154 x 20 x 12 m: smooth but for the kinks of its
// silhouette at the bow, the beam and the zenith, with a hot funnel that stands out towards
// starboard.
inline double box_ship_w_sr(Vec<Body> d) {
  const double area = 154 * 12 * std::abs(d.y) + 20 * 12 * std::abs(d.x) + 154 * 20 * std::abs(d.z);
  const double funnel = 16 * std::exp(-3 * (1 - (0.3 * d.x + 0.9 * d.y - 0.3 * d.z)));
  return 40 * area * (1 + 0.1 * d.x) + 2000 * funnel;
}

// Rows in the order of the store: viewpoint, condition, band; two bands ("mwir" a quarter of
// "lwir").
inline FakeStoreReader fake_database(const FakeSweep& sweep = {}) {
  FakeStoreReader out;
  schema::ResolvedSweep& stored = out.sweeps["box ship"].resolved;
  for (const bool lwir : {false, true}) {
    schema::Band& band = *stored.mutable_sweep()->add_band();
    band.set_name(lwir ? "lwir" : "mwir");
    band.set_lambda_min_um(lwir ? 8 : 3);
    band.set_lambda_max_um(lwir ? 12 : 5);
    band.set_step_um(0.5);
  }
  for (const FakeSeason& season : sweep.season) {
    schema::Condition& condition = *stored.add_condition();
    condition.set_season(season.name);
    condition.set_time_utc(season.time_utc);
    condition.set_air_temperature_k(season.name == "summer" ? 301.5 : 280.5);
    if (season.name == "summer")
      for (const char* warning : {"odd", "odder"}) condition.add_warning(warning);
  }
  std::uint64_t row = 0;
  for (const Viewpoint& v : sweep.viewpoint) {
    const Vec<Body> d = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    for (const FakeSeason& season : sweep.season) {
      for (const bool lwir : {false, true}) {
        StoredSignature s{};
        s.row = ++row;
        s.signature_id = static_cast<std::int64_t>(1000 + row);
        s.sweep = "box ship";
        s.season = season.name;
        s.time_utc = season.time_utc;
        s.band = lwir ? "lwir" : "mwir";
        s.lambda_min_um = lwir ? 8 : 3;
        s.lambda_max_um = lwir ? 12 : 5;
        s.aspect_azimuth_deg = v.aspect_azimuth_deg;
        s.aspect_elevation_deg = v.aspect_elevation_deg;
        s.range_m = v.range_m;
        s.unit_x = d.x;
        s.unit_y = d.y;
        s.unit_z = d.z;
        s.sun_azimuth_deg = 150.5;
        s.sun_zenith_deg = 55.1;
        s.intensity_w_sr = box_ship_w_sr(d) * season.factor * (lwir ? 1 : 0.25);
        s.intensity_stderr_w_sr = sweep.relative_stderr * s.intensity_w_sr;
        s.numerical_error_w_sr = 1.25 * s.intensity_stderr_w_sr;
        s.apparent_intensity_w_sr = 0.9 * s.intensity_w_sr;
        s.apparent_intensity_stderr_w_sr = 0.9 * s.intensity_stderr_w_sr;
        s.apparent_numerical_error_w_sr = 0.9 * s.numerical_error_w_sr;
        // Brighter than what is behind it towards the stern, darker towards the bow.
        s.contrast_intensity_w_sr = -0.2 * d.x * s.intensity_w_sr;
        s.contrast_intensity_stderr_w_sr = 0.9 * s.intensity_stderr_w_sr;
        s.contrast_numerical_error_w_sr = 0.9 * s.numerical_error_w_sr;
        s.background_radiance_w_m2_sr =
            40 * (s.apparent_intensity_w_sr - s.contrast_intensity_w_sr) / s.intensity_w_sr;
        s.path_transmittance = 0.8;
        s.projected_area_m2 = s.intensity_w_sr / 40;
        s.projected_area_stderr_m2 = 1e-4 * s.projected_area_m2;
        s.apparent_temperature_k = 300 * std::sqrt(std::sqrt(season.factor));
        s.emitted_w_sr = 0.75 * s.intensity_w_sr;
        s.sun_reflected_w_sr = 0.25 * s.intensity_w_sr;
        s.stop_reason = "ACCURACY_REACHED";
        s.samples = 65536;
        s.replicates = 32;
        s.build_id = "test";
        s.physics_version = 1;

        schema::Spectrum& spectrum = out.spectra[s.signature_id];
        const double step = 0.5, width = s.lambda_max_um - s.lambda_min_um;
        for (double l = s.lambda_min_um; l < s.lambda_max_um + 1e-9; l += step) {
          // Its trapezoid integral over the band is the in-band intensity: 1 + a linear term of
          // mean 0.
          const double shape = 1 + 0.5 * (l - (s.lambda_min_um + 0.5 * width)) / width;
          const auto value = static_cast<float>(s.intensity_w_sr / width * shape);
          spectrum.add_lambda_um(l);
          for (auto add : {&schema::Spectrum::add_spectral_intensity_w_sr_um,
                           &schema::Spectrum::add_apparent_spectral_intensity_w_sr_um}) {
            (spectrum.*add)(value);
          }
          spectrum.add_spectral_intensity_stderr_w_sr_um(0.002F * value);
          spectrum.add_apparent_spectral_intensity_stderr_w_sr_um(0.002F * value);
          spectrum.add_contrast_spectral_intensity_w_sr_um(static_cast<float>(-0.2 * d.x) * value);
          spectrum.add_contrast_spectral_intensity_stderr_w_sr_um(0.002F * value);
          spectrum.add_background_radiance_w_m2_sr_um(10);
          spectrum.add_background_radiance_stderr_w_m2_sr_um(0);
          spectrum.add_path_transmittance(0.8F);
          spectrum.add_path_radiance_w_m2_sr_um(1);
          spectrum.add_emitted_w_sr_um(0.75F * value);
          spectrum.add_emitted_stderr_w_sr_um(0.0015F * value);
          spectrum.add_sun_reflected_w_sr_um(0.25F * value);
          spectrum.add_sun_reflected_stderr_w_sr_um(0.0005F * value);
          for (auto add : {&schema::Spectrum::add_sky_reflected_w_sr_um,
                           &schema::Spectrum::add_sky_reflected_stderr_w_sr_um,
                           &schema::Spectrum::add_surface_reflected_w_sr_um,
                           &schema::Spectrum::add_surface_reflected_stderr_w_sr_um,
                           &schema::Spectrum::add_interreflected_w_sr_um,
                           &schema::Spectrum::add_interreflected_stderr_w_sr_um}) {
            (spectrum.*add)(0.0F);
          }
        }
        out.stored_parts[s.signature_id] = {
            {"hull", 0.7 * s.intensity_w_sr, 0.7 * s.intensity_stderr_w_sr},
            {"funnel", 0.3 * s.intensity_w_sr, 0.3 * s.intensity_stderr_w_sr}};
        out.signatures.push_back(std::move(s));
      }
    }
  }
  return out;
}

}  // namespace irsig

#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/geo/frames.h"
#include "core/geo/viewpoint.h"
#include "schema/store/reader.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/spectrum_blob.h"
#include "schema/store/tables/statements.h"
#include "tests/fault/synthetic_pictures.h"

namespace irsig {

// Signatures that a test gives, and what belongs to them by their id. Whoever takes a reader gets
// one of a database in memory that holds what the test has given until then. Its tables are those
// of the format but for what they demand: a test may leave out, or repeat, what a file never does.
class FakeDatabase {
 public:
  std::vector<StoredSignature> signatures;
  std::map<std::int64_t, schema::Spectrum> spectra;
  std::map<std::int64_t, schema::Clutter> clutters;
  std::map<std::int64_t, std::vector<StoredPart>> stored_parts;
  std::map<std::int64_t, std::vector<StoredInput>> input;
  std::map<std::int64_t, StoredLedger> ledgers;
  std::map<std::int64_t, schema::Thumbnail> thumbnails;
  std::map<std::int64_t, std::vector<schema::ImageLayer>> image_layers;
  std::map<std::int64_t, StoredSilhouette> silhouettes;
  std::map<std::string, StoredSweep> sweeps;
  std::vector<StoredTemperature> temperatures;

  [[nodiscard]] StoreReader& reader() const {
    return *readers_.emplace_back(std::make_shared<StoreReader>(Filled(*this).take()));
  }
  // NOLINTNEXTLINE(google-explicit-constructor): a test names its database, not a reader of it
  operator StoreReader&() const { return reader(); }

 private:
  // Fills a database.
  class Filled {
   public:
    explicit Filled(const FakeDatabase& given) : given_(given) {
      must(database_->script(absl::StrReplaceAll(
          sql::create, {{"IS NOT NULL", "IS NOT NULL"},  // a condition
                        {" NOT NULL", ""},
                        {"CREATE UNIQUE INDEX", "CREATE INDEX"},
                        {"  UNIQUE (sweep_id, viewpoint_index),\n", ""},
                        {"  UNIQUE (sweep_id, job_key),\n", ""},
                        {"  UNIQUE (condition_id, band_id, viewpoint_id)\n", "  CHECK (1)\n"}})));
      must(database_->script("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON"));
      must(database_->script("BEGIN"));
      for (const auto& [name, sweep] : given.sweeps) add_sweep(name);
      for (const StoredSignature& s : given.signatures) add_sweep(s.sweep).see(s);
      for (const StoredTemperature& t : given.temperatures) add_sweep(t.sweep);
      for (const auto& [name, places] : sweep_)
        must(database_->run(
            "INSERT INTO sweep (sweep_id, name, sweep_sha256, viewpoints, conditions, bands, "
            "model_sha256, resolved_sweep) VALUES (?1, ?2, ?2, ?3, ?4, ?5, '', ?6)",
            places.id, name, places.views(), places.times(), places.bands(),
            Blob{given.sweeps.contains(name) ? given.sweeps.at(name).resolved.SerializeAsString()
                                             : std::string()}));
      std::int64_t last = 0;
      for (const StoredSignature& s : given.signatures) last = std::max(last, s.signature_id);
      std::map<std::int64_t, bool> taken;
      for (const StoredSignature& s : given.signatures)
        add(s, taken.try_emplace(s.signature_id).second ? s.signature_id : ++last);
      for (const StoredTemperature& t : given.temperatures) add(t);
      must(database_->script("COMMIT"));
    }
    [[nodiscard]] std::unique_ptr<Database> take() { return std::move(database_); }

   private:
    // The lists of a sweep; the number of a row is its place in them.
    struct Places {
      std::int64_t id = 0;
      std::map<std::pair<std::string, std::string>, int> time;
      std::map<std::string, int> band;
      std::uint64_t last_row = 1;

      void see(const StoredSignature& s) {
        time.try_emplace({s.season, s.time_utc});
        band.try_emplace(s.band);
        last_row = std::max(last_row, s.row);
      }
      [[nodiscard]] std::uint64_t times() const { return std::max<std::size_t>(1, time.size()); }
      [[nodiscard]] std::uint64_t bands() const { return std::max<std::size_t>(1, band.size()); }
      [[nodiscard]] std::uint64_t views() const { return (last_row - 1) / (times() * bands()) + 1; }
    };

    static void must(const absl::Status& status) {
      if (!status.ok()) throw std::logic_error(std::string(status.message()));
    }
    Places& add_sweep(const std::string& name) {
      Places& places = sweep_[name];
      if (places.id == 0) places.id = static_cast<std::int64_t>(sweep_.size());
      return places;
    }
    static std::optional<double> known(double value) {
      return std::isnan(value) ? std::nullopt : std::optional(value);
    }
    template <typename... Values>
    std::int64_t insert(const char* sql, const Values&... values) {
      must(database_->run(sql, values...));
      return database_->last_insert_rowid();
    }
    // The id of what `key` names, made by `make` where it is new.
    template <typename Make>
    std::int64_t once(const std::string& key, const Make& make) {
      const auto [at, fresh] = id_.try_emplace(key);
      if (fresh) at->second = make();
      return at->second;
    }
    std::int64_t part(const std::string& name) {
      return once("part " + name, [&] {
        return insert("INSERT INTO part (part_index, name, material) VALUES (?1, ?2, '')",
                      id_.size(), name);
      });
    }

    void add(const StoredSignature& s, std::int64_t id) {
      const Places& places = sweep_.at(s.sweep);
      const std::uint64_t row = s.row - 1, times = places.times(), bands = places.bands();
      const auto spectrum = given_.spectra.find(s.signature_id);
      const std::string lambda =
          spectrum == given_.spectra.end() ? "" : wavelength_blob(spectrum->second);
      const std::int64_t viewpoint =
          once(absl::StrCat(s.sweep, " v ", s.aspect_azimuth_deg, " ", s.aspect_elevation_deg, " ",
                            s.range_m),
               [&] {
                 const std::int64_t made = insert(
                     "INSERT INTO viewpoint (sweep_id, viewpoint_index, aspect_azimuth_deg, "
                     "aspect_elevation_deg, range_m) VALUES (?1, ?2, ?3, ?4, ?5)",
                     places.id, row / (times * bands), s.aspect_azimuth_deg, s.aspect_elevation_deg,
                     s.range_m);
                 const Vec<Body> d = body_from_aspect(s.aspect_azimuth_deg, s.aspect_elevation_deg);
                 must(database_->run(sql::insert_viewpoint_direction, made, d.x, d.y, d.z));
                 return made;
               });
      const std::int64_t condition =
          once(absl::StrCat(s.sweep, " c ", s.season, " ", s.time_utc, " ", row / bands % times,
                            " ", s.warning),
               [&] {
                 return insert(
                     "INSERT INTO condition (sweep_id, condition_index, season, time_utc, warning) "
                     "VALUES (?1, ?2, ?3, ?4, ?5)",
                     places.id, row / bands % times, s.season, s.time_utc, s.warning);
               });
      const std::int64_t band = once(
          absl::StrCat(s.sweep, " b ", s.band, " ", row % bands, " ", s.lambda_min_um, " ",
                       s.lambda_max_um, " ", lambda),
          [&] {
            return insert(
                "INSERT INTO band (sweep_id, band_index, name, lambda_min_um, lambda_max_um, "
                "lambda_um) VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                places.id, row % bands, s.band, s.lambda_min_um, s.lambda_max_um, Blob{lambda});
          });
      const std::int64_t stop = once("stop " + s.stop_reason, [&] {
        must(database_->run("INSERT OR IGNORE INTO stop_reason (name) VALUES (?1)", s.stop_reason));
        return database_
            ->integer("SELECT stop_reason FROM stop_reason WHERE name = ?1", s.stop_reason)
            .value();
      });
      const std::int64_t job = insert(
          "INSERT INTO job (sweep_id, job_index, superseded, job_key, kind, viewpoint_id, state) "
          "VALUES (?1, ?2, ?3, ?4, 1, ?5, 2)",
          places.id, row, s.superseded, s.job_key, viewpoint);
      must(database_->run(sql::insert_provenance, job, s.seed_hex, s.physics_version,
                          s.determinism_class, s.build_id, "", s.samples, s.replicates,
                          s.target_paths, s.rays, s.seconds, s.guarded_backface_hits,
                          s.guarded_nonfinite, s.truncated_paths, 0.0, s.guarded_negative, ""));
      must(database_->run(
          "INSERT INTO signature (signature_id, job_id, viewpoint_id, condition_id, band_id, "
          "sun_azimuth_deg, sun_zenith_deg, stop_reason, energy_gain, reflections, limiting_bound) "
          "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, nullif(?11, ''))",
          id, job, viewpoint, condition, band, s.sun_azimuth_deg, s.sun_zenith_deg, stop,
          s.energy_gain, s.reflections, s.limiting_bound));
      const auto values = [&]<std::size_t... Q>(std::index_sequence<Q...>) {
        static const std::string update = [] {
          std::string text = "UPDATE signature SET ";
          for (const QuantityInfo& quantity : kQuantities)
            absl::StrAppend(&text, std::string(quantity.name), " = ?, ");
          return text + "job_id = job_id WHERE signature_id = ?";
        }();
        return database_->run(update.c_str(), known(s.*kQuantityMember[Q])..., id);
      };
      must(values(std::make_index_sequence<kQuantities.size()>()));
      if (spectrum != given_.spectra.end()) add(spectrum->second, id);
      add_what_belongs(s.signature_id, id);
    }

    void add(const schema::Spectrum& spectrum, std::int64_t id) {
      const SpectrumBlobs blobs(spectrum);
      const auto run = [&]<std::size_t... Array>(std::index_sequence<Array...>) {
        return database_->run(sql::insert_spectrum, id, Blob{blobs[Array]}...);
      };
      must(run(std::make_index_sequence<kSpectrumArrays>()));
      if (!spectrum.spectral_intensity_modes().empty())
        must(database_->run(sql::insert_spectral_modes, id,
                            Blob{spectrum.spectral_intensity_modes()},
                            Blob{spectrum.apparent_spectral_intensity_modes()},
                            Blob{spectrum.contrast_spectral_intensity_modes()}));
    }

    // given: the signature's id in the test; id: in the database.
    void add_what_belongs(std::int64_t given, std::int64_t id) {
      if (const auto at = given_.stored_parts.find(given); at != given_.stored_parts.end())
        for (const StoredPart& p : at->second)
          must(database_->run(sql::insert_part_intensity, id, part(p.part), p.intensity_w_sr,
                              p.intensity_stderr_w_sr));
      if (const auto at = given_.clutters.find(given); at != given_.clutters.end()) {
        must(database_->run(sql::insert_clutter, id,
                            Blob{float_blob(at->second.patch_sigma_w_m2_sr_um())},
                            Blob{at->second.modes()}));
        for (int m = 0; m < at->second.material_fraction_size(); ++m)
          must(
              database_->run(sql::insert_clutter_material, id, m, at->second.material_fraction(m)));
      }
      if (const auto at = given_.input.find(given); at != given_.input.end())
        for (std::size_t i = 0; i < at->second.size(); ++i) {
          const auto& [name, source, apparent, contrast] = at->second[i];
          must(database_->run(sql::insert_input_contribution, id, i, name, source.contribution_w_sr,
                              source.stderr_w_sr, apparent.contribution_w_sr, apparent.stderr_w_sr,
                              contrast.contribution_w_sr, contrast.stderr_w_sr,
                              known(source.curvature_w_sr), known(apparent.curvature_w_sr),
                              known(contrast.curvature_w_sr)));
        }
      if (const auto at = given_.ledgers.find(given); at != given_.ledgers.end()) {
        for (const StoredEffect& e : at->second.effect)
          must(database_->run(
              "INSERT INTO ledger SELECT ?1, effect, state, reason, ?5, ?6, ?7, ?8, ?9 FROM effect "
              "e, effect_state s, effect_reason r WHERE e.name = ?2 AND s.name = ?3 AND r.name = "
              "?4",
              id, e.effect, e.state, e.reason, known(e.bound_w_sr), known(e.apparent_bound_w_sr),
              known(e.contrast_bound_w_sr), known(e.fraction_w_sr), known(e.time_s)));
        if (const auto& e = at->second.energy)
          must(database_->run(sql::insert_energy, id, e->absorbed, e->absorbed_stderr,
                              e->escaped_to_sky, e->escaped_to_sky_stderr, e->escaped_to_surface,
                              e->escaped_to_surface_stderr, e->cut_off, e->cut_off_stderr,
                              e->balance, e->balance_stderr));
      }
      if (const auto at = given_.thumbnails.find(given); at != given_.thumbnails.end())
        must(database_->run(
            sql::insert_thumbnail, id, at->second.width_px(), at->second.height_px(),
            at->second.pixel_rad(), at->second.error_relative(), at->second.error_k(),
            Blob{at->second.png()}, Blob{at->second.exr()}, Blob{at->second.stderr_exr()}));
      if (const auto at = given_.image_layers.find(given); at != given_.image_layers.end())
        for (const schema::ImageLayer& layer : at->second)
          must(database_->run(sql::insert_image_layer, id, layer.name(), Blob{layer.exr()},
                              Blob{layer.stderr_exr()}));
      if (const auto at = given_.silhouettes.find(given); at != given_.silhouettes.end())
        add(at->second,
            *database_->integer("SELECT job_id FROM signature WHERE signature_id = ?1", id));
    }

    void add(const StoredSilhouette& silhouette, std::int64_t job) {
      must(database_->run(sql::insert_silhouette, job, silhouette.width_px, silhouette.height_px,
                          silhouette.pixel_samples));
      for (const StoredSilhouette::Part& p : silhouette.part) {
        std::vector<std::uint16_t> counts(std::size_t{silhouette.width_px} * silhouette.height_px,
                                          0);
        for (const StoredSilhouette::Pixel& pixel : p.pixel) counts[pixel.at] = pixel.samples;
        must(database_->run(sql::insert_part_pixels, job, part(p.name), 0, 0, silhouette.width_px,
                            silhouette.height_px, Blob{packed_counts(counts)}));
      }
    }

    void add(const StoredTemperature& t) {
      const std::int64_t job = insert(
          "INSERT INTO job (sweep_id, job_index, superseded, job_key, kind, state) "
          "VALUES (?1, 0, ?2, ?3, 2, 2)",
          sweep_.at(t.sweep).id, t.superseded, t.job_key);
      // No condition belongs to this heat run: the job states the season and the time itself.
      must(database_->run("INSERT INTO heat_job (job_id, heat_index, season) VALUES (?1, ?1, ?2)",
                          job, t.season));
      must(database_->run(sql::insert_computed_temperature, job, 0, t.time_utc, part(t.part),
                          t.mean_k, t.coldest_k, t.hottest_k, t.error_k));
    }

    const FakeDatabase& given_;
    std::unique_ptr<Database> database_ =
        Database::open(":memory:", Database::Mode::kReadWriteCreate).value();
    std::map<std::string, Places> sweep_;
    std::map<std::string, std::int64_t> id_;
  };

  mutable std::vector<std::shared_ptr<StoreReader>> readers_;
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
inline FakeDatabase fake_database(const FakeSweep& sweep = {}) {
  FakeDatabase out;
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
        s.source_radiance_temperature_k = 300 * std::sqrt(std::sqrt(season.factor));
        s.apparent_temperature_k = 0.99 * s.source_radiance_temperature_k;
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

#include "jobs/keys/expand.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/effects/effects.h"
#include "schema/heat_run.h"
#include "schema/image_size.h"
#include "schema/shard.h"

namespace irsig {
namespace {

// A contiguous piece of an axis of the sweep.
struct Span {
  std::uint32_t begin, end;
};

// The part of a sweep's conditions and bands that one job computes.
struct Piece {
  Span times, seasons, bands;
};

std::uint32_t size_of(Span span) { return span.end - span.begin; }

// The i-th of `count` pieces of the span, whose lengths differ by at most one.
Span cut(Span span, std::uint64_t i, std::uint32_t count) {
  const std::uint64_t size = size_of(span);
  return {static_cast<std::uint32_t>(span.begin + size * i / count),
          static_cast<std::uint32_t>(span.begin + size * (i + 1) / count)};
}

double estimated_paths(const schema::Accuracy& accuracy) {
  const double replicates = accuracy.replicates();
  if (accuracy.has_target_paths()) return accuracy.target_paths();
  if (accuracy.has_samples_per_replicate()) {
    return replicates * static_cast<double>(accuracy.samples_per_replicate());
  }
  // A prototype's Owen-scrambled Sobol on a procedural ship: 2.2e3 rays for 1 %, 0.9e6 for 0.01 %,
  // slope -0.77, over the view rectangle only: too few where reflections are noisy.
  const double error = accuracy.has_relative_error() ? accuracy.relative_error() : 0.01;
  const double paths = 2200 * std::pow(0.01 / error, 1 / 0.77);
  return std::min(paths, replicates * static_cast<double>(accuracy.max_samples_per_replicate()));
}

// Stored wavelengths of the piece's bands.
double wavelengths(const schema::ResolvedSweep& sweep, Span bands) {
  double count = 0;
  for (std::uint32_t b = bands.begin; b < bands.end; ++b) {
    const schema::Band& band = sweep.sweep().band(static_cast<int>(b));
    count += std::round((band.lambda_max_um() - band.lambda_min_um()) / band.step_um()) + 1;
  }
  return count;
}

// Cost of the shading that a piece adds, in units of its tracing: 1 % for a condition at the 122
// wavelengths of the frigate's two bands, 25 % for a position of the sun, whose shadow rays all
// bands share. These are the most that the project allows them to cost, not measurements: they
// decide how jobs are cut and nothing else.
double shading_cost(const schema::ResolvedSweep& sweep, const Piece& piece) {
  const auto times = static_cast<std::uint32_t>(sweep.sweep().time_size());
  const double spectral = 0.01 * wavelengths(sweep, piece.bands) / 122;
  double cost = 0;
  for (std::uint32_t s = piece.seasons.begin; s < piece.seasons.end; ++s) {
    for (std::uint32_t t = piece.times.begin; t < piece.times.end; ++t) {
      const bool sun = sweep.condition(static_cast<int>(s * times + t)).sun_irradiance_w_m2() > 0;
      cost += spectral + (sun ? 0.25 : 0);
    }
  }
  return cost;
}

// The most that a job may cost: in shading_cost(), and in rows with images.
struct JobLimits {
  double shading, rows;
};

// Returns the size of a job, in units of the limit that it is nearest to.
double size_of_job(const schema::ResolvedSweep& sweep, const Piece& piece, const JobLimits& most) {
  const double rows =
      static_cast<double>(size_of(piece.times)) * size_of(piece.seasons) * size_of(piece.bands);
  return std::max(shading_cost(sweep, piece) / most.shading, rows / most.rows);
}

// The fewest pieces along one axis that are small enough, or single steps of that axis if none are.
std::vector<Piece> cut_along(const schema::ResolvedSweep& sweep, const Piece& whole,
                             Span Piece::*axis, const JobLimits& most) {
  const std::uint32_t steps = size_of(whole.*axis);
  const auto piece = [&](std::uint32_t i, std::uint32_t count) {
    Piece out = whole;
    out.*axis = cut(whole.*axis, i, count);
    return out;
  };
  // Stops at the first: of 10^5 steps there may be 10^5 counts to try.
  const auto any_above = [&](std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i)
      if (size_of_job(sweep, piece(i, count), most) > 1) return true;
    return false;
  };
  const double total = size_of_job(sweep, whole, most);
  auto count =
      static_cast<std::uint32_t>(std::clamp(std::ceil(total), 1.0, static_cast<double>(steps)));
  while (count < steps && any_above(count)) ++count;
  std::vector<Piece> pieces;
  for (std::uint32_t i = 0; i < count; ++i) pieces.push_back(piece(i, count));
  return pieces;
}

// Primary rays of all profiles. Where a standard error is asked for: on the examples' cavities a
// path's temperature scatters by 7 K, and the pilot alone traces 1.5e5 rays.
double profile_paths(const schema::Sweep& asked) {
  double paths = 0;
  for (const schema::Profile& profile : asked.profile()) {
    const double points = profile.at_m_size() > 0 ? 1 : profile.points();
    paths +=
        points * (profile.has_samples()
                      ? profile.samples()
                      : 1.5e5 + std::pow(7 / profile.source_radiance_temperature_stderr_k(), 2));
  }
  return paths;
}

std::vector<Piece> cut_job(const schema::ResolvedSweep& sweep) {
  const schema::Sweep& asked = sweep.sweep();
  const double tracing = (estimated_paths(asked.accuracy()) + profile_paths(asked)) *
                         (1.0 + std::min(3u, asked.transport().max_reflections()));
  const JobLimits most{std::max(1.0, asked.transport().job_size_vertices() / tracing - 1.0),
                       most_rows_with_images(asked)};
  std::vector<Piece> pieces = {{.times = {0, static_cast<std::uint32_t>(asked.time_size())},
                                .seasons = {0, static_cast<std::uint32_t>(asked.season_size())},
                                .bands = {0, static_cast<std::uint32_t>(asked.band_size())}}};
  for (Span Piece::*axis : {&Piece::times, &Piece::seasons, &Piece::bands}) {
    std::vector<Piece> smaller;
    for (const Piece& piece : pieces) {
      const auto cuts = size_of_job(sweep, piece, most) > 1 ? cut_along(sweep, piece, axis, most)
                                                            : std::vector{piece};
      smaller.insert(smaller.end(), cuts.begin(), cuts.end());
    }
    pieces = std::move(smaller);
  }
  return pieces;
}

// Returns the ending in lower case (".csv" of "x/A.CSV"), which decides how a file is read. Its
// name and folder do not matter.
std::string ending_of(const std::string& file) {
  return absl::AsciiStrToLower(file.substr(std::min(file.size(), file.rfind('.'))));
}

// Clears the fields that no kind of job reads.
void clear_what_no_job_reads(schema::ResolvedSweep& sweep) {
  sweep.set_model_file_name(ending_of(sweep.model_file_name()));
  sweep.clear_shard();
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.mutable_model()->clear_file();
  asked.clear_name();
  asked.clear_description();
  asked.clear_viewpoints();
  asked.clear_precompute();
  asked.clear_published();
  asked.clear_imager();
  asked.mutable_transport()->clear_job_size_vertices();
  // These were written out into the conditions and heat runs, where they are complete.
  asked.clear_season();
  asked.clear_temperature_field();
  asked.clear_plume();
  asked.clear_time();
  asked.clear_surroundings();
  if (asked.has_land())
    for (schema::LandMaterial& material : *asked.mutable_land()->mutable_material())
      material.clear_temperature_k();
  schema::Air& air = *asked.mutable_air();
  air.clear_profile();
  air.clear_aerosol();
  air.clear_visibility_m();
  air.clear_air_mass();
  air.clear_co2_ppmv();
  air.clear_refraction();
  for (schema::Part& part : *asked.mutable_part()) part.clear_temperature_k();
}

// Clears a file's name except that of an .hgt file, which states the file's place.
void clear_file_name(schema::LandFile& file) {
  if (const std::string ending = ending_of(file.file_name()); ending != ".hgt")
    file.set_file_name(ending);
}

// Clears the names of files. Kept are their endings, and names that determine the content.
void clear_file_names(schema::LandFiles& files) {
  clear_file_name(*files.mutable_heights());
  if (files.has_inset()) clear_file_name(*files.mutable_inset());
  for (schema::LandFile& file : *files.mutable_fraction()) clear_file_name(file);
  for (schema::LandObjectFiles& object : *files.mutable_object()) {
    clear_file_name(*object.mutable_model());
    if (object.has_places()) clear_file_name(*object.mutable_places());
  }
}

void clear_file_names(schema::Weather& weather) {
  weather.clear_profile_file_name();
  weather.clear_modtran_file_name();
}

// Returns the common part of the keys of all views: the part of the sweep that determines their
// results.
std::string encoding_for_views(schema::ResolvedSweep sweep) {
  clear_what_no_job_reads(sweep);
  sweep.clear_viewpoint();
  sweep.clear_heat();  // the keys of what views need stand for it
  if (sweep.has_land()) clear_file_names(*sweep.mutable_land());
  for (schema::Condition& condition : *sweep.mutable_condition()) {
    condition.clear_warning();
    if (condition.has_temperature_field()) {
      schema::ConditionField& from = *condition.mutable_temperature_field();
      if (from.has_field()) from.mutable_field()->clear_name();
      from.set_file_name(ending_of(from.file_name()));
    }
    if (condition.has_weather()) clear_file_names(*condition.mutable_weather());
  }
  return canonical_encoding(sweep);
}

// Returns the part of the sweep that determines the temperatures of one heat run: all of it but the
// fields cleared here. Fields that are added to the messages therefore count.
std::string encoding_for_heat(schema::ResolvedSweep sweep, int run) {
  const schema::HeatRun only = sweep.heat(run);
  clear_what_no_job_reads(sweep);
  sweep.clear_viewpoint();
  sweep.clear_condition();
  sweep.clear_plume();
  sweep.clear_heat();
  *sweep.add_heat() = only;
  sweep.mutable_heat(0)->clear_season();  // a name
  sweep.mutable_heat(0)->clear_base();    // a place
  if (computes_land(only) || changes_land(only)) clear_file_names(*sweep.mutable_land());
  if (only.has_weather()) clear_file_names(*sweep.mutable_heat(0)->mutable_weather());
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.clear_band();
  asked.clear_accuracy();
  schema::Effects of_heat;
  for (const std::string& name : asked.effects().without())
    if (const auto effect = effect_named(name); effect && is_of_heat(*effect))
      of_heat.add_without(name);
  asked.clear_effects();
  if (of_heat.without_size() > 0) *asked.mutable_effects() = of_heat;
  asked.clear_output();
  asked.clear_profile();
  asked.clear_uncertainty();  // what a run of changes asks for stands in it
  asked.mutable_model()->clear_accepted_backface_fraction();
  for (schema::Part& part : *asked.mutable_part()) part.clear_hot();  // decides who gets paths
  return canonical_encoding(sweep);
}

std::string heat_job_key(const schema::ResolvedSweep& sweep, int physics_version, int run) {
  return sha256_hex(absl::StrCat("irsig heat job 1\nphysics_version ", physics_version, "\nsweep ",
                                 sha256_hex(encoding_for_heat(sweep, run)), "\n"));
}

// Returns the key of a view job.
std::string job_key(const std::string& sweep_digest, int physics_version,
                    const schema::Viewpoint& viewpoint, const schema::JobSpec& job) {
  schema::ResolvedSweep alone;  // the viewpoint in the same encoding as everything else
  *alone.add_viewpoint() = viewpoint;
  std::string text = absl::StrCat("irsig job 1\nphysics_version ", physics_version, "\nsweep ",
                                  sweep_digest, "\n", canonical_encoding(alone));
  for (const std::string& needed : job.needs()) absl::StrAppend(&text, "needs ", needed, "\n");
  for (const std::uint32_t index : job.view().condition_index())
    absl::StrAppend(&text, "condition ", index, "\n");
  for (const std::uint32_t index : job.view().band_index())
    absl::StrAppend(&text, "band ", index, "\n");
  return sha256_hex(text);
}

}  // namespace

double job_count(const schema::ResolvedSweep& sweep) {
  return static_cast<double>(sweep.heat_size()) +
         static_cast<double>(cut_job(sweep).size()) * static_cast<double>(shard_size(sweep));
}

std::vector<schema::JobSpec> expand_jobs(const schema::ResolvedSweep& sweep, int physics_version) {
  const std::string sweep_sha256 = sha256_hex(canonical_encoding(sweep));
  const std::string digest = sha256_hex(encoding_for_views(sweep));
  const std::vector<Piece> pieces = cut_job(sweep);
  const auto times = static_cast<std::uint32_t>(sweep.sweep().time_size());
  std::vector<schema::JobSpec> jobs;
  std::vector<std::string> heat_keys;
  for (int run = 0; run < sweep.heat_size(); ++run) {
    schema::JobSpec& job = jobs.emplace_back();
    job.set_sweep_sha256(sweep_sha256);
    job.mutable_heat()->set_heat(static_cast<std::uint32_t>(run));
    job.set_job_key(heat_job_key(sweep, physics_version, run));
    heat_keys.push_back(job.job_key());
  }
  for (std::uint64_t i = 0; i < shard_size(sweep); ++i) {
    const std::uint64_t view = shard_viewpoint(sweep, i);
    for (const Piece& piece : pieces) {
      schema::JobSpec& job = jobs.emplace_back();
      job.set_sweep_sha256(sweep_sha256);
      job.mutable_needs()->Add(heat_keys.begin(), heat_keys.end());
      job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(view));
      for (std::uint32_t s = piece.seasons.begin; s < piece.seasons.end; ++s) {
        for (std::uint32_t t = piece.times.begin; t < piece.times.end; ++t)
          job.mutable_view()->add_condition_index(s * times + t);
      }
      for (std::uint32_t b = piece.bands.begin; b < piece.bands.end; ++b)
        job.mutable_view()->add_band_index(b);
      job.set_job_key(
          job_key(digest, physics_version, sweep.viewpoint(static_cast<int>(view)), job));
    }
  }
  return jobs;
}

}  // namespace irsig

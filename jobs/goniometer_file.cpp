#include "jobs/goniometer_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "jobs/resolve.h"
#include "jobs/text/number_bounds.h"

namespace irsig {
namespace {

// A Gaussian response ends here, in full widths at half maximum: 0.04 % of its area lie beyond.
constexpr double kGaussianReach = 1.5;
constexpr int kGaussianPoints = 60;  // of its table: linear between them within 3e-4 of the peak

// A sweep requires a temperature of the parts, and a model where grains stand for it. A goniometer
// uses neither.
constexpr double kUnusedTemperatureK = 300;

void copy_scene(GoniometerFile& file) {
  schema::Sweep& sweep = file.scene.sweep;
  *sweep.mutable_material() = file.spec.material();
  *sweep.mutable_part() = file.spec.part();
  for (schema::Part& part : *sweep.mutable_part()) part.set_temperature_k(kUnusedTemperatureK);
  if (file.spec.has_model()) {
    *sweep.mutable_model() = file.spec.model();
  } else if (file.spec.has_particles()) {
    sweep.mutable_model()->set_generate("disk");
    sweep.mutable_model()->set_triangles(3);
  }
}

void check_goniometer_parts(const schema::Goniometer& spec, Findings& findings) {
  for (int i = 0; i < spec.part_size(); ++i) {
    const SectionCheck check(spec.part(i), absl::StrCat("part[", i, "]"), findings);
    check.only({"name", "match", "material", "two_sided"}, "to a goniometer");
  }
}

// Writes the limits and the response of a band that is given by its middle and width.
void resolve_band(schema::GoniometerBand& band, const std::string& path, Findings& findings) {
  const SectionCheck check(band, path, findings);
  if (band.has_center_um() || band.has_fwhm_um()) {
    check.only({"name", "center_um", "fwhm_um", "step_um", "spectral"}, "to a Gaussian band");
    check.require({"center_um", "fwhm_um"},
                  "expected the middle and the full width at half maximum");
    if (findings.any_at(path)) return;
    const double center_um = band.center_um(), fwhm_um = band.fwhm_um();
    const double least_um = center_um - kGaussianReach * fwhm_um;
    if (least_um < kShortestUm) {
      check.error("fwhm_um", absl::StrCat("= ", fwhm_um, " reaches down to ", least_um,
                                          " um, expected at least ", kShortestUm));
      return;
    }
    band.set_lambda_min_um(least_um);
    band.set_lambda_max_um(center_um + kGaussianReach * fwhm_um);
    if (!band.has_step_um()) band.set_step_um(fwhm_um);
    for (int i = 0; i <= kGaussianPoints; ++i) {
      const double x = kGaussianReach * (2.0 * i / kGaussianPoints - 1);
      schema::SpectralPoint& point = *band.add_response();
      point.set_lambda_um(center_um + x * fwhm_um);
      point.set_value(std::exp(-4 * std::numbers::ln2 * x * x));
    }
  } else {
    check.require({"lambda_min_um", "lambda_max_um"},
                  "expected the band's limits, or center_um and fwhm_um");
    check.require({"step_um"}, "expected the spacing of the band's wavelengths in micrometres");
    for (int i = 0; i < band.response_size(); ++i) {
      const SectionCheck point(band.response(i), absl::StrCat(path, ".response[", i, "]"),
                               findings);
      point.require({"lambda_um", "value"}, "expected a wavelength and the response there");
    }
    if (findings.any_at(path)) return;
    if (!(band.lambda_min_um() < band.lambda_max_um()))
      check.error("lambda_max_um", absl::StrCat("= ", band.lambda_max_um(),
                                                " is not above lambda_min_um, expected the "
                                                "shorter wavelength first"));
  }
  if (!findings.any_at(path) &&
      band.step_um() > band.lambda_max_um() - band.lambda_min_um() + 1e-12)
    check.error("step_um", absl::StrCat("= ", band.step_um(), " is wider than the band"));
  if (!band.has_spectral()) band.set_spectral(false);
}

void resolve_bands(schema::Goniometer& spec, schema::Sweep& scene, Findings& findings) {
  if (spec.band_size() == 0)
    findings.add("band", "[[band]] is missing, expected one or more bands");
  (void)check_names(spec.band(), "band", findings);
  for (int i = 0; i < spec.band_size(); ++i) {
    schema::GoniometerBand& band = *spec.mutable_band(i);
    resolve_band(band, absl::StrCat("band[", i, "]"), findings);
    schema::Band& plain = *scene.add_band();
    plain.set_name(band.name());
    plain.set_lambda_min_um(band.lambda_min_um());
    plain.set_lambda_max_um(band.lambda_max_um());
    plain.set_step_um(band.step_um());
    *plain.mutable_response() = band.response();
  }
}

void resolve_particles(schema::Goniometer& spec, Findings& findings) {
  if (spec.has_model() == spec.has_particles()) {
    findings.add("model", spec.has_model()
                              ? "both [model] and [particles], expected only one of them"
                              : "neither [model] nor [particles], expected one of them");
    return;
  }
  if (spec.has_model() && spec.model().has_generate())
    findings.add("model.generate",
                 "model.generate does not apply to a goniometer, expected model.file or "
                 "[particles]");
  if (!spec.has_particles()) return;
  schema::Particles& particles = *spec.mutable_particles();
  const SectionCheck check(particles, "particles", findings);
  if (particles.size_size() == 0)
    check.error("size", "is missing, expected [[particles.size]] with diameter_m and fraction");
  for (int i = 0; i < particles.size_size(); ++i) {
    schema::GrainSize& grain = *particles.mutable_size(i);
    const SectionCheck size(grain, absl::StrCat("particles.size[", i, "]"), findings);
    size.require({"diameter_m"}, "expected a diameter in metres");
    if (!grain.has_fraction() && particles.size_size() > 1)
      size.require({"fraction"}, "expected its share of the mix");
    if (!grain.has_fraction()) grain.set_fraction(1);
  }
  if (particles.size_size() > 1) check.require({"fractions_by"}, "expected \"mass\" or \"number\"");
  (void)check.one_of("fractions_by", {"mass", "number"});
  if (!particles.has_fractions_by()) particles.set_fractions_by("number");
  check.require({"width_m"}, "expected the width of the square cell that is filled");
  if ((particles.coverage_size() > 0) == particles.has_layers())
    check.error("coverage", particles.has_layers() ? "and layers, expected only one of them"
                                                   : "is missing, expected coverage or layers");
  (void)check.one_of("shape", {"irregular", "sphere"});
  if (!particles.has_tiles()) particles.set_tiles(1);
  if (!particles.has_shape()) particles.set_shape("irregular");
  if (!particles.has_irregularity()) particles.set_irregularity(0.2);
  if (!particles.has_subdivisions()) particles.set_subdivisions(1);
}

void check_increase(const google::protobuf::RepeatedField<double>& list, const std::string& path,
                    Findings& findings) {
  for (int i = 1; i < list.size(); ++i) {
    const std::string at = absl::StrCat(path, "[", i, "]");
    if (!(list[i] > list[i - 1]) && !findings.any_at(at))
      findings.add(at, absl::StrCat(at, " = ", list[i], ", expected increasing angles"));
  }
}

void resolve_instrument(schema::Goniometer& spec, Findings& findings) {
  schema::GoniometerSource& source = *spec.mutable_source();
  const SectionCheck source_check(source, "source", findings);
  source_check.require({"zenith_deg"}, "expected one or more zenith angles of the source");
  check_increase(source.zenith_deg(), "source.zenith_deg", findings);
  if (!source.has_angular_radius_deg()) source.set_angular_radius_deg(0);

  schema::GoniometerSensor& sensor = *spec.mutable_sensor();
  const SectionCheck sensor_check(sensor, "sensor", findings);
  sensor_check.require({"field_width_m"}, "expected the width of the field of view at the plate");
  (void)sensor_check.one_of("field", {"on_plate", "across_view"});
  if (!sensor.has_field_height_m()) sensor.set_field_height_m(sensor.field_width_m());
  if (!sensor.has_field()) sensor.set_field("on_plate");
  if (!sensor.has_reference_height_m()) sensor.set_reference_height_m(0);

  schema::GoniometerView& view = *spec.mutable_view();
  const SectionCheck view_check(view, "view", findings);
  (void)view_check.at_most_one({"zenith_deg", "zenith_step_deg"});
  (void)view_check.at_most_one({"azimuth_deg", "azimuth_step_deg"});
  if (view.zenith_deg_size() == 0)
    view_check.require({"zenith_max_deg", "zenith_step_deg"},
                       "expected the view zeniths, or the list zenith_deg");
  if (view.azimuth_deg_size() == 0)
    view_check.require({"azimuth_step_deg"}, "expected the step of 0 to 360, or azimuth_deg");
  check_increase(view.zenith_deg(), "view.zenith_deg", findings);
  check_increase(view.azimuth_deg(), "view.azimuth_deg", findings);
  if (findings.any_at("view")) return;
  constexpr double kRounding = 1e-9;
  if (view.zenith_deg_size() == 0)
    for (int i = 0; i * view.zenith_step_deg() <= view.zenith_max_deg() + kRounding; ++i)
      view.add_zenith_deg(i * view.zenith_step_deg());
  if (view.azimuth_deg_size() == 0)
    for (int i = 0; i * view.azimuth_step_deg() < 360 - kRounding; ++i)
      view.add_azimuth_deg(i * view.azimuth_step_deg());
}

void resolve_accuracy(schema::Goniometer& spec, Findings& findings) {
  schema::GoniometerAccuracy& accuracy = *spec.mutable_accuracy();
  const SectionCheck check(accuracy, "accuracy", findings);
  check.require({"samples_per_replicate"}, "expected how many rays each replicate of a view has");
  if (!accuracy.has_replicates()) accuracy.set_replicates(32);
  if (!accuracy.has_max_reflections()) accuracy.set_max_reflections(16);
}

}  // namespace

absl::StatusOr<GoniometerFile> parse_goniometer(std::string_view text, std::string_view file_name) {
  GoniometerFile file;
  file.scene.file_name = std::string(file_name);
  RETURN_IF_ERROR(fill_from_toml(text, file.scene, file.spec));
  copy_scene(file);
  return file;
}

absl::StatusOr<ResolvedGoniometer> resolve_goniometer(const GoniometerFile& file,
                                                      std::string_view model_bytes) {
  ResolvedGoniometer out;
  out.spec = file.spec;
  *out.scene.mutable_sweep() = file.scene.sweep;
  Findings findings(file.scene);
  if (!out.spec.has_name())
    findings.add("name", "name is missing, expected a name for this measurement");
  if (!out.spec.has_seed()) out.spec.set_seed(1);
  check_numbers(out.spec, "", findings);
  check_numbers(out.scene.sweep(), "", findings);  // with what material files hold
  check_goniometer_parts(out.spec, findings);
  resolve_particles(out.spec, findings);
  resolve_bands(out.spec, *out.scene.mutable_sweep(), findings);
  resolve_instrument(out.spec, findings);
  resolve_accuracy(out.spec, findings);
  if (out.spec.has_model() != out.spec.has_particles())
    resolve_target(model_bytes, out.scene, findings);
  schema::Model& model = *out.scene.mutable_sweep()->mutable_model();
  if (model.has_file() && !model.has_reference()) model.set_reference("origin");
  if (!findings.empty()) return findings.status();
  return out;
}

}  // namespace irsig

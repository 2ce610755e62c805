#include "runner/input_views.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/results/read_heat_field.h"
#include "messages/scene/material_from_message.h"

namespace irsig {
namespace {

bool same_air(const schema::ResolvedSweep& a, const schema::ResolvedSweep& b) {
  for (int c = 0; c < a.condition_size(); ++c) {
    const schema::Condition &x = a.condition(c), &y = b.condition(c);
    if (x.weather().SerializeAsString() != y.weather().SerializeAsString() ||
        x.surroundings().SerializeAsString() != y.surroundings().SerializeAsString())
      return false;
  }
  return true;
}

// Stated temperatures of land; those that are computed have changes of their own.
bool same_stated_land(const schema::ResolvedSweep& a, const schema::ResolvedSweep& b) {
  for (int c = 0; c < a.condition_size(); ++c)
    if (!std::ranges::equal(a.condition(c).land_temperature_k(),
                            b.condition(c).land_temperature_k()))
      return false;
  return true;
}

bool same_materials(const schema::Sweep& a, const schema::Sweep& b) {
  return std::equal(a.material().begin(), a.material().end(), b.material().begin(),
                    b.material().end(), [](const schema::Material& x, const schema::Material& y) {
                      schema::Material seen_x = x, seen_y = y;  // walls alone have the rest
                      for (schema::Material* m : {&seen_x, &seen_y}) {
                        m->clear_solar_absorptance();
                        m->clear_thermal_emissivity();
                      }
                      return seen_x.SerializeAsString() == seen_y.SerializeAsString();
                    });
}

// A material decides how much is reflected of all there is; sky, sea and air what comes of them; a
// temperature what parts send to each other, and what land sends to them.
void add_moved_effects(bool materials, bool air, bool land, std::vector<Effect>& out) {
  std::vector<Effect> moved{Effect::kInterReflection, Effect::kHotPartsReflected};
  if (land) moved.push_back(Effect::kLowerReflected);
  if (materials || air)
    moved.insert(moved.end(), {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun,
                               Effect::kSkyReflected, Effect::kLowerReflected});
  if (air) moved.insert(moved.end(), {Effect::kPathSun, Effect::kBackgroundSun});
  if (materials || air) moved.push_back(Effect::kCloud);
  for (const Effect e : moved)
    if (std::find(out.begin(), out.end(), e) == out.end()) out.push_back(e);
}

// By how much a move changes the temperatures of facets, as the heat jobs have left it.
class FacetChanges {
 public:
  FacetChanges(const schema::ResolvedSweep& sweep, const HeatOutputs& heat, std::size_t facets)
      : sweep_(sweep), heat_(heat), facets_(facets) {}

  // [facet] of a condition; empty: none of them changes.
  absl::StatusOr<std::vector<float>> of(const schema::Condition& c, const std::string& input,
                                        double move) {
    if (!c.temperature_field().has_heat()) return std::vector<float>();
    const int run = changes_of_run(sweep_, static_cast<int>(c.temperature_field().heat()));
    if (run < 0) return std::vector<float>();
    const schema::HeatRun& asked = sweep_.heat(run);
    int which = 0;
    while (which < asked.input_size() &&
           !(asked.input(which).name() == input && asked.input(which).move() == move))
      ++which;
    if (which == asked.input_size()) return std::vector<float>();
    if (!field_.contains(run)) {
      ASSIGN_OR_RETURN(field_[run], read_heat_field(heat_[static_cast<std::size_t>(run)], facets_));
    }
    const schema::HeatField& field = field_[run];
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(c.time_utc()));
    const auto at = std::find(field.unix_s().begin(), field.unix_s().end(), unix_seconds(time));
    if (at == field.unix_s().end() || field.change_k_size() != asked.input_size())
      return absl::InvalidArgumentError(
          absl::StrCat("there are no changes of temperatures at ", c.time_utc()));
    std::vector<float> out(facets_);
    const auto row = static_cast<std::size_t>(at - field.unix_s().begin());
    std::memcpy(out.data(), field.change_k(which).data() + row * facets_ * sizeof(float),
                facets_ * sizeof(float));
    return out;
  }

 private:
  const schema::ResolvedSweep& sweep_;
  const HeatOutputs& heat_;
  std::size_t facets_;
  std::map<int, schema::HeatField> field_;
};

// The emitters' temperatures with what changes of them: of an emitter of several facets the mean.
absl::StatusOr<SweepTemperatures> moved_temperatures(const SweepTemperatures& nominal,
                                                     const schema::ResolvedSweep& moved,
                                                     FacetChanges& changes,
                                                     const std::string& input, double move) {
  SweepTemperatures out = nominal;
  if (!nominal.emitters) return out;
  const std::vector<std::uint32_t>& emitter = nominal.emitters->of_facet;
  for (int c = 0; c < moved.condition_size(); ++c) {
    const schema::Condition& condition = moved.condition(c);
    ASSIGN_OR_RETURN(const auto change, changes.of(condition, input, move));
    const double shift_k = condition.temperature_field().shift_k();
    if (change.empty() && shift_k == 0) continue;
    auto to =
        std::make_shared<EmitterTemperatures>(*nominal.condition[static_cast<std::size_t>(c)]);
    std::vector<double> sum(to->kelvin.size(), 0.0), count(to->kelvin.size(), 0.0);
    for (std::size_t f = 0; f < emitter.size() && !change.empty(); ++f) {
      if (std::isnan(change[f])) continue;
      sum[emitter[f]] += static_cast<double>(change[f]);
      ++count[emitter[f]];
    }
    to->coldest_k = INFINITY;
    to->hottest_k = 0;
    for (std::size_t e = 0; e < to->kelvin.size(); ++e) {
      if (std::isnan(to->kelvin[e])) continue;
      const double kelvin =
          static_cast<double>(to->kelvin[e]) + shift_k + (count[e] > 0 ? sum[e] / count[e] : 0);
      to->kelvin[e] = static_cast<float>(std::clamp(kelvin, 1.0, kMostEmitterK));
      to->coldest_k = std::min(to->coldest_k, static_cast<double>(to->kelvin[e]));
      to->hottest_k = std::max(to->hottest_k, static_cast<double>(to->kelvin[e]));
    }
    if (to->hottest_k == 0) to->coldest_k = 0;
    out.condition[static_cast<std::size_t>(c)] = std::move(to);
  }
  return out;
}

absl::Status input_error(const UncertainInput& input, const absl::Status& status) {
  return at_key(absl::StrCat("uncertainty.", input.name), status);
}

void set_change(schema::Estimate* out, const Estimate& e) {
  out->set_value(e.value);
  out->set_stderr(e.stderr_);
}

// The change of a row per sigma of an input, computed from one side or from both sides.
struct Gain {
  Estimate up;
  double curvature = 0;
};
Gain gain(const Estimate* higher, const Estimate* lower) {
  if (lower == nullptr) return {*higher};
  if (higher == nullptr) return {{-lower->value, lower->stderr_}};
  // Both sides share their paths, so that the standard error is at most the mean of both.
  return {{0.5 * (higher->value - lower->value), 0.5 * (higher->stderr_ + lower->stderr_)},
          0.5 * (higher->value + lower->value)};
}

}  // namespace

absl::StatusOr<InputViews> InputViews::make(const schema::ResolvedSweep& sweep,
                                            const SceneSpec& scene, const Simulator& simulator,
                                            const std::shared_ptr<const Environment>& environment,
                                            const SweepTemperatures& temperatures,
                                            std::shared_ptr<const LandScene> land,
                                            const HeatOutputs& heat) {
  InputViews out;
  out.land_ = std::move(land);
  out.input_ = uncertain_inputs(sweep.sweep().uncertainty());
  FacetChanges changes(sweep, heat, simulator.target().facet.size());
  for (std::size_t i = 0; i < out.input_.size(); ++i)
    for (const double move : moves_of(sweep, out.input_[i])) {
      const UncertainInput& input = out.input_[i];
      Move& m = out.move_.emplace_back(
          Move{i, move, moved_sweep(sweep, input, move).sweep, environment, {}, nullptr});
      auto moved = moved_temperatures(temperatures, m.sweep, changes, input.name, move);
      if (!moved.ok()) return input_error(input, moved.status());
      m.temperatures = *std::move(moved);
      auto other_k = moved_land_temperatures(temperatures.land, m.sweep, heat, input.name, move);
      if (!other_k.ok()) return input_error(input, other_k.status());
      const bool other_land =
          other_k->kelvin != temperatures.land.kelvin || !same_stated_land(sweep, m.sweep);
      m.temperatures.land = *std::move(other_k);
      if (!same_air(sweep, m.sweep)) {
        auto air = environment_from_sweep(m.sweep, simulator.band_grids());
        if (!air.ok()) return input_error(input, air.status());
        m.environment = *std::move(air);
      }
      const bool materials = !same_materials(sweep.sweep(), m.sweep.sweep());
      add_moved_effects(materials, !same_air(sweep, m.sweep), other_land, out.moved_effects_);
      if (!materials) continue;
      SceneSpec other = scene;
      for (int k = 0; k < m.sweep.sweep().material_size(); ++k) {
        auto material = material_from_message(m.sweep.sweep().material(k));
        if (!material.ok()) return input_error(input, material.status());
        other.material[static_cast<std::size_t>(k)] = *std::move(material);
      }
      other.land_material.clear();
      if (const absl::Status taken = take_land_materials(m.sweep.sweep(), other); !taken.ok())
        return input_error(input, taken);
      auto prepared = PreparedScene::make(other);
      if (!prepared.ok()) return input_error(input, prepared.status());
      m.scene = std::make_shared<const PreparedScene>(*std::move(prepared));
    }
  return out;
}

void InputViews::look_as(const schema::ResolvedSweep& sweep) {
  for (Move& m : move_) {
    *m.sweep.mutable_viewpoint() = sweep.viewpoint();
    schema::Sweep& asked = *m.sweep.mutable_sweep();
    asked.set_name(sweep.sweep().name());
    *asked.mutable_accuracy() = sweep.sweep().accuracy();
    *asked.mutable_viewpoints() = sweep.sweep().viewpoints();
    *asked.mutable_profile() = sweep.sweep().profile();
    asked.mutable_transport()->set_job_size_vertices(sweep.sweep().transport().job_size_vertices());
  }
}

absl::StatusOr<std::vector<MovedView>> InputViews::views(const schema::ViewJob& job) const {
  std::vector<MovedView> out;
  for (const Move& m : move_) {
    auto request = request_from_job(m.sweep, job, m.environment, m.temperatures, land_, {});
    if (!request.ok()) return input_error(input_[m.input], request.status());
    out.push_back({*std::move(request), m.scene});
  }
  return out;
}

void InputViews::write(std::span<const std::vector<RowChange>> change,
                       schema::ViewJobResult& result) const {
  for (int r = 0; r < result.row_size(); ++r) {
    schema::SignatureRow& row = *result.mutable_row(r);
    struct Squares {
      double source = 0, apparent = 0, contrast = 0;
    } of_inputs, of_model;
    for (std::size_t i = 0; i < input_.size(); ++i) {
      const RowChange *higher = nullptr, *lower = nullptr;
      for (std::size_t k = 0; k < move_.size(); ++k)
        if (move_[k].input == i)
          (move_[k].move > 0 ? higher : lower) = &change[k][static_cast<std::size_t>(r)];
      const auto of = [&](Estimate RowChange::*which) {
        return gain(higher ? &(higher->*which) : nullptr, lower ? &(lower->*which) : nullptr);
      };
      const Gain s = of(&RowChange::source), a = of(&RowChange::apparent),
                 c = of(&RowChange::contrast);
      schema::InputContribution& to = *row.add_input();
      to.set_input(input_[i].name);
      set_change(to.mutable_contribution_w_sr(), s.up);
      set_change(to.mutable_apparent_contribution_w_sr(), a.up);
      set_change(to.mutable_contrast_contribution_w_sr(), c.up);
      if (higher != nullptr && lower != nullptr) {
        to.set_curvature_w_sr(s.curvature);
        to.set_apparent_curvature_w_sr(a.curvature);
        to.set_contrast_curvature_w_sr(c.curvature);
      }
      // For a normal x, g x + h x^2 / 2 has the variance g^2 s^2 + h^2 s^4 / 2.
      const auto square = [](const Gain& g) {
        return g.up.value * g.up.value + 2 * g.curvature * g.curvature;
      };
      Squares& sum = is_of_heat_model(input_[i].name) ? of_model : of_inputs;
      sum.source += square(s);
      sum.apparent += square(a);
      sum.contrast += square(c);
    }
    const auto models = std::ranges::count_if(
        input_, [](const UncertainInput& input) { return is_of_heat_model(input.name); });
    if (models < std::ssize(input_)) {
      row.set_input_uncertainty_w_sr(std::sqrt(of_inputs.source));
      row.set_apparent_input_uncertainty_w_sr(std::sqrt(of_inputs.apparent));
      row.set_contrast_input_uncertainty_w_sr(std::sqrt(of_inputs.contrast));
    }
    if (models > 0) {
      row.set_heat_model_error_w_sr(std::sqrt(of_model.source));
      row.set_apparent_heat_model_error_w_sr(std::sqrt(of_model.apparent));
      row.set_contrast_heat_model_error_w_sr(std::sqrt(of_model.contrast));
    }
  }
}

int moved_environments(const schema::ResolvedSweep& sweep) {
  int out = 0;
  for (const UncertainInput& input : uncertain_inputs(sweep.sweep().uncertainty()))
    for (const double move : moves_of(sweep, input))
      if (!same_air(sweep, moved_sweep(sweep, input, move).sweep)) ++out;
  return out;
}

}  // namespace irsig

#include "core/signature/gas_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/signature/add_estimates.h"
#include "core/signature/gas_measurement.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

using Change = GasRow::Change;

// Sigmas of a pilot's estimate that a bound of left-out light adds.
constexpr double kGasSigmas = 4;

void add_change(const Change& more, Change& to) {
  add(more.in_band, to.in_band);
  to.bound_w_sr += more.bound_w_sr;
  add(more.spectral, to.spectral);
  for (std::size_t r = 0; r < to.replicate.size(); ++r) to.replicate[r] += more.replicate[r];
}

// Both have random numbers of their own.
void add_on_hull(const GasRow& more, GasRow& to) {
  add_change(more.source, to.source);
  add_change(more.apparent, to.apparent);
  add_change(more.contrast, to.contrast);
  add(more.on_hull, to.on_hull);
  add(more.apparent_on_hull, to.apparent_on_hull);
  to.lines_w_sr += more.lines_w_sr;
  to.source_model_error_w_sr += more.source_model_error_w_sr;
  to.model_error_w_sr += more.model_error_w_sr;
  // Reflected and seen light have equal relative errors.
  if (to.emitted_w_sr > 0) to.voxel_error_w_sr *= 1 + more.emitted_w_sr / to.emitted_w_sr;
  if (to.apparent_emitted_w_sr > 0)
    to.apparent_voxel_error_w_sr *= 1 + more.apparent_emitted_w_sr / to.apparent_emitted_w_sr;
  to.rays += more.rays;
}

void add_bound(const RowBounds::Bound& more, RowBounds::Bound& to) {
  to.source += more.source;
  to.apparent += more.apparent;
  to.contrast += more.contrast;
}

// Returns the largest change by leaving a measured row out, with few rays as with many.
RowBounds::Bound limit_of(const GasRow& row) {
  const auto most = [](const Change& c) {
    return std::abs(c.in_band.value) + kGasSigmas * c.in_band.stderr_ + c.bound_w_sr;
  };
  return {false, most(row.source), most(row.apparent), most(row.contrast)};
}

LedgerEntry entry_of(Effect effect, bool off, EffectReason reason, const RowBounds::Bound& bound) {
  return {effect,
          off ? EffectState::kOff : EffectState::kOn,
          reason,
          bound.source,
          bound.apparent,
          bound.contrast,
          std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::quiet_NaN()};
}

// One field of gas and all rows of a request that have it.
class GasOfField {
 public:
  GasOfField(const GasInView& given, const std::shared_ptr<const PlumeField>& field,
             const std::vector<std::size_t>& condition)
      : scene_(given.scene),
        request_(given.request),
        plan_(given.plan),
        field_(field),
        condition_(condition),
        in_sight_(GasMeasurement::Where::kInSight, given, field, condition),
        on_hull_(GasMeasurement::Where::kOnHull, given, field, condition) {}

  absl::Status trace() {
    ASSIGN_OR_RETURN(seen_, in_sight_.find());
    if (seen_ && !without_) in_sight_.measure({});
    ASSIGN_OR_RETURN(met_, on_hull_.find());
    return absl::OkStatus();
  }

  // [selected band] which: of its conditions
  absl::StatusOr<std::vector<GasRow>> rows(std::size_t which) {
    const std::uint32_t condition = request_.selected_condition[condition_[which]];
    ASSIGN_OR_RETURN(auto seen, rows_of(seen_ ? &in_sight_ : nullptr, which));
    // Rows of few rays, and of as many as are wanted, are made when they are asked for.
    std::optional<std::vector<GasRow>> few, all;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const std::uint32_t band = request_.selected_band[i];
      GasRow& row = seen[i];
      RowBounds::Bound left_out = unmet(band);
      const bool room = !plan_.room.empty(), forced = without_ || without_hull();
      const EffectPlanner::Room& of_row =
          room ? plan_.room[condition * scene_.axis.bands() + band] : EffectPlanner::Room{};
      bool off = forced || !met_;
      if (met_ && (forced || (room && on_hull_.sent_w_sr()[band] <= of_row.source))) {
        RETURN_IF_ERROR(make(on_hull_, which, few));
        left_out = limit_of((*few)[i]);
        off = forced || EffectPlanner::fits(left_out, of_row);
      }
      RowBounds::Bound most = left_out;
      double seconds = std::numeric_limits<double>::quiet_NaN();
      if (!off) {
        if (!full_) {
          full_.emplace(on_hull_);
          full_->measure(seen_ ? in_sight_.sent_w_sr() : std::vector<double>());
        }
        RETURN_IF_ERROR(make(*full_, which, all));
        most = limit_of((*all)[i]);
        seconds = static_cast<double>((*all)[i].rays) * kRaySeconds;
        add_on_hull((*all)[i], row);
        left_out = {};
      }
      const bool hull_off = off && (met_ || forced);
      const bool automatic = request_.effects.mode == EffectChoice::Mode::kAuto;
      LedgerEntry hull = entry_of(Effect::kPlumeOnHull, hull_off,
                                  forced      ? EffectReason::kForced
                                  : hull_off  ? EffectReason::kWithinShare
                                  : room      ? EffectReason::kAboveShare
                                  : automatic ? EffectReason::kNoGoal
                                              : EffectReason::kForced,
                                  most);
      hull.time_s = seconds;
      if (!hull_off) hull.fraction_w_sr = row.on_hull.value;
      RowBounds::Bound plume = limit_of(row), lines{false, 0, row.lines_w_sr, row.lines_w_sr};
      const bool product = request_.effects.without(Effect::kHotLineCorrelation) && !without_;
      if (without_) {
        // The measured row only bounds the light that is left out.
        add_bound(left_out, plume);
        const GasRow measured = std::exchange(row, nothing_of(bins(band)));
        row.rays = measured.rays;
        left_out = plume;
        lines = {};
      } else if (product) {
        add_bound(lines, left_out);
      }
      row.omitted = left_out;
      row.ledger = {
          entry_of(Effect::kPlume, without_,
                   without_ ? EffectReason::kForced : EffectReason::kNotAsked, plume),
          hull,
          entry_of(Effect::kHotLineCorrelation, product || without_,
                   product || without_ ? EffectReason::kForced : EffectReason::kNotAsked, lines)};
      if (!without_) row.ledger.front().fraction_w_sr = row.source.in_band.value;
    }
    return seen;
  }

 private:
  [[nodiscard]] bool without_hull() const {
    return request_.max_reflections == 0 || request_.effects.without(Effect::kPlumeOnHull);
  }
  [[nodiscard]] std::size_t bins(std::uint32_t band) const {
    return scene_.axis.band(band).grid.lambda_um.size();
  }
  [[nodiscard]] GasRow nothing_of(std::size_t bins) const {
    GasRow out;
    for (Change* change : {&out.source, &out.apparent, &out.contrast}) {
      change->spectral.value.assign(bins, 0.0);
      change->spectral.stderr_.assign(bins, 0.0);
      change->replicate.assign(request_.accuracy.replicates, 0.0);
    }
    return out;
  }
  // Null: gas that is hidden by the target.
  absl::StatusOr<std::vector<GasRow>> rows_of(const GasMeasurement* gas, std::size_t which) const {
    if (gas != nullptr) return gas->rows(which);
    std::vector<GasRow> out;
    for (const std::uint32_t b : request_.selected_band) out.push_back(nothing_of(bins(b)));
    return out;
  }
  static absl::Status make(const GasMeasurement& gas, std::size_t which,
                           std::optional<std::vector<GasRow>>& rows) {
    if (rows) return absl::OkStatus();
    ASSIGN_OR_RETURN(rows, gas.rows(which));
    return absl::OkStatus();
  }
  // Returns the bound for gas that no reflected ray has met: as hot and black as it may be.
  [[nodiscard]] RowBounds::Bound unmet(std::uint32_t band) const {
    if (met_) return {};
    const BandGrid& grid = scene_.axis.band(band).grid;
    double radiance = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i)
      radiance += grid.band_weight[i] *
                  planck_radiance_w_m2_sr_um(grid.node_um[i], field_->report().most_k);
    const double most = on_hull_.unmet_m2() * radiance;
    return {false, most, most, most};
  }

  const PreparedScene& scene_;
  const ViewRequest& request_;
  const ViewPlan& plan_;
  std::shared_ptr<const PlumeField> field_;
  std::vector<std::size_t> condition_;
  bool without_ = request_.effects.without(Effect::kPlume);
  bool seen_ = false, met_ = false;
  GasMeasurement in_sight_, on_hull_;
  std::optional<GasMeasurement> full_;
};

}  // namespace

absl::StatusOr<std::vector<std::optional<GasRow>>> gas_rows(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    std::shared_ptr<const PreparedView> view, const PictureFrame& pictures) {
  std::vector<std::shared_ptr<const PlumeField>> fields;
  for (const std::uint32_t c : request.selected_condition)
    if (const auto& field = request.condition[c].gas; field != nullptr)
      if (std::find(fields.begin(), fields.end(), field) == fields.end()) fields.push_back(field);
  std::vector<std::optional<GasRow>> out;
  if (fields.empty()) return out;
  ASSIGN_OR_RETURN(const auto wavelengths, GasWavelengths::make(scene.axis.node_um()));
  const std::size_t bands = request.selected_band.size();
  out.resize(request.selected_condition.size() * bands);
  const ViewSources sources(source_request(scene, request, request.selected_condition),
                            plan.effects, {view, &view->environments}, scene.axis.node_um());
  const GasInView given{scene, request, plan, *view, sources, wavelengths, pictures};
  for (const std::shared_ptr<const PlumeField>& field : fields) {
    std::vector<std::size_t> having;
    for (std::size_t i = 0; i < request.selected_condition.size(); ++i)
      if (request.condition[request.selected_condition[i]].gas == field) having.push_back(i);
    GasOfField gas(given, field, having);
    RETURN_IF_ERROR(gas.trace());
    for (std::size_t which = 0; which < having.size(); ++which) {
      const std::size_t first = having[which] * bands;
      ASSIGN_OR_RETURN(auto rows, gas.rows(which));
      for (std::size_t b = 0; b < bands; ++b) out[first + b] = std::move(rows[b]);
    }
  }
  return out;
}

}  // namespace irsig

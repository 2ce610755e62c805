#include "core/signature/gas_rows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/check.h"
#include "core/base/ordered_dot.h"
#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/signature/make_plan.h"
#include "core/signature/pass.h"
#include "core/signature/shading.h"

namespace irsig {
namespace {

// Stages of a view's random numbers: other paths than those of the target's own light.
constexpr std::uint64_t kGasStage = 0x6a5;
constexpr std::uint64_t kSurveySamples = 32, kPilotSamples = 64;
// Of the error that is asked for, what the gas's own samples may take.
constexpr double kShareOfGoal = 0.5;
// Columns that stand for all: so near to what the tests of all rays are, and at most so many; and
// classes of gas, so many or all that are less alike.
constexpr double kTolerance = 1e-3, kAlike = 0.02;
// What may be left of steps that were extrapolated, of the extrapolation.
constexpr double kOfSteps = 0.25;
constexpr std::size_t kNodes = 24, kClasses = 6;

using Change = GasRow::Change;

BoxedSight sight_of(const PlumeField& field) {
  BoxedSight out;
  for (const PlumeField::Box& box : field.cell_boxes()) {
    auto& corners = out.box.emplace_back();
    for (unsigned n = 0; n < 8; ++n)
      corners[n] = field.body_from_index({(n & 4) != 0 ? box.high[0] : box.low[0],
                                          (n & 2) != 0 ? box.high[1] : box.low[1],
                                          (n & 1) != 0 ? box.high[2] : box.low[2]});
  }
  for (const PlumePoint& point : field.points())
    out.point.push_back(
        {point.at,
         point.reach_m,
         {static_cast<double>(point.thin_w[0]), static_cast<double>(point.thin_w[1])}});
  return out;
}

// One field of gas in one view.
class GasMeasurement {
 public:
  GasMeasurement(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
                 const ViewSources& sources, const GasWavelengths& wavelengths,
                 std::shared_ptr<const PlumeField> field)
      : scene_(scene),
        request_(request),
        plan_(plan),
        sources_(sources),
        wavelengths_(wavelengths),
        field_(std::move(field)) {}

  // False: the gas is not seen at all.
  absl::StatusOr<bool> trace() {
    auto aimed = make_boxed_view(scene_.target, request_.viewpoint, sight_of(*field_));
    if (!aimed.ok()) return aimed.status();
    aimed_ = *std::move(aimed);
    const auto survey = std::make_shared<const GasSurvey>(field_, scene_.target.centre);
    run(survey, kSurveySamples, 0, 0);
    if (survey->columns().empty()) return false;
    const ColumnTests tests = tests_for(survey->columns());
    std::vector<std::vector<double>> tested;
    for (const GasColumn& column : survey->columns())
      tests.test(column, tested.emplace_back(ColumnTests::kCount));
    if (auto status = choose_classes(survey->columns(), tested, tests); !status.ok()) return status;
    const std::vector<PathWeights> pilot = run(gas_, kPilotSamples, 1, 0);
    if (auto status = choose_nodes(survey->columns(), tested, sum_of(pilot)); !status.ok())
      return status;
    weights_ = run(gas_, samples(pilot), 2, plan_.effects.max_reflections);
    const std::vector<double> sums = sum_of(weights_);
    for (Nodes& nodes : nodes_)
      nodes.weight = column_weights(nodes.tests, sums, 0, nodes.tests.size());
    find_class_errors();
    split_by_class();
    return true;
  }

  [[nodiscard]] std::uint64_t rays() const { return counts_.rays; }

  absl::StatusOr<std::vector<GasRow>> rows(const ConditionSources& light) const {
    const ViewEnvironment& environment = light.environment();
    if (environment.air == nullptr && request_.environment != nullptr)
      return absl::InvalidArgumentError(
          "hot gas behind imported air: its lines are not known, and band means do not multiply");
    std::optional<AirBeforeColumns> air;
    if (environment.air != nullptr) {
      auto made = AirBeforeColumns::make(*environment.air, wavelengths_);
      if (!made.ok()) return made.status();
      air = *std::move(made);
    }
    const auto at_sensor = [&](const std::vector<HotColumn>& columns,
                               const std::vector<ColumnLight>& here) {
      std::vector<ColumnLight> out;
      for (std::size_t m = 0; m < columns.size(); ++m) {
        if (air) {
          out.push_back(columns[m].behind(*air));
          continue;
        }
        out.push_back(here[m]);  // no air, or a grey one
        for (std::size_t i = 0; i < environment.transmittance.size(); ++i)
          out.back().emitted_w_m2_sr_um[i] *= environment.transmittance[i];
      }
      return out;
    };
    const std::array<std::vector<ColumnLight>, 2> seen = {
        at_sensor(nodes_[0].column, nodes_[0].here), at_sensor(nodes_[1].column, nodes_[1].here)};
    const std::vector<ColumnLight> classes = at_sensor(class_column_, class_here_);
    const LitWeights of_classes(light, mean_, 1), of_replicates(light, each_, 1);
    std::vector<GasRow> out;
    for (const std::uint32_t b : request_.selected_band)
      out.push_back(row_of(light, seen, classes, of_classes, of_replicates, b));
    return out;
  }

 private:
  // Columns whose weighted spectra add up to those of all rays. Two sets that have no column in
  // common: their difference shows what so few columns cost.
  struct Nodes {
    std::vector<HotColumn> column;
    std::vector<std::vector<double>> tests;
    std::vector<ColumnLight> here;  // at the target
    std::vector<double> weight;     // [m2]
  };

  std::vector<PathWeights> run(std::shared_ptr<const GasOnRays> gas, std::uint64_t samples,
                               std::uint64_t stage, std::uint32_t reflections) {
    SourceGeometry geometry = sources_.geometry();
    geometry.medium = HotGasMedium{std::move(gas)};
    PathSettings settings = path_settings(request_.accuracy, plan_.effects,
                                          view_seed(scene_, request_) + kGasStage + stage, samples);
    settings.max_reflections = reflections;
    const PathTracer tracer(scene_.target, scene_.carried_material(), aimed_, std::move(geometry),
                            settings);
    std::vector<double> none;
    return tracer.trace({}, none, counts_);
  }

  static ColumnTests tests_for(const std::vector<GasColumn>& columns) {
    std::array<double, kPlumeSpecies> most{};
    double hottest_k = 1;
    for (const GasColumn& column : columns) {
      std::array<double, kPlumeSpecies> sum{};
      for (const GasSegment& segment : column) {
        for (std::size_t k = 0; k < kPlumeSpecies; ++k) sum[k] += segment.amount[k];
        hottest_k = std::max(hottest_k, segment.temperature_k);
      }
      for (std::size_t k = 0; k < kPlumeSpecies; ++k) most[k] = std::max(most[k], sum[k]);
    }
    return {most, hottest_k};
  }

  static std::vector<double> sum_of(const std::vector<PathWeights>& weights) {
    std::vector<double> out(ColumnTests::kCount, 0.0);
    for (const PathWeights& w : weights)
      for (std::size_t t = 0; t < out.size(); ++t)
        out[t] += w.gas_m2[t] / static_cast<double>(weights.size());
    return out;
  }

  absl::Status prepare(const std::vector<GasColumn>& columns, std::vector<HotColumn>& hot,
                       std::vector<ColumnLight>& here) const {
    for (const GasColumn& column : columns) {
      auto made = HotColumn::make(column, wavelengths_);
      if (!made.ok()) return made.status();
      here.push_back(made->at_near_end());
      hot.push_back(*std::move(made));
    }
    return absl::OkStatus();
  }

  // One after another the column that is least like any before it.
  absl::Status choose_classes(const std::vector<GasColumn>& columns,
                              const std::vector<std::vector<double>>& tested,
                              const ColumnTests& tests) {
    std::vector<std::vector<double>> like;
    std::vector<GasColumn> of_class;
    std::size_t next = 0;
    const auto absorbed = [&](std::size_t c) { return ColumnTests::absorbed(tested[c]); };
    const auto size = [&](std::size_t c) {
      const auto a = absorbed(c);
      return ordered_dot(a.data(), a.data(), a.size());
    };
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (size(c) > size(next)) next = c;
    double unlike = 1;
    while (like.size() < kClasses && unlike > kAlike) {
      like.push_back(tested[next]);
      of_class.push_back(columns[next]);
      gas_ = std::make_shared<const GasOnView>(field_, scene_.target.centre, tests, like);
      unlike = 0;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto [which, factor] = gas_->like(tested[c]);
        const auto own = absorbed(c), other = ColumnTests::absorbed(like[which]);
        double off = 0;
        for (std::size_t g = 0; g < own.size(); ++g)
          off += (own[g] - factor * other[g]) * (own[g] - factor * other[g]);
        if (const double relative = std::sqrt(off / size(c)); relative > unlike) {
          unlike = relative;
          next = c;
        }
      }
    }
    return prepare(of_class, class_column_, class_here_);
  }

  // Of every other column of the survey one set, of the rest the other.
  absl::Status choose_nodes(const std::vector<GasColumn>& columns,
                            const std::vector<std::vector<double>>& tested,
                            const std::vector<double>& sums) {
    for (std::size_t set = 0; set < nodes_.size(); ++set) {
      Nodes& nodes = nodes_[set];
      std::vector<std::vector<double>> of_set;
      std::vector<std::size_t> place;
      std::vector<GasColumn> chosen;
      for (std::size_t c = columns.size() > 1 ? set : 0; c < columns.size(); c += 2) {
        of_set.push_back(tested[c]);
        place.push_back(c);
      }
      const std::vector<double> weight = column_weights(of_set, sums, kTolerance, kNodes);
      for (std::size_t c = 0; c < weight.size(); ++c) {
        if (!(weight[c] > 0)) continue;
        chosen.push_back(columns[place[c]]);
        nodes.tests.push_back(of_set[c]);
      }
      if (auto status = prepare(chosen, nodes.column, nodes.here); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // What a band's emission is of the tests, by the nodes: as weights of tests.
  [[nodiscard]] std::vector<double> as_tests(std::size_t band) const {
    std::vector<std::vector<double>> of_test(ColumnTests::kCount);
    std::vector<double> emitted;
    for (const Nodes& nodes : nodes_)
      for (std::size_t m = 0; m < nodes.column.size(); ++m) {
        emitted.push_back(in_band(nodes.here[m].emitted_w_m2_sr_um, scene_.axis.band(band)));
        for (std::size_t t = 0; t < of_test.size(); ++t) of_test[t].push_back(nodes.tests[m][t]);
      }
    return column_weights(of_test, emitted, kTolerance, kNodes);
  }

  // Of each replicate: so many that what is sent is known well enough in every band, at the target.
  std::uint64_t samples(const std::vector<PathWeights>& pilot) {
    const AccuracySpec& accuracy = request_.accuracy;
    if (accuracy.samples_per_replicate > 0) return accuracy.samples_per_replicate;
    if (!(accuracy.relative_error > 0)) return plan_.samples_per_replicate;
    const auto scatter = [&](const std::vector<PathWeights>& weights) {
      double most = 0;
      for (std::size_t b = 0; b < scene_.axis.bands(); ++b) {
        const std::vector<double> tests = as_tests(b);
        ReplicateStatistics s(1);
        for (const PathWeights& w : weights)
          s.add(std::array{ordered_dot(w.gas_m2.data(), tests.data(), tests.size())});
        if (const Estimate e = s.estimate(0); e.value > 0)
          most = std::max(most, e.stderr_ / e.value);
      }
      return most;
    };
    const double first = scatter(run(gas_, kSurveySamples, 1, 0)), second = scatter(pilot);
    return samples_needed(kSurveySamples, first, kPilotSamples, second,
                          kShareOfGoal * accuracy.relative_error,
                          accuracy.max_samples_per_replicate);
  }

  // Of what is taken by a column of a class, by the nodes: in each band of the scene.
  void find_class_errors() {
    class_error_.assign(scene_.axis.bands(), 0.0);
    const Nodes& nodes = nodes_[0];
    for (std::size_t b = 0; b < class_error_.size(); ++b) {
      const BandOnAxis band = scene_.axis.band(b);
      double absorbed = 0, off = 0;
      for (std::size_t m = 0; m < nodes.column.size(); ++m) {
        const double w = nodes.weight[m], taken = in_band(nodes.here[m].absorbed, band);
        const auto [like, factor] = gas_->like(nodes.tests[m]);
        absorbed += w * taken;
        off += w * std::abs(factor * in_band(class_here_[like].absorbed, band) - taken);
      }
      class_error_[b] = absorbed > 0 ? off / absorbed : 0;
    }
  }

  // Tables of one first part: by class, then of what is beyond by class.
  void split_by_class() {
    const std::uint32_t firsts = 2 * gas_->classes();
    const double share = 1.0 / static_cast<double>(weights_.size());
    const std::size_t columns = weights_.front().weight.columns();
    mean_.assign(firsts, PathWeights{});
    for (PathWeights& w : mean_) w.weight = SourceWeights(1, layout_, columns);
    for (const PathWeights& replicate : weights_)
      for (std::uint32_t first = 0; first < firsts; ++first) {
        PathWeights& one = each_.emplace_back();
        one.weight = SourceWeights(1, layout_, columns);
        replicate.weight.for_each(first, layout_.all(), [&](SourceId id, const double* row) {
          double* to = one.weight.row(0, id);
          for (std::size_t k = 0; k < columns; ++k) to[k] = row[k];
        });
        mean_[first].weight.add(share, one.weight);
      }
  }

  // What is sent, by sets of nodes.
  struct Sent {
    double in_band = 0, bound = 0;
    std::vector<double> by_bin;
  };
  [[nodiscard]] Sent sent_by(const std::array<const std::vector<ColumnLight>*, 2>& light,
                             const BandOnAxis& band) const {
    const BandGrid& grid = band.grid;
    Sent out;
    out.by_bin.assign(grid.lambda_um.size(), 0.0);
    std::array<double, 2> of_set{};
    for (std::size_t set = 0; set < nodes_.size(); ++set)
      for (std::size_t m = 0; m < nodes_[set].column.size(); ++m) {
        const std::vector<double>& spectrum = (*light[set])[m].emitted_w_m2_sr_um;
        const double w = nodes_[set].weight[m];
        of_set[set] += w * in_band(spectrum, band);
        out.bound += 0.5 * w * kOfSteps * std::abs(in_band((*light[set])[m].step_w_m2_sr_um, band));
        for (std::size_t bin = 0; bin < out.by_bin.size(); ++bin)
          for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i)
            out.by_bin[bin] += 0.5 * w * grid.bin_weight[i] * spectrum[band.first_node + i];
      }
    out.in_band = 0.5 * (of_set[0] + of_set[1]);
    out.bound += std::abs(of_set[0] - of_set[1]);
    return out;
  }

  // What is taken of light behind the classes: its spectrum, and of each replicate's light the
  // share that the spectra say.
  struct Taken {
    std::vector<double> by_bin;  // all classes
    std::vector<double> share;   // [class] of what is behind it, in band
    double in_band = 0;
  };
  // Of evaluate()'s tables `stored` from `first` on: which spectrum, which in-band number. Inside a
  // bin the light is taken to have that shape.
  [[nodiscard]] Taken taken_by(const std::vector<ColumnLight>& gas,
                               const std::vector<std::vector<double>>& stored, std::size_t first,
                               std::size_t spectrum, std::size_t quantity, double sign,
                               const std::vector<double>& shape, const BandOnAxis& band) const {
    const BandGrid& grid = band.grid;
    const std::size_t bins = grid.lambda_um.size();
    Taken out{std::vector<double>(bins, 0.0), {}, 0};
    for (std::size_t k = 0; k < gas.size(); ++k) {
      const std::vector<double>& values = stored[first + k];
      const double* behind = values.data() + spectrum_quantity(1) + spectrum * bins;
      const double* absorbed = gas[k].absorbed.data() + band.first_node;
      double lost = 0, all = 0;
      for (std::size_t bin = 0; bin < bins; ++bin) {
        double of_bin = 0, shape_of_bin = 0, of_band = 0, shape_of_band = 0;
        for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i) {
          const double s = shape[band.first_node + i];
          of_bin += grid.bin_weight[i] * s * absorbed[i];
          shape_of_bin += grid.bin_weight[i] * s;
          of_band += grid.band_weight[i] * s * absorbed[i];
          shape_of_band += grid.band_weight[i] * s;
        }
        if (!(shape_of_bin > 0)) continue;
        const double per_shape = sign * behind[bin] / shape_of_bin;
        out.by_bin[bin] += per_shape * of_bin;
        lost += per_shape * of_band;
        all += per_shape * shape_of_band;
      }
      out.share.push_back(all != 0 ? lost / all : 0);
      out.in_band += out.share.back() * sign * values[quantity];
    }
    return out;
  }

  [[nodiscard]] GasRow row_of(const ConditionSources& light,
                              const std::array<std::vector<ColumnLight>, 2>& at_sensor,
                              const std::vector<ColumnLight>& classes_at_sensor,
                              const LitWeights& of_classes, const LitWeights& of_replicates,
                              std::uint32_t which_band) const {
    const BandOnAxis band = scene_.axis.band(which_band);
    const std::size_t classes = class_column_.size(), bins = band.grid.lambda_um.size(),
                      replicates = weights_.size();
    const SourceTable whole =
        source_table(light, scene_.path_basis(), band.first_node, band.grid.band_weight);
    std::vector<std::vector<double>> stored, in_bands;
    evaluate(light, 1, of_classes, scene_.path_basis(), band, whole, true, stored);
    evaluate(light, 1, of_replicates, scene_.path_basis(), band, whole, false, in_bands);

    const Sent here = sent_by({&nodes_[0].here, &nodes_[1].here}, band),
               seen = sent_by({at_sensor.data(), at_sensor.data() + 1}, band);
    constexpr std::size_t kTotal = 0, kApparent = 1 + kCauses, kContrast = 2 + kCauses;
    // At the sensor light is as the air lets it through.
    const std::vector<double> smooth(scene_.axis.nodes(), 1.0);
    const std::vector<double>& through = light.environment().transmittance;
    const Taken source = taken_by(class_here_, stored, 0, kTotal, 0, 1, smooth, band),
                apparent = taken_by(classes_at_sensor, stored, 0, kApparent, kApparentQuantity, 1,
                                    through, band),
                // Of what is beyond the contrast is all that there is, and negative.
        beyond = taken_by(classes_at_sensor, stored, classes, kContrast, contrast_quantity(1), -1,
                          through, band);

    const std::vector<double> tests = as_tests(which_band);
    std::vector<double> scatter;  // [replicate] of what is sent, over its mean
    double mean = 0;
    for (const PathWeights& w : weights_) {
      scatter.push_back(ordered_dot(w.gas_m2.data(), tests.data(), tests.size()));
      mean += scatter.back() / static_cast<double>(replicates);
    }
    struct Loss {
      const Taken& taken;
      std::size_t first, quantity;
      double sign;
    };
    const auto change = [&](const Sent& sent, std::initializer_list<Loss> losses) {
      Change c;
      ReplicateStatistics s(1 + bins);
      double lost_w_sr = 0;
      for (std::size_t r = 0; r < replicates; ++r) {
        const double share = mean > 0 ? scatter[r] / mean : 0;
        std::vector<double> value(1 + bins);
        value[0] = share * sent.in_band;
        for (std::size_t bin = 0; bin < bins; ++bin) value[1 + bin] = share * sent.by_bin[bin];
        for (const Loss& loss : losses) {
          double lost = 0;
          for (std::size_t k = 0; k < classes; ++k)
            lost += loss.taken.share[k] * loss.sign *
                    in_bands[r * 2 * classes + loss.first + k][loss.quantity];
          value[0] -= lost;
          // The spectrum of the mean, as much of it as this replicate has.
          const double part = loss.taken.in_band != 0 ? lost / loss.taken.in_band : 0;
          for (std::size_t bin = 0; bin < bins; ++bin)
            value[1 + bin] -= part * loss.taken.by_bin[bin];
          lost_w_sr += std::abs(lost) / static_cast<double>(replicates);
        }
        s.add(value);
        c.replicate.push_back(value[0]);
      }
      c.in_band = s.estimate(0);
      for (std::size_t bin = 0; bin < bins; ++bin) {
        c.spectral.value.push_back(s.estimate(1 + bin).value);
        c.spectral.stderr_.push_back(s.estimate(1 + bin).stderr_);
      }
      c.bound_w_sr = sent.bound + class_error_[which_band] * lost_w_sr;
      return c;
    };
    GasRow out;
    out.rays = counts_.rays;
    out.source = change(here, {{source, 0, 0, 1}});
    out.apparent = change(seen, {{apparent, 0, kApparentQuantity, 1}});
    out.contrast = change(
        seen, {{apparent, 0, kApparentQuantity, 1}, {beyond, classes, contrast_quantity(1), -1}});
    out.emitted_w_sr = here.in_band;
    out.apparent_emitted_w_sr = seen.in_band;
    // One model errs one way everywhere: its errors add up over columns and wavelengths.
    for (std::size_t set = 0; set < nodes_.size(); ++set)
      for (std::size_t m = 0; m < nodes_[set].column.size(); ++m)
        out.model_error_w_sr +=
            0.5 * nodes_[set].weight[m] * in_band(at_sensor[set][m].model_error_w_m2_sr_um, band);
    return out;
  }

  const PreparedScene& scene_;
  const ViewRequest& request_;
  const ViewPlan& plan_;
  const ViewSources& sources_;
  const GasWavelengths& wavelengths_;
  std::shared_ptr<const PlumeField> field_;
  AimedView aimed_;
  std::array<Nodes, 2> nodes_;
  std::vector<HotColumn> class_column_;
  std::vector<ColumnLight> class_here_;
  std::vector<double> class_error_;  // [band of the scene] relative, of what is taken
  std::shared_ptr<const GasOnView> gas_;
  std::vector<PathWeights> weights_;      // [replicate]
  std::vector<PathWeights> mean_, each_;  // [first]; [replicate][first]
  PathCounts counts_;
  SourceLayout layout_ = SourceLayout(scene_.target.part.size(), sources_.geometry());
};

// Gas that is hidden by the target.
GasRow nothing_of(std::size_t bins, std::size_t replicates) {
  GasRow out;
  for (Change* change : {&out.source, &out.apparent, &out.contrast}) {
    change->spectral.value.assign(bins, 0.0);
    change->spectral.stderr_.assign(bins, 0.0);
    change->replicate.assign(replicates, 0.0);
  }
  return out;
}

}  // namespace

absl::StatusOr<std::vector<std::optional<GasRow>>> gas_rows(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    std::shared_ptr<const PreparedView> view) {
  std::vector<const PlumeField*> field;
  for (const std::uint32_t c : request.selected_condition)
    if (const PlumeField* of_condition = request.condition[c].gas.get(); of_condition != nullptr)
      if (std::find(field.begin(), field.end(), of_condition) == field.end())
        field.push_back(of_condition);
  std::vector<std::optional<GasRow>> out;
  if (field.empty()) return out;
  const auto wavelengths = GasWavelengths::make(scene.axis.node_um());
  if (!wavelengths.ok()) return wavelengths.status();
  const std::size_t bands = request.selected_band.size();
  out.resize(request.selected_condition.size() * bands);
  const ViewSources sources({.condition = request.condition,
                             .wanted = request.selected_condition,
                             .parts = scene.target.part.size(),
                             .surface_z_m = scene.surface_z_m(),
                             .emitters = request.emitters},
                            plan.effects, {view, &view->environments}, scene.axis.node_um());
  for (const PlumeField* one : field) {
    std::optional<GasMeasurement> gas;
    bool unseen = false;
    for (std::size_t i = 0; i < request.selected_condition.size(); ++i) {
      const ConditionSpec& condition = request.condition[request.selected_condition[i]];
      if (condition.gas.get() != one) continue;
      if (!gas) {
        gas.emplace(scene, request, plan, sources, *wavelengths, condition.gas);
        const auto seen = gas->trace();
        if (!seen.ok()) return seen.status();
        if (!*seen) unseen = true;
      }
      if (unseen) {
        for (std::size_t b = 0; b < bands; ++b)
          out[i * bands + b] =
              nothing_of(scene.axis.band(request.selected_band[b]).grid.lambda_um.size(),
                         request.accuracy.replicates);
        continue;
      }
      auto rows = gas->rows(sources.wanted(i));
      if (!rows.ok()) return rows.status();
      for (std::size_t b = 0; b < bands; ++b) out[i * bands + b] = std::move((*rows)[b]);
    }
  }
  return out;
}

}  // namespace irsig

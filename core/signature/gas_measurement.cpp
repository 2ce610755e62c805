#include "core/signature/gas_measurement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/ordered_dot.h"
#include "core/base/status_macros.h"
#include "core/signature/aim_at_gas.h"
#include "core/signature/view/unseen.h"
#include "core/signature/view_seed.h"

namespace irsig {
namespace {

// Stages of a view's random numbers: other paths than those of the target's own light.
constexpr std::uint64_t kGasStage = 0x6a5, kHullStage = 0x6b5;
constexpr std::uint64_t kPicture = 4;  // after pilots, measurement and half resolution
// Of the error that is asked for, what the gas's own samples may take.
constexpr double kShareOfGoal = 0.5;
// Columns that stand for all: so near to what the tests of all rays are, and at most so many; and
// classes of gas, so many, or until every column is so nearly a sum of them.
constexpr double kTolerance = 1e-3, kToleranceOfGoal = 0.1, kAlike = 1e-3;
constexpr std::size_t kNodes = 24, kClasses = 6;
// Columns for what the hull reflects, a small part of what is sent.
constexpr std::size_t kNodesOnHull = 8;
// Samples of a replicate that see the field and its half resolution: of their difference two digits
// are known.
constexpr std::uint64_t kVoxelSamples = 64;
// Reflected rays of each first vertex, where those alone count that meet gas.
constexpr std::uint32_t kSplit = 4;

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
         {static_cast<double>(point.thin_w[0]), static_cast<double>(point.thin_w[1])},
         static_cast<double>(point.amount_mol)});
  return out;
}

}  // namespace

GasMeasurement::GasMeasurement(Where where, const GasInView& given,
                               std::shared_ptr<const PlumeField> field,
                               std::vector<std::size_t> condition)
    : on_hull_(where == Where::kOnHull),
      pilots_(on_hull_ ? PilotSamples{64, 32, 128} : PilotSamples{32, 32, 64}),
      given_(given),
      field_(std::move(field)),
      condition_(std::move(condition)),
      aimed_(on_hull_ ? std::make_shared<const AimedView>(
                            aim_at_gas(given.scene.target, *given.view.aimed, *field_))
                      : nullptr) {}

absl::StatusOr<bool> GasMeasurement::find() {
  if (!on_hull_) {
    ASSIGN_OR_RETURN(auto boxed, make_boxed_view(given_.scene.target, given_.request.viewpoint,
                                                 sight_of(*field_)));
    aimed_ = std::make_shared<const AimedView>(std::move(boxed.view));
    sight_ = std::move(boxed.sight);
  }
  const auto survey = std::make_shared<const ColumnCollector>(field_, given_.scene.target.centre);
  traced_.samples = pilots_.survey;
  run(survey, *aimed_, traced_.samples, 0, reflections(true));
  if (on_hull_ && survey->columns().empty() &&
      given_.plan.samples_per_replicate > traced_.samples) {
    // Rarely met, or never: as many as the target's own light gets.
    traced_.samples = given_.plan.samples_per_replicate;
    run(survey, *aimed_, traced_.samples, 0, reflections(true));
  }
  if (survey->columns().empty()) return false;
  const ColumnTests tests = ColumnTests::of(survey->columns());
  std::vector<std::vector<double>> tested;
  for (const GasColumn& column : survey->columns())
    tests.test(column, tested.emplace_back(ColumnTests::kCount));
  RETURN_IF_ERROR(choose_classes(survey->columns(), tested, tests));
  std::vector<PathWeights> pilot = run(gas_, *aimed_, pilots_.second, 1, reflections(true)).weights;
  RETURN_IF_ERROR(choose_nodes(survey->columns(), tested, sum_of(pilot)));
  traced_.samples = pilots_.second;
  const std::vector<double> sums = sum_of(pilot);
  if (!on_hull_) {
    gas_ = std::make_shared<const GasOnView>(field_, given_.scene.target.centre, tests,
                                             columns_.most_absorbed, columns_.class_tests, thick());
    RETURN_IF_ERROR(find_voxel_errors(tests));
  }
  keep(std::move(pilot));
  if (!on_hull_) {
    ASSIGN_OR_RETURN(images_.plan, plan_images(sums));
  }
  return true;
}

void GasMeasurement::measure(const std::vector<double>& sent_w_sr) {
  const std::uint64_t of_pilot = traced_.samples;
  traced_.samples = samples(sent_w_sr);
  // A pilot that has as many samples as are taken at most is a measurement: no result of its own
  // has decided their number.
  if (!on_hull_ || traced_.samples != of_pilot || traced_.samples < most_samples())
    keep(run(gas_, *aimed_, traced_.samples, 2, reflections(false)).weights);
  if (!images_.plan.empty()) {
    images_.pixel_samples = gas_picture_settings({}, images_.plan).pixel_samples;
    images_.traced =
        run(gas_, whole_view(*aimed_), 1, kPicture, reflections(false), images_.plan).pictures;
  }
  traced_.is_measurement = true;
}

double GasMeasurement::unmet_m2() const {
  double area_m2 = 0;
  for (std::uint32_t s = 0; s < aimed_->stratum.size(); ++s)
    if (!aimed_->stratum[s].empty())
      area_m2 +=
          aimed_->stratum[s].area_m2() / static_cast<double>(aimed_->samples(s, traced_.samples) *
                                                             given_.request.accuracy.replicates);
  return kNoneSeen * area_m2 / (kSplit * kEvenAtGas);
}

std::vector<double> GasMeasurement::sent_w_sr() const {
  std::vector<double> out;
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b)
    out.push_back(
        sent_by({&columns_.nodes[0].here, &columns_.nodes[1].here}, given_.scene.axis.band(b))
            .in_band);
  return out;
}

TracedView GasMeasurement::run(std::shared_ptr<const RayMedium> gas, const AimedView& view,
                               std::uint64_t samples, std::uint64_t stage,
                               std::uint32_t reflections, const ImagePlan& pictures) {
  SourceGeometry geometry = given_.sources.geometry();
  if (on_hull_)
    geometry.medium = HotGasAround{std::move(gas)};
  else
    geometry.medium = HotGasMedium{std::move(gas)};
  PathSettings settings = path_settings(
      given_.request.accuracy, given_.plan.effects,
      view_seed(given_.scene, given_.request) + (on_hull_ ? kHullStage : kGasStage) + stage,
      samples);
  settings.max_reflections = reflections;
  if (on_hull_) {
    // Hardly any reflected ray meets gas, and those are all that counts.
    settings.roulette_survival_scale = 8;
    settings.split = kSplit;
  }
  if (!pictures.empty()) settings = gas_picture_settings(settings, pictures);
  TracedView traced = trace_view(given_.scene, view, geometry, settings, pictures);
  traced_.rays += traced.counts.rays;
  return traced;
}

PathSettings GasMeasurement::gas_picture_settings(const PathSettings& settings,
                                                  const ImagePlan& pictures) const {
  PathSettings out = picture_settings(settings, pictures);
  // Gas changes little within a pixel, and each of its rays is marched.
  if (!given_.request.image && out.pixel_samples > kLeastPixelSamples)
    out = picture_settings(settings, pictures, out.pixel_samples / 2);
  return out;
}

std::uint32_t GasMeasurement::reflections(bool pilot) const {
  if (on_hull_) return std::max(1u, given_.plan.effects.max_reflections);
  return pilot ? 0 : given_.plan.effects.max_reflections;
}

std::vector<double> GasMeasurement::sum_of(const std::vector<PathWeights>& weights,
                                           std::size_t first, std::size_t groups) {
  std::vector<double> out(ColumnTests::kCount, 0.0);
  for (const PathWeights& w : weights)
    for (std::size_t g = first; g < first + groups; ++g)
      for (std::size_t t = 0; t < out.size(); ++t)
        out[t] += w.gas_m2[g * out.size() + t] / static_cast<double>(weights.size());
  return out;
}

std::vector<double> GasMeasurement::sum_of(const std::vector<PathWeights>& weights) const {
  return sum_of(weights, 0, groups());
}

std::vector<double> GasMeasurement::reflected(std::size_t group) const {
  std::vector<double> out(given_.scene.axis.nodes(), 1.0);
  const SpectralBasis* basis = given_.scene.path_basis();
  if (!on_hull_ || basis == nullptr) return out;
  const std::size_t columns = basis->columns();
  std::vector<double> carried(columns, 0.0);
  double seen = 0;
  for (const PathWeights& w : traced_.weights) {
    for (std::size_t k = 0; k < columns; ++k) carried[k] += w.gas_nodes_m2[group * columns + k];
    seen += w.gas_seen_m2[group];
  }
  if (!(seen > 0)) return out;
  for (double& c : carried) c /= seen;
  basis->to_nodes(carried.data(), 0, out);
  return out;
}

void GasMeasurement::keep(std::vector<PathWeights> weights) {
  traced_.weights = std::move(weights);
  for (Nodes& nodes : columns_.nodes) {
    nodes.weight.assign(nodes.tests.size(), std::vector<double>(given_.scene.axis.nodes(), 0.0));
    nodes.misfit.assign(ColumnTests::kCount, 0.0);
  }
  columns_.reflected.clear();
  for (std::size_t g = 0; g < groups(); ++g) {
    const std::vector<double> sums = sum_of(traced_.weights, g, 1);
    columns_.reflected.push_back(reflected(g));
    if (!std::any_of(sums.begin(), sums.end(), [](double s) { return s > 0; })) continue;
    for (Nodes& nodes : columns_.nodes) {
      const std::vector<double> weight = column_weights(nodes.tests, sums, 0, nodes.tests.size());
      const std::vector<double> misfit = column_misfit(nodes.tests, weight, sums);
      for (std::size_t t = 0; t < misfit.size(); ++t) nodes.misfit[t] += misfit[t];
      for (std::size_t m = 0; m < weight.size(); ++m)
        for (std::size_t i = 0; i < columns_.reflected[g].size(); ++i)
          nodes.weight[m][i] += weight[m] * columns_.reflected[g][i];
    }
  }
  find_class_errors();
  errors_.columns.clear();
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b)
    errors_.columns.push_back({misfit_relative(b) + missed(b, traced_.samples), luck_relative(b)});
  split_by_class();
}

absl::Status GasMeasurement::prepare(const std::vector<GasColumn>& columns,
                                     std::vector<HotColumn>& hot,
                                     std::vector<ColumnLight>& here) const {
  for (const GasColumn& column : columns) {
    ASSIGN_OR_RETURN(auto made, HotColumn::make(column, given_.wavelengths));
    here.push_back(made.at_near_end());
    hot.push_back(std::move(made));
  }
  return absl::OkStatus();
}

absl::Status GasMeasurement::choose_classes(const std::vector<GasColumn>& columns,
                                            const std::vector<std::vector<double>>& tested,
                                            const ColumnTests& tests) {
  std::vector<std::vector<double>>& classes = columns_.class_tests;
  std::vector<GasColumn> of_class;
  std::size_t next = 0;
  const auto size = [&](std::size_t c) {
    const auto a = ColumnTests::absorbed(tested[c]);
    return ordered_dot(a.data(), a.data(), a.size());
  };
  GasOnView::Absorbed& most = columns_.most_absorbed;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (size(c) > size(next)) next = c;
    const auto absorbed = ColumnTests::absorbed(tested[c]);
    for (std::size_t g = 0; g < most.size(); ++g) most[g] = std::max(most[g], absorbed[g]);
  }
  double unlike = 1;
  while (classes.size() < kClasses && unlike > kAlike) {
    classes.push_back(tested[next]);
    of_class.push_back(columns[next]);
    gas_ =
        std::make_shared<const GasOnView>(field_, given_.scene.target.centre, tests, most, classes);
    unlike = 0;
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (const double of_column = gas_->shares(tested[c]).unlike; of_column > unlike) {
        unlike = of_column;
        next = c;
      }
  }
  return prepare(of_class, columns_.class_column, columns_.class_here);
}

absl::Status GasMeasurement::choose_nodes(const std::vector<GasColumn>& columns,
                                          const std::vector<std::vector<double>>& tested,
                                          const std::vector<double>& sums) {
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set) {
    Nodes& nodes = columns_.nodes[set];
    std::vector<std::vector<double>> of_set;
    std::vector<std::size_t> place;
    std::vector<GasColumn> chosen;
    for (std::size_t c = columns.size() > 1 ? set : 0; c < columns.size(); c += 2) {
      of_set.push_back(tested[c]);
      place.push_back(c);
    }
    const double asked = given_.request.accuracy.relative_error,
                 tolerance =
                     asked > 0 ? std::min(kTolerance, kToleranceOfGoal * asked) : kTolerance;
    const std::vector<double> weight =
        column_weights(of_set, sums, tolerance, on_hull_ ? kNodesOnHull : kNodes);
    for (std::size_t c = 0; c < weight.size(); ++c) {
      if (!(weight[c] > 0)) continue;
      chosen.push_back(columns[place[c]]);
      nodes.tests.push_back(of_set[c]);
    }
    RETURN_IF_ERROR(prepare(chosen, nodes.column, nodes.here));
  }
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b)
    columns_.band_tests.push_back(tests_of({&columns_.nodes[0], &columns_.nodes[1]}, b));
  return absl::OkStatus();
}

std::vector<double> GasMeasurement::tests_of(std::initializer_list<const Nodes*> sets,
                                             std::size_t band) const {
  std::vector<std::vector<double>> of_test(ColumnTests::kCount);
  std::vector<double> emitted;
  for (const Nodes* nodes : sets)
    for (std::size_t m = 0; m < nodes->column.size(); ++m) {
      emitted.push_back(in_band(nodes->here[m].emitted_w_m2_sr_um, given_.scene.axis.band(band)));
      for (std::size_t t = 0; t < of_test.size(); ++t) of_test[t].push_back(nodes->tests[m][t]);
    }
  return column_weights(of_test, emitted, kTolerance, kNodes);
}

std::vector<double> GasMeasurement::tests_of(
    const std::array<const std::vector<ColumnLight>*, 2>& light, std::size_t band) const {
  std::vector<std::vector<double>> of_test(ColumnTests::kCount);
  std::vector<double> emitted;
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set)
    for (std::size_t m = 0; m < columns_.nodes[set].column.size(); ++m) {
      emitted.push_back(in_band((*light[set])[m].emitted_w_m2_sr_um, given_.scene.axis.band(band)));
      for (std::size_t t = 0; t < of_test.size(); ++t)
        of_test[t].push_back(columns_.nodes[set].tests[m][t]);
    }
  return column_weights(of_test, emitted, kTolerance, kNodes);
}

double GasMeasurement::luck_relative(std::size_t which_band) const {
  const BandOnAxis band = given_.scene.axis.band(which_band);
  double all = 0, square = 0;
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set) {
    const Nodes &own = columns_.nodes[set], &other = columns_.nodes[1 - set];
    if (own.column.empty() || other.column.empty()) continue;
    const std::vector<double> map = tests_of({&other}, which_band);
    for (std::size_t m = 0; m < own.column.size(); ++m) {
      const double weight = mean_of(own.weight[m], band),
                   sent = in_band(own.here[m].emitted_w_m2_sr_um, band),
                   off = weight * (sent - ordered_dot(map.data(), own.tests[m].data(), map.size()));
      all += weight * sent;
      square += off * off;
    }
  }
  // The error is that of the mean of both sets.
  return all > 0 ? std::sqrt(square) / all : 0;
}

std::vector<double> GasMeasurement::sent_by_replicates(const std::vector<PathWeights>& weights,
                                                       std::size_t which_band) const {
  const std::vector<double>& tests = columns_.band_tests[which_band];
  const BandOnAxis band = given_.scene.axis.band(which_band);
  std::vector<double> of_group;
  for (const std::vector<double>& r : columns_.reflected) {
    double mean = 0;
    for (std::size_t i = 0; i < band.nodes(); ++i)
      mean += r[band.first_node + i] / static_cast<double>(band.nodes());
    of_group.push_back(mean);
  }
  std::vector<double> out;
  for (const PathWeights& w : weights) {
    double& sum = out.emplace_back(0.0);
    for (std::size_t g = 0; g < of_group.size(); ++g)
      sum +=
          of_group[g] * ordered_dot(w.gas_m2.data() + g * tests.size(), tests.data(), tests.size());
  }
  return out;
}

ThickGas GasMeasurement::thick() const {
  ThickGas out{given_.request.plume_area_optical_depth, {}};
  const std::vector<double> flat(given_.scene.axis.nodes(), 1.0);
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b) {
    const BandOnAxis band = given_.scene.axis.band(b);
    std::vector<std::vector<double>> of_gas(ColumnTests::kGases);
    std::vector<double> absorbed;
    const auto add = [&](const ColumnLight& light, std::span<const double> tests) {
      absorbed.push_back(in_band(light.absorbed, band) / in_band(flat, band));
      const auto of_column = ColumnTests::absorbed(tests);
      for (std::size_t g = 0; g < of_gas.size(); ++g) of_gas[g].push_back(of_column[g]);
    };
    for (const Nodes& nodes : columns_.nodes)
      for (std::size_t m = 0; m < nodes.column.size(); ++m) add(nodes.here[m], nodes.tests[m]);
    for (std::size_t k = 0; k < columns_.class_here.size(); ++k)
      add(columns_.class_here[k], columns_.class_tests[k]);
    const std::vector<double> weight = column_weights(of_gas, absorbed, kTolerance, kNodes);
    std::copy(weight.begin(), weight.end(), out.weight.emplace_back().begin());
  }
  return out;
}

absl::Status GasMeasurement::find_voxel_errors(const ColumnTests& tests) {
  const auto& half = field_->at_half_resolution();
  if (!half.ok()) return half.status();
  // Larger voxels reach further; not as far as to refuse a view.
  BoxedSight sight = sight_of(*field_);
  for (auto& box : sight_of(**half).box) sight.box.push_back(box);
  const auto wider = make_boxed_view(given_.scene.target, given_.request.viewpoint, sight);
  const AimedView& view = wider.ok() ? wider->view : *aimed_;
  const auto sent = [&](const std::shared_ptr<const PlumeField>& field) {
    return run(std::make_shared<const GasOnView>(field, given_.scene.target.centre, tests,
                                                 columns_.most_absorbed, columns_.class_tests),
               view, kVoxelSamples, 3, 0)
        .weights;
  };
  const std::vector<PathWeights> fine = sent(field_), coarse = sent(*half);
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b) {
    const std::vector<double>& band = columns_.band_tests[b];
    ReplicateStatistics s(2);
    for (std::size_t r = 0; r < fine.size(); ++r) {
      const double of_fine = ordered_dot(fine[r].gas_m2.data(), band.data(), band.size());
      s.add(std::array{of_fine,
                       ordered_dot(coarse[r].gas_m2.data(), band.data(), band.size()) - of_fine});
    }
    const Estimate change = s.estimate(1);
    const double all = s.estimate(0).value;
    errors_.voxels.push_back(all > 0 ? std::hypot(change.value, change.stderr_) / all : 0);
  }
  return absl::OkStatus();
}

std::uint64_t GasMeasurement::most_samples() const {
  const std::uint64_t most = given_.request.accuracy.max_samples_per_replicate;
  // Light that the hull reflects of the gas gets no more samples than its other reflected light.
  return on_hull_ ? std::min(most, std::max(pilots_.second, given_.plan.samples_per_replicate))
                  : most;
}

std::uint64_t GasMeasurement::samples(const std::vector<double>& also_sent_w_sr) {
  const AccuracySpec& accuracy = given_.request.accuracy;
  if (accuracy.samples_per_replicate > 0) return accuracy.samples_per_replicate;
  if (!(accuracy.relative_error > 0)) return given_.plan.samples_per_replicate;
  const std::vector<double> sent = sent_w_sr();
  const auto scatter = [&](const std::vector<PathWeights>& weights) {
    double most = 0;
    for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b) {
      ReplicateStatistics s(1);
      for (const double sum : sent_by_replicates(weights, b)) s.add(std::array{sum});
      const Estimate e = s.estimate(0);
      if (!(e.value > 0)) continue;
      const double also = also_sent_w_sr.empty() ? 0 : also_sent_w_sr[b];
      most = std::max(most, e.stderr_ / e.value * sent[b] / (sent[b] + also));
    }
    return most;
  };
  const double goal = kShareOfGoal * accuracy.relative_error, second = scatter(traced_.weights);
  const std::uint64_t limit = most_samples();
  // The fall of the scatter with the samples is not computed where it changes nothing.
  std::uint64_t out = std::min(pilots_.second, limit);
  if (limit > pilots_.second &&
      samples_needed(pilots_.first, second, pilots_.second, second, goal, limit) > pilots_.second)
    out = samples_needed(pilots_.first,
                         scatter(run(gas_, *aimed_, pilots_.first, 1, reflections(true)).weights),
                         pilots_.second, second, goal, limit);
  for (std::size_t b = 0; b < given_.scene.axis.bands(); ++b) {
    const double also = also_sent_w_sr.empty() ? 0 : also_sent_w_sr[b];
    while (out < limit && missed(b, out) * sent[b] > goal * (sent[b] + also))
      out = std::min(limit, out + out / 2);
  }
  return out;
}

double GasMeasurement::missed(std::size_t which_band, std::uint64_t samples) const {
  if (!sight_) return 0;
  // SightShares::kOpticalDepth of each of the test gases' optical depths, 0.1 to 10^4.
  constexpr std::array<std::size_t, ColumnTests::kDepths> kDepth = {0, 1, 2, 3, 4, 4};
  const std::vector<double>& tests = columns_.band_tests[which_band];
  const std::vector<double> sums = sum_of(traced_.weights);
  std::array<std::array<double, ColumnTests::kLambdas>, SightShares::kOpticalDepth.size()> sent{};
  double all = 0;
  for (std::size_t gas = 0; gas < ColumnTests::kGases; ++gas)
    for (std::size_t l = 0; l < ColumnTests::kLambdas; ++l) {
      const std::size_t test = gas * (ColumnTests::kLambdas + 1) + l;
      sent[kDepth[ColumnTests::depth_of(gas)]][l] += tests[test] * sums[test];
      all += tests[test] * sums[test];
    }
  const double rays = static_cast<double>(samples * traced_.weights.size());
  double out = 0;
  for (std::size_t depth = 0; depth < sent.size(); ++depth)
    for (std::size_t l = 0; l < ColumnTests::kLambdas; ++l)
      if (sent[depth][l] > 0) out += sent[depth][l] / all * sight_->missed(depth, l, rays);
  return out;
}

void GasMeasurement::find_class_errors() {
  errors_.classes.assign(given_.scene.axis.bands(), 0.0);
  const Nodes& nodes = columns_.nodes[0];
  for (std::size_t b = 0; b < errors_.classes.size(); ++b) {
    const BandOnAxis band = given_.scene.axis.band(b);
    double absorbed = 0, off = 0;
    for (std::size_t m = 0; m < nodes.column.size(); ++m) {
      const double w = mean_of(nodes.weight[m], band),
                   taken = in_band(nodes.here[m].absorbed, band);
      const GasOnView::Shares shares = gas_->shares(nodes.tests[m]);
      double by_classes = 0;
      for (std::size_t k = 0; k < columns_.class_here.size(); ++k)
        by_classes += shares.of_class[k] * in_band(columns_.class_here[k].absorbed, band);
      absorbed += w * taken;
      off += w * std::abs(by_classes - taken);
    }
    errors_.classes[b] = absorbed > 0 ? off / absorbed : 0;
  }
}

void GasMeasurement::split_by_class() {
  const std::uint32_t firsts = class_tables();
  const double share = 1.0 / static_cast<double>(traced_.weights.size());
  const std::size_t columns = traced_.weights.front().weight.columns();
  traced_.each.clear();
  traced_.mean.assign(firsts, PathWeights{});
  for (PathWeights& w : traced_.mean) w.weight = SourceWeights(1, layout_, columns);
  for (const PathWeights& replicate : traced_.weights)
    for (std::uint32_t first = 0; first < firsts; ++first) {
      PathWeights& one = traced_.each.emplace_back();
      one.weight = SourceWeights(1, layout_, columns);
      replicate.weight.for_each(first, layout_.all(), [&](SourceId id, const double* row) {
        double* to = one.weight.row(0, id);
        for (std::size_t k = 0; k < columns; ++k) to[k] = row[k];
      });
      traced_.mean[first].weight.add(share, one.weight);
    }
}

}  // namespace irsig

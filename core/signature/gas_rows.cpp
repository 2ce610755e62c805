#include "core/signature/gas_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
#include "core/signature/unseen.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

// Stages of a view's random numbers: other paths than those of the target's own light.
constexpr std::uint64_t kGasStage = 0x6a5, kHullStage = 0x6b5;
// Of each replicate: rays that are aimed at the gas, and those that may meet it after the hull.
struct PilotSamples {
  std::uint64_t survey, first, second;
};
constexpr PilotSamples kSightPilots{32, 32, 64}, kHullPilots{64, 32, 128};
// Of the error that is asked for, what the gas's own samples may take.
constexpr double kShareOfGoal = 0.5;
// Columns that stand for all: so near to what the tests of all rays are, and at most so many; and
// classes of gas, so many, or until every column is so nearly a sum of them.
constexpr double kTolerance = 1e-3, kAlike = 1e-3;
// What may be left of steps that were extrapolated, of the extrapolation.
constexpr double kOfSteps = 0.25;
constexpr std::size_t kNodes = 24, kClasses = 6;
// Reflected rays of each first vertex, where those alone count that meet gas.
constexpr std::uint32_t kSplit = 4;
constexpr double kSigmas = 4;

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

// One field of gas in one view: as it is seen, and behind it what else is; or as the target
// reflects it, and what it takes on its way of other light that the target reflects.
class GasMeasurement {
 public:
  enum class Where : std::uint8_t { kInSight, kOnHull };
  // view: of the target itself. condition: those of the selected ones that have this field
  GasMeasurement(Where where, const PreparedScene& scene, const ViewRequest& request,
                 const ViewPlan& plan, const PreparedView& view, const ViewSources& sources,
                 const GasWavelengths& wavelengths, const PictureFrame& pictures,
                 std::shared_ptr<const PlumeField> field, std::vector<std::size_t> condition)
      : on_hull_(where == Where::kOnHull),
        pilots_(on_hull_ ? kHullPilots : kSightPilots),
        scene_(scene),
        request_(request),
        plan_(plan),
        sources_(sources),
        wavelengths_(wavelengths),
        pictures_(pictures),
        field_(std::move(field)),
        condition_(std::move(condition)),
        aimed_(on_hull_ ? view.aimed : nullptr) {}

  // Chooses what stands for all rays, and knows the pilot's. False: the gas is not met at all.
  absl::StatusOr<bool> find() {
    if (!on_hull_) {
      auto aimed = make_boxed_view(scene_.target, request_.viewpoint, sight_of(*field_));
      if (!aimed.ok()) return aimed.status();
      aimed_ = std::make_shared<const AimedView>(*std::move(aimed));
    }
    const auto survey = std::make_shared<const GasSurvey>(field_, scene_.target.centre);
    samples_ = pilots_.survey;
    run(survey, samples_, 0, reflections(true));
    if (on_hull_ && survey->columns().empty() && plan_.samples_per_replicate > samples_) {
      // Rarely met, or never: as many as the target's own light gets.
      samples_ = plan_.samples_per_replicate;
      run(survey, samples_, 0, reflections(true));
    }
    if (survey->columns().empty()) return false;
    const ColumnTests tests = tests_for(survey->columns());
    std::vector<std::vector<double>> tested;
    for (const GasColumn& column : survey->columns())
      tests.test(column, tested.emplace_back(ColumnTests::kCount));
    if (auto status = choose_classes(survey->columns(), tested, tests); !status.ok()) return status;
    std::vector<PathWeights> pilot = run(gas_, pilots_.second, 1, reflections(true));
    if (auto status = choose_nodes(survey->columns(), tested, sum_of(pilot)); !status.ok())
      return status;
    samples_ = pilots_.second;
    const std::vector<double> sums = sum_of(pilot);
    if (!on_hull_) {
      gas_ = std::make_shared<const GasOnView>(field_, scene_.target.centre, tests, most_absorbed_,
                                               class_tests_, thick());
      if (auto status = find_voxel_errors(tests); !status.ok()) return status;
    }
    keep(std::move(pilot));
    if (!on_hull_) image_plan_ = plan_images(sums);
    return true;
  }
  // With as many rays as the accuracy asks for. sent_w_sr: what else the gas sends in each band of
  // the scene, which the error may be a share of.
  void measure(const std::vector<double>& sent_w_sr) {
    samples_ = samples(sent_w_sr);
    image_.assign(image_plan_.size(), 0.0);
    keep(run(gas_, *aimed_, samples_, 2, reflections(false), image_plan_, image_));
  }

  [[nodiscard]] std::uint64_t rays() const { return counts_.rays; }
  // Where find() has met no gas: the most that may be reflected of it. [m2]
  [[nodiscard]] double unmet_m2() const {
    double area_m2 = 0;
    for (std::uint32_t s = 0; s < aimed_->stratum.size(); ++s)
      if (!aimed_->stratum[s].empty())
        area_m2 += aimed_->stratum[s].area_m2() /
                   static_cast<double>(aimed_->samples(s, samples_) * request_.accuracy.replicates);
    return kNoneSeen * area_m2 / kSplit;
  }
  // In each band of the scene, at the target. [W/sr]
  [[nodiscard]] std::vector<double> sent_w_sr() const {
    std::vector<double> out;
    for (std::size_t b = 0; b < scene_.axis.bands(); ++b)
      out.push_back(sent_by({&nodes_[0].here, &nodes_[1].here}, scene_.axis.band(b)).in_band);
    return out;
  }

  // which: of its conditions
  absl::StatusOr<std::vector<GasRow>> rows(std::size_t which) const {
    const ConditionSources& light = sources_.wanted(condition_[which]);
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
    Sensor sensor{
        {at_sensor(nodes_[0].column, nodes_[0].here), at_sensor(nodes_[1].column, nodes_[1].here)},
        {nodes_[0].here, nodes_[1].here},
        at_sensor(class_column_, class_here_)};
    for (std::vector<ColumnLight>& columns : sensor.product)
      for (ColumnLight& column : columns)
        for (std::size_t i = 0; i < environment.transmittance.size(); ++i)
          column.emitted_w_m2_sr_um[i] *= environment.transmittance[i];
    const LitWeights of_classes(light, mean_, 1), of_replicates(light, each_, 1);
    std::vector<GasRow> out;
    for (const std::uint32_t b : request_.selected_band)
      out.push_back(row_of(light, sensor, of_classes, of_replicates, b));
    if (image_.empty()) return out;
    const std::size_t pixels =
        static_cast<std::size_t>(image_plan_.width_px) * image_plan_.height_px;
    for (std::size_t b = 0; b < out.size(); ++b)
      for (std::size_t i = 0; i < pixels; ++i)
        out[b].picture_w_sr.push_back(image_[i * image_plan_.padded + which * out.size() + b]);
    return out;
  }

 private:
  // Columns whose weighted spectra add up to those of all rays. Two sets that have no column in
  // common: their difference shows what so few columns cost.
  struct Nodes {
    std::vector<HotColumn> column;
    std::vector<std::vector<double>> tests;
    std::vector<ColumnLight> here;            // at the target
    std::vector<std::vector<double>> weight;  // [node][wavelength] [m2]
  };

  // Gas behind the air of a condition.
  struct Sensor {
    std::array<std::vector<ColumnLight>, 2> nodes;
    std::array<std::vector<ColumnLight>, 2> product;  // as if cold and hot lines were independent
    std::vector<ColumnLight> classes;
  };

  std::vector<PathWeights> run(std::shared_ptr<const GasOnRays> gas, std::uint64_t samples,
                               std::uint64_t stage, std::uint32_t reflections) {
    std::vector<double> none;
    return run(std::move(gas), *aimed_, samples, stage, reflections, {}, none);
  }
  std::vector<PathWeights> run(std::shared_ptr<const GasOnRays> gas, const AimedView& view,
                               std::uint64_t samples, std::uint64_t stage,
                               std::uint32_t reflections, const ImagePlan& images,
                               std::vector<double>& image) {
    SourceGeometry geometry = sources_.geometry();
    if (on_hull_)
      geometry.medium = HotGasAround{std::move(gas)};
    else
      geometry.medium = HotGasMedium{std::move(gas)};
    PathSettings settings = path_settings(
        request_.accuracy, plan_.effects,
        view_seed(scene_, request_) + (on_hull_ ? kHullStage : kGasStage) + stage, samples);
    settings.max_reflections = reflections;
    if (on_hull_) {
      // Hardly any reflected ray meets gas, and those are all that counts.
      settings.persistence = 8;
      settings.split = kSplit;
    }
    const PathTracer tracer(scene_.target, scene_.carried_material(), view, std::move(geometry),
                            settings);
    return tracer.trace(images, image, counts_);
  }

  // Pictures of the rows' source radiance: of what a ray's gas sends as much as its test gases say,
  // so that all rays of the pilot send what the nodes do; of what is behind it less what its
  // classes take.
  //   sums  of the pilot's tests, which the nodes' weights are of
  [[nodiscard]] ImagePlan plan_images(const std::vector<double>& sums) const {
    const std::size_t bands = request_.selected_band.size(), classes = class_here_.size();
    ImagePlan plan = blank_pictures(pictures_, aimed_->frame, condition_.size() * bands, classes,
                                    layout_, scene_.path_basis());
    if (plan.empty()) return plan;
    plan.gas.assign(plan.images * gas_->measures(), 0.0);
    for (std::size_t b = 0; b < bands; ++b) {
      const BandOnAxis band = scene_.axis.band(request_.selected_band[b]);
      std::vector<double> sent = as_tests(request_.selected_band[b]);
      if (const double all = ordered_dot(sent.data(), sums.data(), sent.size()); all > 0) {
        const double scale = sent_by({&nodes_[0].here, &nodes_[1].here}, band).in_band / all;
        for (double& s : sent) s *= scale;
      }
      for (std::size_t c = 0; c < condition_.size(); ++c)
        std::copy(
            sent.begin(), sent.end(),
            plan.gas.begin() + static_cast<std::ptrdiff_t>((c * bands + b) * gas_->measures()));
      std::vector<double> taken(band.grid.band_weight.size());
      for (std::size_t k = 0; k < classes; ++k) {
        for (std::size_t i = 0; i < taken.size(); ++i)
          taken[i] = -band.grid.band_weight[i] * class_here_[k].absorbed[band.first_node + i];
        for (std::size_t c = 0; c < condition_.size(); ++c) {
          const ConditionSources& light = sources_.wanted(condition_[c]);
          show_sources(source_table(light, scene_.path_basis(), band.first_node, taken), light,
                       layout_, scene_.path_basis(), c * bands + b, k, plan);
        }
      }
    }
    return plan;
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

  [[nodiscard]] std::uint32_t reflections(bool pilot) const {
    if (on_hull_) return std::max(1u, plan_.effects.max_reflections);
    return pilot ? 0 : plan_.effects.max_reflections;
  }

  // Of gas that is reflected: by each part that is seen.
  [[nodiscard]] std::size_t groups() const { return on_hull_ ? scene_.target.part.size() : 1; }

  // Means over replicates, of one group or of all.
  static std::vector<double> sum_of(const std::vector<PathWeights>& weights, std::size_t first,
                                    std::size_t groups) {
    std::vector<double> out(ColumnTests::kCount, 0.0);
    for (const PathWeights& w : weights)
      for (std::size_t g = first; g < first + groups; ++g)
        for (std::size_t t = 0; t < out.size(); ++t)
          out[t] += w.gas_m2[g * out.size() + t] / static_cast<double>(weights.size());
    return out;
  }
  [[nodiscard]] std::vector<double> sum_of(const std::vector<PathWeights>& weights) const {
    return sum_of(weights, 0, groups());
  }

  // What a group's reflections are at each wavelength of the mean that its tests were weighted
  // with.
  [[nodiscard]] std::vector<double> reflected(std::size_t group) const {
    std::vector<double> out(scene_.axis.nodes(), 1.0);
    const SpectralBasis* basis = scene_.path_basis();
    if (!on_hull_ || basis == nullptr) return out;
    const std::size_t columns = basis->columns();
    std::vector<double> carried(columns, 0.0);
    double seen = 0;
    for (const PathWeights& w : weights_) {
      for (std::size_t k = 0; k < columns; ++k) carried[k] += w.gas_nodes_m2[group * columns + k];
      seen += w.gas_seen_m2[group];
    }
    if (!(seen > 0)) return out;
    for (double& c : carried) c /= seen;
    basis->to_nodes(carried.data(), 0, out);
    return out;
  }

  // What follows from the weights of all rays.
  void keep(std::vector<PathWeights> weights) {
    weights_ = std::move(weights);
    for (Nodes& nodes : nodes_)
      nodes.weight.assign(nodes.tests.size(), std::vector<double>(scene_.axis.nodes(), 0.0));
    reflected_.clear();
    for (std::size_t g = 0; g < groups(); ++g) {
      const std::vector<double> sums = sum_of(weights_, g, 1);
      reflected_.push_back(reflected(g));
      if (!std::any_of(sums.begin(), sums.end(), [](double s) { return s > 0; })) continue;
      for (Nodes& nodes : nodes_) {
        const std::vector<double> weight = column_weights(nodes.tests, sums, 0, nodes.tests.size());
        for (std::size_t m = 0; m < weight.size(); ++m)
          for (std::size_t i = 0; i < reflected_[g].size(); ++i)
            nodes.weight[m][i] += weight[m] * reflected_[g][i];
      }
    }
    find_class_errors();
    split_by_class();
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

  // One after another the column that is least a sum of those before it.
  absl::Status choose_classes(const std::vector<GasColumn>& columns,
                              const std::vector<std::vector<double>>& tested,
                              const ColumnTests& tests) {
    std::vector<std::vector<double>>& classes = class_tests_;
    std::vector<GasColumn> of_class;
    std::size_t next = 0;
    const auto size = [&](std::size_t c) {
      const auto a = ColumnTests::absorbed(tested[c]);
      return ordered_dot(a.data(), a.data(), a.size());
    };
    GasOnView::Absorbed& most = most_absorbed_;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (size(c) > size(next)) next = c;
      const auto absorbed = ColumnTests::absorbed(tested[c]);
      for (std::size_t g = 0; g < most.size(); ++g) most[g] = std::max(most[g], absorbed[g]);
    }
    double unlike = 1;
    while (classes.size() < kClasses && unlike > kAlike) {
      classes.push_back(tested[next]);
      of_class.push_back(columns[next]);
      gas_ = std::make_shared<const GasOnView>(field_, scene_.target.centre, tests, most, classes);
      unlike = 0;
      for (std::size_t c = 0; c < columns.size(); ++c)
        if (const double of_column = gas_->shares(tested[c]).unlike; of_column > unlike) {
          unlike = of_column;
          next = c;
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
        nodes.weight.push_back(weight[c]);
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

  // Of each replicate what is sent in a band, in the tests' terms.
  [[nodiscard]] std::vector<double> sent_by_replicates(const std::vector<PathWeights>& weights,
                                                       std::size_t which_band) const {
    const std::vector<double> tests = as_tests(which_band);
    const BandOnAxis band = scene_.axis.band(which_band);
    std::vector<double> of_group;
    for (const std::vector<double>& r : reflected_) {
      double mean = 0;
      for (std::size_t i = 0; i < band.nodes(); ++i)
        mean += r[band.first_node + i] / static_cast<double>(band.nodes());
      of_group.push_back(mean);
    }
    std::vector<double> out;
    for (const PathWeights& w : weights) {
      double& sum = out.emplace_back(0.0);
      for (std::size_t g = 0; g < of_group.size(); ++g)
        sum += of_group[g] *
               ordered_dot(w.gas_m2.data() + g * tests.size(), tests.data(), tests.size());
    }
    return out;
  }

  // Of every band of the scene: its mean absorption as weights of test gases, by nodes and classes.
  [[nodiscard]] ThickGas thick() const {
    ThickGas out{request_.plume_area_optical_depth, {}};
    const std::vector<double> flat(scene_.axis.nodes(), 1.0);
    for (std::size_t b = 0; b < scene_.axis.bands(); ++b) {
      const BandOnAxis band = scene_.axis.band(b);
      std::vector<std::vector<double>> of_gas(ColumnTests::kGases);
      std::vector<double> absorbed;
      const auto add = [&](const ColumnLight& light, std::span<const double> tests) {
        absorbed.push_back(in_band(light.absorbed, band) / in_band(flat, band));
        const auto of_column = ColumnTests::absorbed(tests);
        for (std::size_t g = 0; g < of_gas.size(); ++g) of_gas[g].push_back(of_column[g]);
      };
      for (const Nodes& nodes : nodes_)
        for (std::size_t m = 0; m < nodes.column.size(); ++m) add(nodes.here[m], nodes.tests[m]);
      for (std::size_t k = 0; k < class_here_.size(); ++k) add(class_here_[k], class_tests_[k]);
      const std::vector<double> weight = column_weights(of_gas, absorbed, kTolerance, kNodes);
      std::copy(weight.begin(), weight.end(), out.weight.emplace_back().begin());
    }
    return out;
  }

  // What the field's lattice cannot say of what is sent: by how much half the resolution changes
  // it, on the same rays, and by how much those may be wrong.
  absl::Status find_voxel_errors(const ColumnTests& tests) {
    const auto& half = field_->at_half_resolution();
    if (!half.ok()) return half.status();
    // Larger voxels reach further; not as far as to refuse a view.
    BoxedSight sight = sight_of(*field_);
    for (auto& box : sight_of(**half).box) sight.box.push_back(box);
    const auto wider = make_boxed_view(scene_.target, request_.viewpoint, sight);
    const AimedView& view = wider.ok() ? *wider : *aimed_;
    const auto sent = [&](const std::shared_ptr<const PlumeField>& field) {
      std::vector<double> none;
      return run(std::make_shared<const GasOnView>(field, scene_.target.centre, tests,
                                                   most_absorbed_, class_tests_),
                 view, pilots_.second, 3, 0, {}, none);
    };
    const std::vector<PathWeights> fine = sent(field_), coarse = sent(*half);
    for (std::size_t b = 0; b < scene_.axis.bands(); ++b) {
      const std::vector<double> band = as_tests(b);
      ReplicateStatistics s(2);
      for (std::size_t r = 0; r < fine.size(); ++r) {
        const double of_fine = ordered_dot(fine[r].gas_m2.data(), band.data(), band.size());
        s.add(std::array{of_fine,
                         ordered_dot(coarse[r].gas_m2.data(), band.data(), band.size()) - of_fine});
      }
      const Estimate change = s.estimate(1);
      const double all = s.estimate(0).value;
      voxel_error_.push_back(all > 0 ? std::hypot(change.value, change.stderr_) / all : 0);
    }
    return absl::OkStatus();
  }

  // Of each replicate: so many that what is sent is known well enough in every band, at the target.
  std::uint64_t samples(const std::vector<double>& also_sent_w_sr) {
    const AccuracySpec& accuracy = request_.accuracy;
    if (accuracy.samples_per_replicate > 0) return accuracy.samples_per_replicate;
    if (!(accuracy.relative_error > 0)) return plan_.samples_per_replicate;
    const std::vector<double> sent = sent_w_sr();
    const auto scatter = [&](const std::vector<PathWeights>& weights) {
      double most = 0;
      for (std::size_t b = 0; b < scene_.axis.bands(); ++b) {
        ReplicateStatistics s(1);
        for (const double sum : sent_by_replicates(weights, b)) s.add(std::array{sum});
        const Estimate e = s.estimate(0);
        if (!(e.value > 0)) continue;
        const double also = also_sent_w_sr.empty() ? 0 : also_sent_w_sr[b];
        most = std::max(most, e.stderr_ / e.value * sent[b] / (sent[b] + also));
      }
      return most;
    };
    const double first = scatter(run(gas_, pilots_.first, 1, reflections(true))),
                 second = scatter(weights_);
    // Of what the hull reflects no more than of all else that it does.
    const std::uint64_t most = on_hull_ ? std::max(pilots_.second, plan_.samples_per_replicate)
                                        : accuracy.max_samples_per_replicate;
    return samples_needed(pilots_.first, first, pilots_.second, second,
                          kShareOfGoal * accuracy.relative_error,
                          std::min(most, accuracy.max_samples_per_replicate));
  }

  // Of what is taken by a column of a class, by the nodes: in each band of the scene.
  void find_class_errors() {
    class_error_.assign(scene_.axis.bands(), 0.0);
    const Nodes& nodes = nodes_[0];
    for (std::size_t b = 0; b < class_error_.size(); ++b) {
      const BandOnAxis band = scene_.axis.band(b);
      double absorbed = 0, off = 0;
      for (std::size_t m = 0; m < nodes.column.size(); ++m) {
        const double w = mean_of(nodes.weight[m], band),
                     taken = in_band(nodes.here[m].absorbed, band);
        const GasOnView::Shares shares = gas_->shares(nodes.tests[m]);
        double by_classes = 0;
        for (std::size_t k = 0; k < class_here_.size(); ++k)
          by_classes += shares.of_class[k] * in_band(class_here_[k].absorbed, band);
        absorbed += w * taken;
        off += w * std::abs(by_classes - taken);
      }
      class_error_[b] = absorbed > 0 ? off / absorbed : 0;
    }
  }

  // Tables of one first part: by class, then of what is beyond by class.
  void split_by_class() {
    const std::uint32_t firsts = class_tables();
    const double share = 1.0 / static_cast<double>(weights_.size());
    const std::size_t columns = weights_.front().weight.columns();
    each_.clear();
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

  // Tables of weights: of what is behind gas of a class; in sight also of what is beyond.
  [[nodiscard]] std::uint32_t class_tables() const { return (on_hull_ ? 1 : 2) * gas_->classes(); }

  [[nodiscard]] static double mean_of(const std::vector<double>& spectrum, const BandOnAxis& band) {
    double mean = 0;
    for (std::size_t i = 0; i < band.nodes(); ++i)
      mean += spectrum[band.first_node + i] / static_cast<double>(band.nodes());
    return mean;
  }
  [[nodiscard]] static double weighted(const std::vector<double>& weight,
                                       const std::vector<double>& spectrum,
                                       const BandOnAxis& band) {
    double sum = 0;
    for (std::size_t i = 0; i < band.nodes(); ++i)
      sum += band.grid.band_weight[i] * weight[band.first_node + i] * spectrum[band.first_node + i];
    return sum;
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
        const std::vector<double>& w = nodes_[set].weight[m];
        of_set[set] += weighted(w, spectrum, band);
        out.bound += 0.5 * kOfSteps * std::abs(weighted(w, (*light[set])[m].step_w_m2_sr_um, band));
        for (std::size_t bin = 0; bin < out.by_bin.size(); ++bin)
          for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i)
            out.by_bin[bin] +=
                0.5 * w[band.first_node + i] * grid.bin_weight[i] * spectrum[band.first_node + i];
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

  [[nodiscard]] GasRow row_of(const ConditionSources& light, const Sensor& sensor,
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
               joined = sent_by({sensor.nodes.data(), sensor.nodes.data() + 1}, band),
               product = sent_by({sensor.product.data(), sensor.product.data() + 1}, band);
    const bool without_lines = request_.effects.without(Effect::kHotLineCorrelation);
    const Sent& seen = without_lines ? product : joined;
    constexpr std::size_t kTotal = 0, kApparent = 1 + kCauses, kContrast = 2 + kCauses;
    // At the sensor light is as the air lets it through.
    const std::vector<double> smooth(scene_.axis.nodes(), 1.0);
    const std::vector<double>& through = light.environment().transmittance;
    const Taken source = taken_by(class_here_, stored, 0, kTotal, 0, 1, smooth, band),
                apparent = taken_by(sensor.classes, stored, 0, kApparent, kApparentQuantity, 1,
                                    through, band);
    const std::vector<double> scatter = sent_by_replicates(weights_, which_band);
    double mean = 0;
    for (const double s : scatter) mean += s / static_cast<double>(replicates);
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
                    in_bands[r * class_tables() + loss.first + k][loss.quantity];
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
    if (on_hull_) {
      out.contrast = out.apparent;
    } else {
      // Of what is beyond the contrast is all that there is, and negative.
      const Taken beyond = taken_by(sensor.classes, stored, classes, kContrast,
                                    contrast_quantity(1), -1, through, band);
      out.contrast = change(
          seen, {{apparent, 0, kApparentQuantity, 1}, {beyond, classes, contrast_quantity(1), -1}});
    }
    out.emitted_w_sr = here.in_band;
    out.apparent_emitted_w_sr = seen.in_band;
    if (on_hull_) {
      out.on_hull = out.source.in_band;
      out.apparent_on_hull = out.apparent.in_band;
    }
    out.lines_w_sr = std::abs(joined.in_band - product.in_band);
    if (!on_hull_) {
      out.voxel_error_w_sr = voxel_error_[which_band] * here.in_band;
      out.apparent_voxel_error_w_sr = voxel_error_[which_band] * seen.in_band;
      ReplicateStatistics area(1);
      for (const PathWeights& w : weights_)
        area.add(std::array{w.gas_m2[ColumnTests::kCount + which_band]});
      out.area_m2 = area.estimate(0);
    }
    // One model errs one way everywhere: its errors add up over columns and wavelengths.
    for (std::size_t set = 0; set < nodes_.size(); ++set)
      for (std::size_t m = 0; m < nodes_[set].column.size(); ++m)
        out.model_error_w_sr += 0.5 * weighted(nodes_[set].weight[m],
                                               sensor.nodes[set][m].model_error_w_m2_sr_um, band);
    return out;
  }

  bool on_hull_;
  PilotSamples pilots_;
  const PreparedScene& scene_;
  const ViewRequest& request_;
  const ViewPlan& plan_;
  const ViewSources& sources_;
  const GasWavelengths& wavelengths_;
  const PictureFrame& pictures_;
  std::shared_ptr<const PlumeField> field_;
  std::vector<std::size_t> condition_;
  std::shared_ptr<const AimedView> aimed_;
  std::array<Nodes, 2> nodes_;
  std::vector<std::vector<double>> reflected_;  // [group][wavelength]
  GasOnView::Absorbed most_absorbed_{};
  std::vector<std::vector<double>> class_tests_;
  std::vector<HotColumn> class_column_;
  std::vector<ColumnLight> class_here_;
  std::vector<double> class_error_;  // [band of the scene] relative, of what is taken
  std::vector<double> voxel_error_;  // likewise, of what is sent
  std::shared_ptr<const GasOnView> gas_;
  std::vector<PathWeights> weights_;      // [replicate]
  std::vector<PathWeights> mean_, each_;  // [first]; [replicate][first]
  std::uint64_t samples_ = 0;             // of each replicate, of weights_
  PathCounts counts_;
  ImagePlan image_plan_;
  std::vector<double> image_;
  SourceLayout layout_ = SourceLayout(scene_.target.part.size(), sources_.geometry());
};

void add(const Estimate& more, Estimate& to) {
  to.value += more.value;
  to.stderr_ = std::hypot(to.stderr_, more.stderr_);
}

void add(const Change& more, Change& to) {
  add(more.in_band, to.in_band);
  to.bound_w_sr += more.bound_w_sr;
  for (std::size_t k = 0; k < to.spectral.value.size(); ++k) {
    to.spectral.value[k] += more.spectral.value[k];
    to.spectral.stderr_[k] = std::hypot(to.spectral.stderr_[k], more.spectral.stderr_[k]);
  }
  for (std::size_t r = 0; r < to.replicate.size(); ++r) to.replicate[r] += more.replicate[r];
}

// Both have random numbers of their own.
void add_on_hull(const GasRow& more, GasRow& to) {
  add(more.source, to.source);
  add(more.apparent, to.apparent);
  add(more.contrast, to.contrast);
  add(more.on_hull, to.on_hull);
  add(more.apparent_on_hull, to.apparent_on_hull);
  to.lines_w_sr += more.lines_w_sr;
  to.model_error_w_sr += more.model_error_w_sr;
  // As much of what is reflected as of what is seen.
  if (to.emitted_w_sr > 0) to.voxel_error_w_sr *= 1 + more.emitted_w_sr / to.emitted_w_sr;
  if (to.apparent_emitted_w_sr > 0)
    to.apparent_voxel_error_w_sr *= 1 + more.apparent_emitted_w_sr / to.apparent_emitted_w_sr;
  to.rays += more.rays;
}

void add(const RowBounds::Bound& more, RowBounds::Bound& to) {
  to.source += more.source;
  to.apparent += more.apparent;
  to.contrast += more.contrast;
}

// What leaving a measured row out can change: with few rays as with many.
RowBounds::Bound limit_of(const GasRow& row) {
  const auto most = [](const Change& c) {
    return std::abs(c.in_band.value) + kSigmas * c.in_band.stderr_ + c.bound_w_sr;
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
  GasOfField(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
             const PreparedView& view, const ViewSources& sources,
             const GasWavelengths& wavelengths, const PictureFrame& pictures,
             const std::shared_ptr<const PlumeField>& field,
             const std::vector<std::size_t>& condition)
      : scene_(scene),
        request_(request),
        plan_(plan),
        field_(field),
        condition_(condition),
        in_sight_(GasMeasurement::Where::kInSight, scene, request, plan, view, sources, wavelengths,
                  pictures, field, condition),
        on_hull_(GasMeasurement::Where::kOnHull, scene, request, plan, view, sources, wavelengths,
                 pictures, field, condition) {}

  absl::Status trace() {
    auto seen = in_sight_.find();
    if (!seen.ok()) return seen.status();
    seen_ = *seen;
    if (seen_ && !without_) in_sight_.measure({});
    auto met = on_hull_.find();
    if (!met.ok()) return met.status();
    met_ = *met;
    return absl::OkStatus();
  }

  // [selected band] which: of its conditions
  absl::StatusOr<std::vector<GasRow>> rows(std::size_t which) {
    const std::uint32_t condition = request_.selected_condition[condition_[which]];
    auto seen = rows_of(seen_ ? &in_sight_ : nullptr, which);
    if (!seen.ok()) return seen.status();
    // Of few rays, and of as many as are wanted; made when they are asked for.
    std::optional<std::vector<GasRow>> few, all;
    for (std::size_t i = 0; i < seen->size(); ++i) {
      const std::uint32_t band = request_.selected_band[i];
      GasRow& row = (*seen)[i];
      RowBounds::Bound left_out = unmet(band);
      const bool room = !plan_.room.empty(), forced = without_ || without_hull();
      const EffectPlanner::Room& of_row =
          room ? plan_.room[condition * scene_.axis.bands() + band] : EffectPlanner::Room{};
      bool off = forced || !met_;
      if (met_ && (forced || (room && on_hull_.sent_w_sr()[band] <= of_row.source))) {
        if (auto status = make(on_hull_, which, few); !status.ok()) return status;
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
        if (auto status = make(*full_, which, all); !status.ok()) return status;
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
      if (!hull_off) hull.share_w_sr = row.on_hull.value;
      RowBounds::Bound plume = limit_of(row), lines{false, 0, row.lines_w_sr, row.lines_w_sr};
      const bool product = request_.effects.without(Effect::kHotLineCorrelation) && !without_;
      if (without_) {
        // What was measured says only what it could have been.
        add(left_out, plume);
        const GasRow measured = std::exchange(row, nothing_of(bins(band)));
        row.rays = measured.rays;
        left_out = plume;
        lines = {};
      } else if (product) {
        add(lines, left_out);
      }
      row.omitted = left_out;
      row.ledger = {
          entry_of(Effect::kPlume, without_,
                   without_ ? EffectReason::kForced : EffectReason::kNotAsked, plume),
          hull,
          entry_of(Effect::kHotLineCorrelation, product || without_,
                   product || without_ ? EffectReason::kForced : EffectReason::kNotAsked, lines)};
      if (!without_) row.ledger.front().share_w_sr = row.source.in_band.value;
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
    auto made = gas.rows(which);
    if (!made.ok()) return made.status();
    rows = *std::move(made);
    return absl::OkStatus();
  }
  // Of gas that no reflected ray has met: as hot and black as it may be.
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
  for (const std::shared_ptr<const PlumeField>& field : fields) {
    std::vector<std::size_t> having;
    for (std::size_t i = 0; i < request.selected_condition.size(); ++i)
      if (request.condition[request.selected_condition[i]].gas == field) having.push_back(i);
    GasOfField gas(scene, request, plan, *view, sources, *wavelengths, pictures, field, having);
    if (auto status = gas.trace(); !status.ok()) return status;
    for (std::size_t which = 0; which < having.size(); ++which) {
      const std::size_t first = having[which] * bands;
      auto rows = gas.rows(which);
      if (!rows.ok()) return rows.status();
      for (std::size_t b = 0; b < bands; ++b) out[first + b] = std::move((*rows)[b]);
    }
  }
  return out;
}

}  // namespace irsig

#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/signature/gas_rows.h"
#include "core/signature/view/shading.h"
#include "core/signature/view/trace_view.h"
#include "core/transport/boxed_view.h"

namespace irsig {

// References to all that fields of gas in one view share; it outlives them.
struct GasInView {
  const PreparedScene& scene;
  const ViewRequest& request;
  const ViewPlan& plan;
  const PreparedView& view;  // of the target itself
  const ViewSources& sources;
  const GasWavelengths& wavelengths;
  const PictureFrame& pictures;
};

// One field of gas in one view: as it is seen, and behind it what else is; or as the target
// reflects it, and what it takes on its way of other light that the target reflects.
class GasMeasurement {
 public:
  enum class Where : std::uint8_t { kInSight, kOnHull };
  // condition: those of the selected ones that have this field
  GasMeasurement(Where where, const GasInView& given, std::shared_ptr<const PlumeField> field,
                 std::vector<std::size_t> condition);

  // Chooses what stands for all rays, and knows the pilot's. False: the gas is not met at all.
  absl::StatusOr<bool> find();
  // Traces as many rays as the accuracy asks for. sent_w_sr: other emission of the gas in each band
  // of the scene, of which the error may be a fraction.
  void measure(const std::vector<double>& sent_w_sr);

  [[nodiscard]] std::uint64_t rays() const { return traced_.rays; }
  // Returns an upper bound of the gas's reflection where find() has met no gas. [m2]
  [[nodiscard]] double unmet_m2() const;
  // Returns the emission in each band of the scene, at the target. [W/sr]
  [[nodiscard]] std::vector<double> sent_w_sr() const;

  // Returns the rows of one of its conditions.
  absl::StatusOr<std::vector<GasRow>> rows(std::size_t which) const;

 private:
  // Columns whose weighted spectra add up to those of all rays. Two sets that have no column in
  // common: their difference shows what so few columns cost.
  struct Nodes {
    std::vector<HotColumn> column;
    std::vector<std::vector<double>> tests;
    std::vector<ColumnLight> here;            // at the target
    std::vector<std::vector<double>> weight;  // [node][wavelength] [m2]
    std::vector<double> misfit;               // [test] of what the rays' tests add up to
  };

  // Gas behind the air of a condition.
  struct Sensor {
    std::array<std::vector<ColumnLight>, 2> nodes;
    std::array<std::vector<ColumnLight>, 2> product;  // as if cold and hot lines were independent
    std::vector<ColumnLight> classes;
  };

  // Prepares a condition's air at the sensor. INVALID_ARGUMENT: imported air, whose lines are not
  // known.
  [[nodiscard]] absl::StatusOr<Sensor> behind_air(std::size_t which) const;

  // Traces the rays of this gas with a stage of random numbers of their own.
  //   pictures  unless empty: the same number of rays in each pixel; the view is a whole_view
  TracedView run(std::shared_ptr<const RayMedium> gas, const AimedView& view, std::uint64_t samples,
                 std::uint64_t stage, std::uint32_t reflections, const ImagePlan& pictures = {});
  // Pictures of the rows' source radiance, and behind them those of what arrives at the sensor, if
  // that is asked for: of what a ray's gas sends as much as its test gases say, so that all rays of
  // the pilot send what the nodes do; of what is behind it less what its classes take.
  //   sums  of the pilot's tests, which the nodes' weights are of
  [[nodiscard]] absl::StatusOr<ImagePlan> plan_images(const std::vector<double>& sums);
  // Returns true if images have layers of what is behind the gas, too.
  [[nodiscard]] bool at_sensor() const {
    return given_.request.image && given_.request.image->has(ImageLayer::kAtSensor);
  }
  // Returns the number of the first picture at the sensor; pictures at the target are by condition,
  // then band.
  [[nodiscard]] std::size_t source_images() const {
    return condition_.size() * given_.request.selected_band.size();
  }
  // Puts into picture `image` of the plan what one band's gas sends.
  //   tests  weights of tests whose sum is its emission; nodes: emission of the nodes
  void show_emission(std::vector<double> tests, const std::vector<double>& sums,
                     const std::array<const std::vector<ColumnLight>*, 2>& nodes,
                     const BandOnAxis& band, std::size_t image, ImagePlan& plan);
  // Takes off picture `image` what a class absorbs of the light behind it.
  void show_absorption(const ConditionSources& light, const ColumnLight& gas, bool at_sensor,
                       const BandOnAxis& band, std::size_t image, std::size_t of_class,
                       ImagePlan& plan) const;
  // Returns a row's pictures from those that were traced.
  [[nodiscard]] GasPicture picture_of(std::size_t image, std::uint32_t band) const;

  // Returns the settings of a picture's run: half of a thumbnail's samples of opaque parts.
  [[nodiscard]] PathSettings gas_picture_settings(const PathSettings& settings,
                                                  const ImagePlan& pictures) const;

  [[nodiscard]] std::uint32_t reflections(bool pilot) const;

  // Returns the number of groups of reflected gas: one for each part that is seen.
  [[nodiscard]] std::size_t groups() const {
    return on_hull_ ? given_.scene.target.part.size() : 1;
  }

  // Means over replicates, of one group or of all.
  static std::vector<double> sum_of(const std::vector<PathWeights>& weights, std::size_t first,
                                    std::size_t groups);
  [[nodiscard]] std::vector<double> sum_of(const std::vector<PathWeights>& weights) const;

  // Returns the ratio of a group's reflections at each wavelength to the mean with which its tests
  // were weighted.
  [[nodiscard]] std::vector<double> reflected(std::size_t group) const;

  // Keeps the sums that the weights of all rays give.
  void keep(std::vector<PathWeights> weights);

  absl::Status prepare(const std::vector<GasColumn>& columns, std::vector<HotColumn>& hot,
                       std::vector<ColumnLight>& here) const;

  // Chooses columns one by one: each time the column that the chosen columns represent worst.
  absl::Status choose_classes(const std::vector<GasColumn>& columns,
                              const std::vector<std::vector<double>>& tested,
                              const ColumnTests& tests);

  // Chooses two sets of nodes: the first from columns 0, 2, ... of the survey, the second from
  // columns 1, 3, ...; both from the same column if there is only one.
  absl::Status choose_nodes(const std::vector<GasColumn>& columns,
                            const std::vector<std::vector<double>>& tested,
                            const std::vector<double>& sums);

  // Returns weights of the tests whose sum is the band's emission, for each of these nodes.
  [[nodiscard]] std::vector<double> tests_of(std::initializer_list<const Nodes*> sets,
                                             std::size_t band) const;
  // Returns the tests of both sets of nodes likewise, whose emission is given.
  [[nodiscard]] std::vector<double> tests_of(
      const std::array<const std::vector<ColumnLight>*, 2>& light, std::size_t band) const;

  // Returns the difference between the tests of the nodes' columns and of the rays, as a fraction
  // of the emission in a band.
  [[nodiscard]] double misfit_relative(std::size_t which_band) const;
  // Returns by how much both sets of nodes may be off though they agree, as a share of what is sent
  // in a band: how far each column is from the sum of its tests that fits the other set's columns,
  // added up in squares.
  [[nodiscard]] double luck_relative(std::size_t which_band) const;
  // Returns what so many rays of each replicate may all have missed, as a share of what is sent in
  // a band.
  [[nodiscard]] double missed(std::size_t which_band, std::uint64_t samples) const;
  // Returns the emission in a band for each replicate, in the tests' terms.
  [[nodiscard]] std::vector<double> sent_by_replicates(const std::vector<PathWeights>& weights,
                                                       std::size_t which_band) const;

  // Returns the mean absorption in every band of the scene as weights of test gases, by nodes and
  // classes.
  [[nodiscard]] ThickGas thick() const;

  // Finds the error of the emission by the field's lattice: the change at half the resolution, on
  // the same rays, and the error of that change.
  absl::Status find_voxel_errors(const ColumnTests& tests);

  // Returns the most samples of each replicate that are taken, whatever the accuracy asks for.
  [[nodiscard]] std::uint64_t most_samples() const;
  // Samples of each replicate for an emission that is known well enough in every band, at the
  // target.
  std::uint64_t samples(const std::vector<double>& also_sent_w_sr);

  // Finds the errors of the absorption by a column of a class, by the nodes: in each band of the
  // scene.
  void find_class_errors();

  // Tables of one first part: by class, then of what is beyond by class.
  void split_by_class();

  // Tables of weights: of what is behind gas of a class; in sight also of what is beyond.
  [[nodiscard]] std::uint32_t class_tables() const { return (on_hull_ ? 1 : 2) * gas_->classes(); }

  [[nodiscard]] static double mean_of(const std::vector<double>& spectrum, const BandOnAxis& band);
  [[nodiscard]] static double weighted(const std::vector<double>& weight,
                                       const std::vector<double>& spectrum, const BandOnAxis& band);

  // Emission by sets of nodes.
  struct Sent {
    double in_band = 0;
    double steps = 0, sets = 0;  // bounds: of finite steps; how far two sets of nodes are apart
    std::vector<double> by_bin;
  };
  [[nodiscard]] Sent sent_by(const std::array<const std::vector<ColumnLight>*, 2>& light,
                             const BandOnAxis& band) const;

  // Absorption of light behind the classes: its spectrum, and the fraction of each replicate's
  // light that the spectra give.
  struct Taken {
    std::vector<double> by_bin;  // all classes
    std::vector<double> share;   // [class] of what is behind it, in band
    double in_band = 0;
  };
  // Returns the absorption of the light behind each class, times `sign`.
  //   stored    tables of weights as tally_row() has them; class k is stored[first + k]
  //   spectrum  the light behind a class, one value for each bin
  //   quantity  the in-band value of that light
  //   shape     relative spectrum assumed for the light inside a bin
  [[nodiscard]] Taken taken_by(const std::vector<ColumnLight>& gas,
                               const std::vector<RowTally>& stored, std::size_t first,
                               std::vector<double> RowTally::*spectrum, double RowTally::*quantity,
                               double sign, const std::vector<double>& shape,
                               const BandOnAxis& band) const;

  [[nodiscard]] GasRow row_of(const ConditionSources& light, const Sensor& sensor,
                              const LitWeights& of_classes, const LitWeights& of_replicates,
                              std::uint32_t which_band) const;

  bool on_hull_;
  // Samples of each replicate: rays that are aimed at the gas, and rays that may meet it after the
  // hull.
  struct PilotSamples {
    std::uint64_t survey, first, second;
  };
  PilotSamples pilots_;
  const GasInView given_;
  std::shared_ptr<const PlumeField> field_;
  std::vector<std::size_t> condition_;
  std::shared_ptr<const AimedView> aimed_;
  std::optional<SightShares> sight_;  // of what is in sight
  std::shared_ptr<const GasOnView> gas_;

  // Columns that stand for all rays.
  struct Columns {
    std::array<Nodes, 2> nodes;
    std::vector<std::vector<double>> reflected;  // [group][wavelength]
    GasOnView::Absorbed most_absorbed{};
    std::vector<std::vector<double>> class_tests;
    std::vector<HotColumn> class_column;
    std::vector<ColumnLight> class_here;
    std::vector<std::vector<double>> band_tests;  // tests_of() both sets
  };
  Columns columns_;

  // As shares of what is sent: misfit_relative() and missed(); luck_relative().
  struct ColumnBounds {
    double missed, luck;
  };
  // Errors beside the scatter of rays. [band of the scene]
  struct Errors {
    std::vector<ColumnBounds> columns;
    std::vector<double> classes;  // relative, of what is taken
    std::vector<double> voxels;   // likewise, of what is sent
  };
  Errors errors_;

  struct Traced {
    std::vector<PathWeights> weights;     // [replicate]
    std::vector<PathWeights> mean, each;  // [first]; [replicate][first]
    std::uint64_t samples = 0;            // of each replicate, of weights
    bool is_measurement = false;          // not a pilot
    std::uint64_t rays = 0;
  };
  Traced traced_;

  struct Images {
    ImagePlan plan;
    std::uint32_t pixel_samples = 0;
    std::vector<double> emitted_relative;  // [picture] GasPicture::emitted_relative
    TracedPictures traced;
  };
  Images images_;
  SourceLayout layout_ = SourceLayout(given_.scene.target.part.size(), given_.sources.geometry());
};

}  // namespace irsig

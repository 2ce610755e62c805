#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/accuracy/measured.h"
#include "core/signature/plan.h"
#include "core/signature/prepared_scene.h"
#include "core/signature/prepared_view.h"
#include "core/signature/request.h"
#include "core/signature/result.h"
#include "core/signature/seen_places.h"
#include "core/signature/shading.h"
#include "core/signature/unseen.h"
#include "core/signature/view_pictures.h"
#include "core/sources/view_sources.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// How a view's paths are traced. seed: of the view and of the stage together.
[[nodiscard]] PathSettings path_settings(const AccuracySpec& accuracy, const EffectSet& effects,
                                         std::uint64_t seed, std::uint64_t samples);

// Tracing one view for a set of conditions and bands (the rows): which suns shine, how the
// conditions shade, and the statistics and error bounds of what is stored. The pilots are passes,
// and so is the stored run.
class Pass {
 public:
  // The rows that are computed: conditions of the request x bands of the scene.
  struct Rows {
    std::vector<std::uint32_t> condition, band;
  };
  // plan: its effects and bounds; its number of samples is not looked at. view: with the light of
  // the conditions. The scene outlives it; what is wanted of the rest is kept.
  Pass(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
       std::shared_ptr<const PreparedView> view, Rows rows, std::uint64_t seed);
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;

  // What the plan has come to say since.
  void leave_out(std::vector<RowBounds::Bound> omitted) { plan_.omitted = std::move(omitted); }
  void cut_reflections(std::uint32_t most) { plan_.effects.max_reflections = most; }

  enum class Replicated : std::uint8_t { kSource, kApparent, kContrast };

  // Traces all replicates afresh. A pilot knows in-band numbers only.
  enum class Kind { kPilot, kStored };
  // kept: gets the paths' weights, if it is not null.
  void run(std::uint64_t samples, std::uint64_t stage, Kind kind, const PictureFrame& pictures = {},
           std::vector<PathWeights>* kept = nullptr);
  // A pilot of one stratum alone: of what is seen in it.
  void run_stratum(std::uint32_t stratum, std::uint64_t samples, std::uint64_t stage);

  [[nodiscard]] std::size_t rows() const { return rows_.condition.size() * rows_.band.size(); }
  [[nodiscard]] std::uint32_t condition_of(std::size_t row) const {
    return rows_.condition[row / rows_.band.size()];
  }
  [[nodiscard]] std::uint32_t band_of(std::size_t row) const {
    return rows_.band[row % rows_.band.size()];
  }
  [[nodiscard]] const PathCounts& counts() const { return counts_; }
  // What paths have met and nobody knows the temperature of.
  [[nodiscard]] const std::optional<UnknownSeen>& unknown_seen() const { return unknown_seen_; }
  [[nodiscard]] const ReplicateStatistics& statistics(std::size_t row) const {
    return statistics_[row];
  }
  [[nodiscard]] const ConditionSources& light(std::size_t row) const {
    return sources_.wanted(row / rows_.band.size());
  }
  [[nodiscard]] const std::vector<double>& image() const { return image_; }
  [[nodiscard]] const std::shared_ptr<const AimedView>& aimed() const { return view_->aimed; }
  [[nodiscard]] const ImagePlan& image_plan() const { return image_plan_; }

  // A row's estimates with their bounds; of pilots without those of the air and of what stands
  // behind the target. Reflections that the plan leaves out are `omitted`, those that the request
  // does not allow `truncation`.                                                            [W/sr]
  struct MeasuredRow {
    Measured source, apparent, contrast;
  };
  [[nodiscard]] MeasuredRow measured(std::size_t row) const;

  // Of the silhouette: what primary rays met from behind on one-sided facets, which send nothing.
  [[nodiscard]] double backface_fraction() const;
  // What accuracy.relative_error is of a row's value. [W/sr]
  [[nodiscard]] double relative_goal_w_sr(std::size_t row) const;
  // One sigma of the models of what stands behind the target. Not of pilots. [W/sr]
  [[nodiscard]] double background_model_w_sr(std::size_t row) const {
    return background_model_w_sr_[row];
  }
  // The error that the request wants of a row: relative to its value, or the absolute floor if that
  // is more. [W/sr]
  [[nodiscard]] double goal_w_sr(std::size_t row) const;
  [[nodiscard]] double absolute_floor_w_sr(std::size_t row) const;
  // The error that a row may keep, besides its lasting bounds, for its numerical error to reach its
  // goal; and the error of what is unseen that it has with so many samples per replicate.
  [[nodiscard]] double error_wanted(std::size_t row) const;
  [[nodiscard]] double unseen_error(std::size_t row, std::uint64_t samples) const;
  // Of one stratum of a view that aims at what is bright, with so many samples of it.
  [[nodiscard]] double unseen_error(std::size_t row, std::uint32_t stratum,
                                    std::uint64_t samples) const;

  // For choosing what to aim at by itself: how bright each facet that is in no hot part may look,
  // per error that is wanted, in the row where that is most; and how much of it can be seen.
  struct Brightness {
    std::uint32_t facet;
    double seen_m2, per_m2;
  };
  [[nodiscard]] std::vector<Brightness> brightness() const;

  // Throughput that goes on after each number of reflections, and an upper limit of it that
  // sampling will hardly exceed: 4 standard errors, and as much as none of the samples may have
  // met. [m2]
  [[nodiscard]] Estimate beyond_m2(std::uint32_t reflections) const;
  [[nodiscard]] double beyond_limit_m2(std::uint32_t reflections) const;
  // Of any source that a lost path may have met. [W/(m2 sr)]
  [[nodiscard]] double brightest_w_m2_sr(std::size_t row) const { return brightest_[row]; }
  // Of one band, all conditions alike. Not of pilots.
  [[nodiscard]] const EnergyLedger& energy(std::size_t row) const {
    return energy_[row % rows_.band.size()];
  }
  // [replicate]
  [[nodiscard]] const std::vector<double>& replicates(std::size_t row, Replicated what) const {
    return replicate_[row][static_cast<std::size_t>(what)];
  }
  // Of the spectra's errors. Not of pilots. [W/(sr um)]
  [[nodiscard]] const SpectralSet& modes(std::size_t row, Replicated what) const {
    return modes_[row][static_cast<std::size_t>(what)];
  }

 private:
  [[nodiscard]] BandOnAxis axis_band(std::size_t row) const {
    return scene_.axis.band(band_of(row));
  }
  // In a plan's lists.
  [[nodiscard]] std::size_t planned_row(std::size_t row) const {
    return condition_of(row) * scene_.axis.bands() + band_of(row);
  }
  [[nodiscard]] PathSettings settings(std::uint64_t samples, std::uint64_t stage) const;
  void collect(std::span<const PathWeights> weights, Kind kind);
  // values: [replicate], of evaluate().
  [[nodiscard]] std::array<SpectralSet, 3> modes_of(
      std::size_t row, const std::vector<std::vector<double>>& values) const;
  // Of one row each.
  [[nodiscard]] double basis_error(std::size_t row, const std::vector<double>& largest) const;
  [[nodiscard]] double sky_error(std::size_t row, const SummedWeights& mean) const;
  // places: of the view; those without an end in its air are not asked for.
  [[nodiscard]] double depth_error(std::size_t row, const SummedWeights& mean,
                                   const SeenPlaces& places) const;
  [[nodiscard]] double sun_quadrature_w_sr(std::size_t row) const;
  void find_background_errors(std::size_t row, std::span<const SummedWeights> sums);
  void find_temperature_errors(std::size_t condition, std::span<const PathWeights> weights);
  void find_energy(std::span<const PathWeights> weights, std::span<const SummedWeights> sums);
  struct Unseen {                                              // [W/sr]
    double bound = 0, source = 0, apparent = 0, contrast = 0;  // but for the bound: standard errors
  };
  [[nodiscard]] Unseen unseen(std::size_t row, std::uint64_t samples) const;
  // The same of one stratum of a view that aims at what is bright: standard errors of its emission
  // in `emitted`, of all else in the others.
  struct UnseenInStratum {
    Unseen reflected, emitted;
  };
  [[nodiscard]] UnseenInStratum unseen_in(std::size_t row, std::uint32_t stratum,
                                          std::uint64_t samples) const;
  // In-band radiances that unseen() asks for again and again: of a row's parts, and the largest
  // of what is around the target and of what stands behind it, at the target and at the sensor.
  struct InBandLight {
    struct Radiance {
      double here = 0, seen = 0;
    };
    std::vector<Radiance> each;  // [part]: its hottest
    Radiance part, around;
    double behind = 0;
  };
  [[nodiscard]] InBandLight in_band_light(std::size_t row) const;
  [[nodiscard]] std::vector<InBandLight::Radiance> sent_by_parts(std::size_t row) const;
  [[nodiscard]] double sample_m2(std::uint32_t stratum, std::uint64_t samples) const;
  // sun: of light(row).suns().
  [[nodiscard]] double glitter_w_m2_sr(std::size_t row, const LitSun& sun, bool apparent) const;
  [[nodiscard]] InBandLight::Radiance find_glitter_w_m2_sr(std::size_t row,
                                                           const LitSun& sun) const;
  [[nodiscard]] double find_brightest_w_m2_sr(std::size_t row, const ViewRequest& request) const;
  [[nodiscard]] ImagePlan plan_images(const PictureFrame& pictures,
                                      const SourceLayout& paths) const;

  const PreparedScene& scene_;
  AccuracySpec accuracy_;
  std::uint32_t allowed_reflections_;
  ViewPlan plan_;
  std::shared_ptr<const PreparedView> view_;
  Rows rows_;
  std::uint64_t seed_;
  ViewSources sources_;
  std::shared_ptr<const UndersampledSources> unseen_;
  std::vector<UndersampledSources::Stratum>
      unseen_of_;                                // [stratum], if it is aimed at what is bright
  std::vector<std::vector<bool>> parts_of_;      // [stratum][part], likewise: which are in it
  std::vector<std::vector<SeaGlint>> glitter_;   // [sun of the geometry]
  std::vector<double> quadrature_relative_;      // [row]
  std::vector<TurnedArea> turned_;               // [part]
  std::vector<double> brightest_, brightest_thermal_;                // [row]
  std::vector<InBandLight> in_band_light_;                           // [row]
  std::vector<std::vector<InBandLight::Radiance>> glitter_w_m2_sr_;  // [row][lit sun]
  std::vector<std::vector<InBandLight::Radiance>> sent_;             // [row][part], with unseen_of_
  std::vector<SourceTable> in_band_;                                 // [row]
  std::vector<ReplicateStatistics> statistics_;
  ReplicateStatistics last_;                                // [row]: paths of the last order alone
  std::vector<double> basis_w_sr_, sky_w_sr_, depth_w_sr_;  // [row]
  std::vector<double> temperature_w_sr_, temperature_apparent_w_sr_;
  std::vector<double> background_bound_w_sr_, background_model_w_sr_;  // [row]
  std::array<double, 3> beyond_m2_{};
  double front_area_m2_ = 0, background_area_m2_ = 0;  // of the silhouette, means over replicates
  ReplicateStatistics beyond_;                     // [order]
  std::vector<EnergyLedger> energy_;               // [band]
  std::vector<std::array<std::vector<double>, 3>> replicate_;  // [row][Replicated]
  std::vector<std::array<SpectralSet, 3>> modes_;              // likewise
  PathCounts counts_;
  std::optional<UnknownSeen> unknown_seen_;
  std::uint64_t samples_ = 0;
  ImagePlan image_plan_;
  std::vector<double> image_;
};

}  // namespace irsig

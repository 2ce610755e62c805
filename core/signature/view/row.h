#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/accuracy/measured.h"
#include "core/accuracy/spectral_modes.h"
#include "core/signature/view/row_tally.h"
#include "core/signature/view/shading.h"
#include "core/signature/view/unseen.h"
#include "core/sources/condition_sources.h"
#include "core/spectral/spectral_axis.h"

namespace irsig {

// In-band radiance at the target, and as much of it as arrives at the sensor. [W/(m2 sr)]
struct InBandRadiance {
  double at_target = 0, at_sensor = 0;
};

// The brightest light of a row, which bounds on undersampling ask for again and again.
struct BrightestLight {
  std::vector<InBandRadiance> part;  // [part] the hottest place of each
  InBandRadiance any_part, around;
  double behind_at_sensor = 0;  // of what stands behind the target
};

// A bound on the error of each of a row's three intensities. [W/sr]
struct ThreeBounds {
  double source = 0, apparent = 0, contrast = 0;
};

// The three intensities of a row, in the order of `replicate` and `modes`.
enum class Intensity : std::uint8_t { kSource, kApparent, kContrast };
inline constexpr std::size_t kIntensities = 3;

// Row is one condition in one band of a view: first what follows from the view alone, then what
// the last run gave.
struct Row {
  //   one_sky_light  ViewSources::wanted_under_one_sky
  Row(std::uint32_t of_condition, std::uint32_t of_band, const ConditionSources& with,
      const ConditionSources* one_sky_light, BandOnAxis band_on_axis)
      : condition(of_condition),
        band(of_band),
        light(&with),
        one_sky(one_sky_light),
        on_axis(band_on_axis) {}

  std::uint32_t condition, band;  // of the request; of the scene
  std::size_t planned = 0;        // its place in the lists of a ViewPlan
  const ConditionSources *light, *one_sky;  // one_sky: under one of two skies; null: there is one
  BandOnAxis on_axis;
  SourceTable in_band;
  double quadrature_relative = 0;  // error of the band's quadrature over the intensity
  // The brightest source that a lost path may have met, and the brightest without suns.
  double brightest_w_m2_sr = 0, brightest_thermal_w_m2_sr = 0;
  BrightestLight brightest;
  std::vector<InBandRadiance> glitter;        // [lit sun] the sea where it mirrors that sun most
  std::vector<InBandRadiance> sent_by_parts;  // [part] with what each reflects of the others;
                                              // empty unless the view aims at bright facets

  RowEstimate estimate;
  Estimate last_order;  // of paths with the last allowed number of reflections [W/sr]
  std::array<std::vector<double>, kIntensities> replicate;  // [replicate] [W/sr]
  std::array<SpectralSet, kIntensities> modes;  // of the spectra's errors; empty in pilots
  std::array<ThreeBounds, kBounds> bound{};     // those of row_bounds.h that follow from weights
  double background_model_w_sr = 0;  // one sigma of the models of the background; 0 in pilots
  // One sigma of which sky a target under broken cloud has; 0 in pilots.
  ThreeBounds choice_of_sky{};

  [[nodiscard]] ThreeBounds& of(BoundOf which) { return bound[static_cast<std::size_t>(which)]; }
  [[nodiscard]] const std::vector<double>& replicates(Intensity which) const {
    return replicate[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] const SpectralSet& modes_of(Intensity which) const {
    return modes[static_cast<std::size_t>(which)];
  }
};

// Returns the largest radiance that each part sends to anyone, what it reflects of the others
// included, given what each sends by itself. [part]
[[nodiscard]] std::vector<InBandRadiance> sent_by_parts(const UndersampledSources& sources,
                                                        const std::vector<InBandRadiance>& part);

}  // namespace irsig

#include "core/environment/incident_radiance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/base/clones.h"
#include "core/base/ordered_dot.h"

namespace irsig {
namespace {

// Sum of a[i] x[i], in sixteen partial sums whatever the processor.
IRSIG_CLONES double dot(const double* a, const float* x, std::size_t n) {
  constexpr std::size_t kLanes = 16;
  double part[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) part[k] += a[i + k] * static_cast<double>(x[i + k]);
  for (std::size_t k = 0; i < n; ++i, ++k) part[k] += a[i] * static_cast<double>(x[i]);
  double sum = 0;
  for (const double p : part) sum += p;
  return sum;
}

// out += sum_j weight[j] row[j].
IRSIG_CLONES void add_rows(const double* weight, std::size_t stride, const float* row,
                           std::size_t to_next, std::size_t rows, std::size_t n, double* out) {
  constexpr std::size_t kAtOnce = 16;  // stay in registers
  std::size_t first = 0;
  for (; first + kAtOnce <= n; first += kAtOnce) {
    double sum[kAtOnce];
    for (std::size_t b = 0; b < kAtOnce; ++b) sum[b] = out[first + b];
    for (std::size_t j = 0; j < rows; ++j) {
      const double w = weight[j * stride];
      if (w == 0) continue;
      const float* x = row + j * to_next + first;
      for (std::size_t b = 0; b < kAtOnce; ++b) sum[b] += w * static_cast<double>(x[b]);
    }
    for (std::size_t b = 0; b < kAtOnce; ++b) out[first + b] = sum[b];
  }
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t b = first; b < n; ++b)
      out[b] += weight[j * stride] * static_cast<double>(row[j * to_next + b]);
}

IRSIG_CLONES void add_scaled(double factor, const double* x, std::size_t n, double* out) {
  for (std::size_t b = 0; b < n; ++b) out[b] += factor * x[b];
}

IRSIG_CLONES void add_product(const double* a, const double* x, std::size_t n, double* out) {
  for (std::size_t b = 0; b < n; ++b) out[b] += a[b] * x[b];
}

// most = max(most, |light dT + dP|)
IRSIG_CLONES void raise_to_change(const double* light, const double* dt, const double* dp,
                                  std::size_t n, double* most) {
  for (std::size_t b = 0; b < n; ++b)
    most[b] = std::max(most[b], std::abs(light[b] * dt[b] + dp[b]));
}

}  // namespace

struct IncidentRadiance::Folded {
  std::size_t first = 0, bands = 0;  // those that have a weight
  BandRows<double> thermal, solar;   // [column], `bands` from `first` on
};

IncidentRadiance::IncidentRadiance(std::shared_ptr<const Shapes> shapes,
                                   std::shared_ptr<const Thermal> thermal,
                                   std::shared_ptr<const BandRows<double>> apparent,
                                   std::uint32_t sky_rings, std::uint32_t azimuths)
    : shapes_(std::move(shapes)),
      thermal_(std::move(thermal)),
      apparent_(std::move(apparent)),
      rings_(static_cast<std::uint32_t>(thermal_->error.size())),
      sky_rings_(sky_rings),
      azimuths_(azimuths) {
  IRSIG_CHECK(thermal_->ring.value.size() == rings_ * shapes_->bands);
  IRSIG_CHECK(apparent_->value.size() == rings_ * shapes_->bands);
  IRSIG_CHECK(sky_rings_ <= rings_);
}

void IncidentRadiance::add_sun(std::shared_ptr<const Sunlight> sunlight, Ratios ratios) {
  IRSIG_CHECK(sunlight->error.size() == count());
  IRSIG_CHECK(sunlight->air.bands == shapes_->bands);
  IRSIG_CHECK(ratios.air.bands == shapes_->bands);
  sun_.push_back({1, std::move(sunlight), std::make_shared<const Ratios>(std::move(ratios))});
}

IncidentRadiance IncidentRadiance::of_spectra(const std::vector<Spectrum>& node,
                                              const std::vector<Spectrum>& apparent,
                                              std::uint32_t sky_nodes) {
  const std::size_t n = node.front().size();
  IRSIG_CHECK(node.size() == apparent.size());
  auto shapes = std::make_shared<Shapes>();
  shapes->bands = n;
  shapes->thermal.assign(n, 1.0);
  shapes->solar.assign(n, 1.0);
  for (std::size_t i = 0; i < n; ++i) shapes->band.push_back(static_cast<std::uint32_t>(i));
  auto thermal = std::make_shared<Thermal>();
  thermal->ring = BandRows<double>(node.size(), n);
  thermal->error.assign(node.size(), 0.0);
  auto seen = std::make_shared<BandRows<double>>(node.size(), n);
  for (std::size_t k = 0; k < node.size(); ++k) {
    std::copy(node[k].begin(), node[k].end(), thermal->ring.row(k));
    std::copy(apparent[k].begin(), apparent[k].end(), seen->row(k));
  }
  return {std::move(shapes), std::move(thermal), std::move(seen), sky_nodes, 1};
}

IncidentRadiance IncidentRadiance::dark(std::shared_ptr<const Shapes> shapes) {
  auto thermal = std::make_shared<Thermal>();
  thermal->ring = BandRows<double>(2, shapes->bands);
  thermal->error.assign(2, 0.0);
  auto apparent = std::make_shared<BandRows<double>>(thermal->ring);
  return {std::move(shapes), std::move(thermal), std::move(apparent), 1, 1};
}

IncidentRadiance IncidentRadiance::mixed(const IncidentRadiance& a, const IncidentRadiance& b,
                                         double fraction) {
  IRSIG_CHECK(a.rings_ == b.rings_);
  IRSIG_CHECK(a.azimuths_ == b.azimuths_);
  IRSIG_CHECK(a.shapes_->bands == b.shapes_->bands);
  IncidentRadiance out = a;
  const auto mix = [&](BandRows<double>& to, const BandRows<double>& other) {
    for (std::size_t i = 0; i < to.value.size(); ++i)
      to.value[i] = (1 - fraction) * to.value[i] + fraction * other.value[i];
  };
  auto thermal = std::make_shared<Thermal>(*a.thermal_);
  mix(thermal->ring, b.thermal_->ring);
  for (std::size_t r = 0; r < thermal->error.size(); ++r)
    thermal->error[r] = std::max(thermal->error[r], b.thermal_->error[r]);
  auto apparent = std::make_shared<BandRows<double>>(*a.apparent_);
  mix(*apparent, *b.apparent_);
  out.thermal_ = std::move(thermal);
  out.apparent_ = std::move(apparent);
  for (Sun& sun : out.sun_) sun.fraction *= 1 - fraction;
  for (Sun sun : b.sun_) {
    sun.fraction *= fraction;
    out.sun_.push_back(std::move(sun));
  }
  return out;
}

IncidentRadiance IncidentRadiance::only(bool sky, bool lower) const {
  IncidentRadiance out = *this;
  out.sky_dark_ = sky_dark_ || !sky;
  out.lower_dark_ = lower_dark_ || !lower;
  return out;
}

void IncidentRadiance::sunlight_of(std::uint32_t node, bool apparent, double* out) const {
  const std::size_t n = shapes_->bands;
  const std::uint32_t ring = node / azimuths_;
  std::fill_n(out, n, 0.0);
  for (const Sun& sun : sun_) {
    const auto add = [&](const float* light, const double* ratio) {
      for (std::size_t b = 0; b < n; ++b)
        out[b] += sun.fraction * static_cast<double>(light[b]) * (apparent ? ratio[b] : 1);
    };
    add(sun.light->air.row(node), sun.ratio->air.row(ring));
    if (ring >= sky_rings_)
      add(sun.light->surface.row(node - sky_rings_ * azimuths_),
          sun.ratio->surface.row(ring - sky_rings_));
  }
}

double IncidentRadiance::sunlight_error(std::uint32_t node) const {
  double error = 0;
  for (const Sun& sun : sun_) error = std::max(error, sun.light->error[node]);
  return error;
}

IncidentRadiance::Spectrum IncidentRadiance::spread(const double* thermal, const double* sunlight,
                                                    std::size_t first_band, std::size_t first,
                                                    std::size_t n) const {
  Spectrum out(n);
  const Shapes& s = *shapes_;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t b = s.band[first + i] - first_band;
    out[i] = thermal[b] * s.thermal[first + i] + sunlight[b] * s.solar[first + i];
  }
  return out;
}

IncidentRadiance::Spectrum IncidentRadiance::radiance(std::uint32_t node) const {
  const std::size_t n = shapes_->band.size();
  if (is_dark(node / azimuths_)) return Spectrum(n, 0.0);
  std::vector<double> sunlight(shapes_->bands);
  sunlight_of(node, false, sunlight.data());
  return spread(thermal_->ring.row(node / azimuths_), sunlight.data(), 0, 0, n);
}

IncidentRadiance::Spectrum IncidentRadiance::apparent(std::uint32_t node) const {
  const std::size_t n = shapes_->band.size();
  if (is_dark(node / azimuths_)) return Spectrum(n, 0.0);
  std::vector<double> sunlight(shapes_->bands);
  sunlight_of(node, true, sunlight.data());
  return spread(apparent_->row(node / azimuths_), sunlight.data(), 0, 0, n);
}

IncidentRadiance::Spectrum IncidentRadiance::interpolation(std::uint32_t node) const {
  const std::size_t n = shapes_->band.size();
  const std::uint32_t ring = node / azimuths_;
  if (is_dark(ring)) return Spectrum(n, 0.0);
  std::vector<double> sunlight(shapes_->bands), thermal(shapes_->bands);
  sunlight_of(node, false, sunlight.data());
  for (std::size_t b = 0; b < shapes_->bands; ++b) {
    thermal[b] = thermal_->error[ring] * thermal_->ring.row(ring)[b];
    if (!sun_.empty()) sunlight[b] *= sunlight_error(node);
  }
  return spread(thermal.data(), sunlight.data(), 0, 0, n);
}

IncidentRadiance::BandRange IncidentRadiance::bands_of(std::size_t first, std::size_t n) const {
  const auto from = shapes_->band.begin() + static_cast<std::ptrdiff_t>(first);
  const auto [low, high] = std::minmax_element(from, from + static_cast<std::ptrdiff_t>(n));
  return {*low, *high - *low + std::size_t{1}};
}

IncidentRadiance::Folded IncidentRadiance::fold(std::size_t first, std::span<const double> weight,
                                                const double* function, std::size_t columns) const {
  const Shapes& s = *shapes_;
  const BandRange range = bands_of(first, weight.size());
  Folded out;
  out.first = range.first;
  out.bands = range.count;
  out.thermal = out.solar = BandRows<double>(columns, out.bands);
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const std::size_t b = s.band[first + i] - out.first;
    for (std::size_t k = 0; k < columns; ++k) {
      const double w = function == nullptr ? weight[i] : weight[i] * function[i * columns + k];
      out.thermal.row(k)[b] += w * s.thermal[first + i];
      out.solar.row(k)[b] += w * s.solar[first + i];
    }
  }
  return out;
}

IncidentRadiance::Integrals IncidentRadiance::integrals(std::size_t first,
                                                        std::span<const double> weight,
                                                        const double* function,
                                                        std::size_t columns) const {
  const Folded f = fold(first, weight, function, columns);
  const std::size_t n = f.bands;
  Integrals out;
  for (auto* list : {&out.source, &out.apparent, &out.interpolation})
    list->assign(count() * columns, 0.0);
  // Sunlight behind the line's air.
  std::vector<BandRows<double>> air(sun_.size(), {columns, n}), surface = air;
  for (std::uint32_t ring = 0; ring < rings_; ++ring) {
    if (is_dark(ring)) continue;
    const bool lower = ring >= sky_rings_;
    for (std::size_t q = 0; q < sun_.size(); ++q) {
      const Ratios& ratio = *sun_[q].ratio;
      for (std::size_t k = 0; k < columns; ++k)
        for (std::size_t b = 0; b < n; ++b) {
          air[q].row(k)[b] = f.solar.row(k)[b] * ratio.air.row(ring)[f.first + b];
          if (lower)
            surface[q].row(k)[b] =
                f.solar.row(k)[b] * ratio.surface.row(ring - sky_rings_)[f.first + b];
        }
    }
    for (std::size_t k = 0; k < columns; ++k) {
      const double here = ordered_dot(f.thermal.row(k), thermal_->ring.row(ring) + f.first, n),
                   seen = ordered_dot(f.thermal.row(k), apparent_->row(ring) + f.first, n);
      for (std::uint32_t a = 0; a < azimuths_; ++a) {
        const std::uint32_t node = ring * azimuths_ + a;
        double sun = 0, sun_seen = 0, sun_error = 0;
        for (std::size_t q = 0; q < sun_.size(); ++q) {
          const Sunlight& from = *sun_[q].light;
          const float* light = from.air.row(node) + f.first;
          double of = dot(f.solar.row(k), light, n), seen_of = dot(air[q].row(k), light, n);
          if (lower) {
            const float* reflected = from.surface.row(node - sky_rings_ * azimuths_) + f.first;
            of += dot(f.solar.row(k), reflected, n);
            seen_of += dot(surface[q].row(k), reflected, n);
          }
          sun += sun_[q].fraction * of;
          sun_seen += sun_[q].fraction * seen_of;
          sun_error += from.error[node] * (sun_[q].fraction * of);
        }
        out.source[node * columns + k] = here + sun;
        out.apparent[node * columns + k] = seen + sun_seen;
        out.interpolation[node * columns + k] = thermal_->error[ring] * here + sun_error;
      }
    }
  }
  return out;
}

IncidentRadiance::Binned IncidentRadiance::binned(std::size_t first, std::span<const double> weight,
                                                  std::span<const std::size_t> bin_first) const {
  // A bin has few bands: what each contributes for a unit of light in it.
  struct Share {
    std::size_t band;
    double thermal, solar;
  };
  std::vector<Share> share;
  std::vector<std::size_t> share_first{0};  // [bin]
  const Shapes& s = *shapes_;
  const std::size_t bins = bin_first.size() - 1;
  for (std::size_t k = 0; k < bins; ++k) {
    for (std::size_t i = bin_first[k]; i < bin_first[k + 1]; ++i) {
      const std::size_t b = s.band[first + i];
      if (share.size() == share_first.back() || share.back().band != b) share.push_back({b, 0, 0});
      share.back().thermal += weight[i] * s.thermal[first + i];
      share.back().solar += weight[i] * s.solar[first + i];
    }
    share_first.push_back(share.size());
  }
  // A ring's sunlight behind the line's air.
  std::vector<std::vector<double>> seen_air(sun_.size(), std::vector<double>(share.size())),
      seen_surface = seen_air;
  Binned out;
  out.source.assign(count() * bins, 0.0);
  out.apparent.assign(count() * bins, 0.0);
  for (std::uint32_t ring = 0; ring < rings_; ++ring) {
    if (is_dark(ring)) continue;
    const bool lower = ring >= sky_rings_;
    const double *here = thermal_->ring.row(ring), *seen = apparent_->row(ring);
    for (std::size_t q = 0; q < sun_.size(); ++q) {
      const Ratios& ratio = *sun_[q].ratio;
      for (std::size_t j = 0; j < share.size(); ++j) {
        seen_air[q][j] = share[j].solar * ratio.air.row(ring)[share[j].band];
        if (lower)
          seen_surface[q][j] = share[j].solar * ratio.surface.row(ring - sky_rings_)[share[j].band];
      }
    }
    for (std::uint32_t a = 0; a < azimuths_; ++a) {
      const std::uint32_t node = ring * azimuths_ + a;
      double* source = out.source.data() + node * bins;
      double* apparent = out.apparent.data() + node * bins;
      if (a > 0 && sun_.empty()) {  // as the first of its ring
        std::copy_n(source - a * bins, bins, source);
        std::copy_n(apparent - a * bins, bins, apparent);
        continue;
      }
      for (std::size_t k = 0; k < bins; ++k)
        for (std::size_t j = share_first[k]; j < share_first[k + 1]; ++j) {
          source[k] += share[j].thermal * here[share[j].band];
          apparent[k] += share[j].thermal * seen[share[j].band];
        }
      const auto add = [&](double fraction, const float* light,
                           const std::vector<double>& seen_fraction) {
        for (std::size_t k = 0; k < bins; ++k) {
          double at_target = 0, at_sensor = 0;
          for (std::size_t j = share_first[k]; j < share_first[k + 1]; ++j) {
            const double l = static_cast<double>(light[share[j].band]);
            at_target += share[j].solar * l;
            at_sensor += seen_fraction[j] * l;
          }
          source[k] += fraction * at_target;
          apparent[k] += fraction * at_sensor;
        }
      };
      for (std::size_t q = 0; q < sun_.size(); ++q) {
        const Sunlight& from = *sun_[q].light;
        add(sun_[q].fraction, from.air.row(node), seen_air[q]);
        if (lower)
          add(sun_[q].fraction, from.surface.row(node - sky_rings_ * azimuths_), seen_surface[q]);
      }
    }
  }
  return out;
}

std::vector<IncidentRadiance::Sum> IncidentRadiance::sums(bool sky,
                                                          std::span<const Weights> weights,
                                                          std::size_t first, std::size_t n) const {
  const BandRange range = bands_of(first, n);
  const std::size_t bands = range.count, lists = weights.size(), at = range.first;
  BandRows<double> thermal(lists, bands), thermal_seen(lists, bands), sun(lists, bands),
      sun_seen(lists, bands);
  std::vector<double> of_ring(bands);
  const std::uint32_t from = sky ? 0 : sky_rings_, to = sky ? sky_rings_ : rings_;
  for (std::uint32_t ring = from; ring < to; ++ring) {
    if (is_dark(ring)) continue;
    for (std::size_t list = 0; list < lists; ++list) {
      const auto [weight, stride] = weights[list];
      const std::uint32_t node = ring * azimuths_;
      const double* of_node = weight + node * stride;
      double whole = 0;
      bool any = false;
      for (std::uint32_t a = 0; a < azimuths_; ++a) {
        whole += of_node[a * stride];
        any = any || of_node[a * stride] != 0;
      }
      if (!any) continue;
      add_scaled(whole, thermal_->ring.row(ring) + at, bands, thermal.row(list));
      add_scaled(whole, apparent_->row(ring) + at, bands, thermal_seen.row(list));
      for (const Sun& part : sun_) {
        const auto add = [&](const float* light, const double* ratio) {
          std::fill(of_ring.begin(), of_ring.end(), 0.0);
          add_rows(of_node, stride, light + at, shapes_->bands, azimuths_, bands, of_ring.data());
          if (part.fraction != 1)
            for (double& x : of_ring) x *= part.fraction;
          add_scaled(1, of_ring.data(), bands, sun.row(list));
          add_product(of_ring.data(), ratio + at, bands, sun_seen.row(list));
        };
        add(part.light->air.row(node), part.ratio->air.row(ring));
        if (!sky)
          add(part.light->surface.row(node - sky_rings_ * azimuths_),
              part.ratio->surface.row(ring - sky_rings_));
      }
    }
  }
  std::vector<Sum> out;
  for (std::size_t list = 0; list < lists; ++list)
    out.push_back({spread(thermal.row(list), sun.row(list), at, first, n),
                   spread(thermal_seen.row(list), sun_seen.row(list), at, first, n)});
  return out;
}

struct IncidentRadiance::Changes {
  const IncidentRadiance& of;
  std::span<const AirChange> change;
  std::size_t first, bands;  // those that are looked at
  std::vector<double> dark, sunlight, most;

  Changes(const IncidentRadiance& light, std::span<const AirChange> changes, const Folded& where)
      : of(light),
        change(changes),
        first(where.first),
        bands(where.bands),
        dark(light.shapes_->bands, 0.0),
        sunlight(dark),
        most(where.bands) {}

  // The integral over the bands: with the fold of the shape that `light` has.
  double of_light(const double* light, bool solar, const double* folded) {
    std::fill(most.begin(), most.end(), 0.0);
    for (const AirChange& c : change)
      raise_to_change(light + first, c.transmittance.data() + first,
                      (solar ? c.path_solar : c.path_thermal).data() + first, bands, most.data());
    return ordered_dot(folded, most.data(), bands);
  }
  double thermal(std::uint32_t ring, const Folded& f) {
    return of_light(of.is_dark(ring) ? dark.data() : of.thermal_->ring.row(ring), false,
                    f.thermal.row(0));
  }
  [[nodiscard]] bool lit(std::uint32_t ring) const { return !of.sun_.empty() && !of.is_dark(ring); }
  double sun(std::uint32_t node, const Folded& f) {
    if (lit(node / of.azimuths_)) of.sunlight_of(node, false, sunlight.data());
    return of_light(lit(node / of.azimuths_) ? sunlight.data() : dark.data(), true, f.solar.row(0));
  }
};

double IncidentRadiance::changed(std::span<const AirChange> change, std::size_t first,
                                 std::span<const double> weight,
                                 std::span<const double> of_node) const {
  IRSIG_CHECK(of_node.size() == count());
  const Folded f = fold(first, weight, nullptr, 1);
  Changes changes(*this, change, f);
  double sum = 0;
  for (std::uint32_t ring = 0; ring < rings_; ++ring) {
    const double* w = of_node.data() + ring * azimuths_;
    double whole = 0;
    for (std::uint32_t a = 0; a < azimuths_; ++a) whole += w[a];
    if (whole == 0) continue;
    sum += whole * changes.thermal(ring, f);
    if (!changes.lit(ring)) {
      sum += whole * changes.sun(ring * azimuths_, f);
      continue;
    }
    for (std::uint32_t a = 0; a < azimuths_; ++a)
      if (w[a] != 0) sum += w[a] * changes.sun(ring * azimuths_ + a, f);
  }
  return sum;
}

double IncidentRadiance::changed(std::span<const AirChange> change, std::size_t first,
                                 std::span<const double> weight, const WeightsOfNode& at) const {
  Changes changes(*this, change, fold(first, weight, nullptr, 1));
  std::vector<double> here(weight.size());
  double sum = 0;
  for (std::uint32_t node = 0; node < count(); ++node) {
    if (!at(node, here)) continue;
    for (std::size_t i = 0; i < here.size(); ++i) here[i] *= weight[i];
    const Folded f = fold(first, here, nullptr, 1);
    sum += changes.thermal(node / azimuths_, f) + changes.sun(node, f);
  }
  return sum;
}

}  // namespace irsig

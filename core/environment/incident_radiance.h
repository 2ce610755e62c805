#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace irsig {

// A table with one number for each band in each row.
template <typename Number>
struct BandRows {
  std::size_t bands = 0;
  std::vector<Number> value;  // [row][band]

  BandRows() = default;
  BandRows(std::size_t rows, std::size_t of_bands) : bands(of_bands), value(rows * of_bands) {}
  [[nodiscard]] Number* row(std::size_t i) { return value.data() + i * bands; }
  [[nodiscard]] const Number* row(std::size_t i) const { return value.data() + i * bands; }
};

// Radiance from around the target under one condition, for each direction node (rings of the same
// elevation, sky first, with the same number of azimuths each), at the target and what of it
// arrives at the sensor. Spectra of all nodes are never written down:
//
//   L[node](i) = thermal[ring][band(i)] thermal_shape(i) + sunlight[node][band(i)] solar_shape(i)
//
// on wavelength i. Behind the air of a line of sight only what depends on the ring changes:
// thermal[ring], and a ratio that sunlight of the ring is multiplied by. So integrals over
// wavelength are sums over bands, and sums over azimuths are the same for any line of sight. The
// parts are shared by whoever has the same weather (thermal light), condition (sunlight) or both.
//
// Accuracy: the form is exact; sunlight is rounded to float (6e-8 of it).
class IncidentRadiance {
 public:
  using Spectrum = std::vector<double>;

  struct Shapes {
    std::size_t bands = 0;
    std::vector<std::uint32_t> band;     // [wavelength]
    std::vector<double> thermal, solar;  // [wavelength]
  };
  struct Thermal {
    BandRows<double> ring;
    std::vector<double> error;  // [ring] of straight lines between rings: relative
  };
  struct Sunlight {
    BandRows<float> air;        // [node] scattered by the air
    BandRows<float> surface;    // [node below the horizon] reflected by the surface
    std::vector<double> error;  // [node] of straight lines between nodes: relative
  };
  // Ratios of sunlight at the sensor to sunlight at the target.
  struct Ratios {
    BandRows<double> air;      // [ring]
    BandRows<double> surface;  // [ring below the horizon]
  };

  IncidentRadiance() = default;  // of no nodes
  //   apparent   thermal light at the sensor: [ring]
  //   sky_rings  the others are below the horizon
  IncidentRadiance(std::shared_ptr<const Shapes> shapes, std::shared_ptr<const Thermal> thermal,
                   std::shared_ptr<const BandRows<double>> apparent, std::uint32_t sky_rings,
                   std::uint32_t azimuths);
  void add_sun(std::shared_ptr<const Sunlight> sunlight, Ratios ratios);
  // Makes it of given spectra, one for each node; each node is a ring. The first sky_nodes are the
  // sky's.
  [[nodiscard]] static IncidentRadiance of_spectra(const std::vector<Spectrum>& node,
                                                   const std::vector<Spectrum>& apparent,
                                                   std::uint32_t sky_nodes = 1);
  // Returns two dark nodes.
  [[nodiscard]] static IncidentRadiance dark(std::shared_ptr<const Shapes> shapes);
  // Returns (1 - fraction) a + fraction b, of the same nodes on the same wavelengths.
  [[nodiscard]] static IncidentRadiance mixed(const IncidentRadiance& a, const IncidentRadiance& b,
                                              double fraction);
  // Returns a copy in which the sides that are not wanted are dark.
  [[nodiscard]] IncidentRadiance only(bool sky, bool lower) const;

  [[nodiscard]] std::uint32_t count() const { return rings_ * azimuths_; }
  [[nodiscard]] const Shapes& shapes() const { return *shapes_; }

  // Returns the radiance of one node, on all wavelengths. [W/(m2 sr um)]
  [[nodiscard]] Spectrum radiance(std::uint32_t node) const;
  [[nodiscard]] Spectrum apparent(std::uint32_t node) const;
  // Returns the largest error found of straight lines to the nodes beside it.
  [[nodiscard]] Spectrum interpolation(std::uint32_t node) const;

  // Integrals over wavelength with some weights, for each node.
  //   sum_i weight[i] function[i][k] L[node](first + i)
  // for each of `columns` functions, the rows of which are side by side; null: one, of 1.
  struct Integrals {
    std::vector<double> source, apparent, interpolation;  // [node][column]
  };
  [[nodiscard]] Integrals integrals(std::size_t first, std::span<const double> weight,
                                    const double* function, std::size_t columns) const;

  // Integrals bin by bin, over wavelengths first + i with bin_first[k] <= i < bin_first[k + 1]:
  //   sum_i weight[i] L[node](first + i)
  struct Binned {
    std::vector<double> source, apparent;  // [node][bin]
  };
  [[nodiscard]] Binned binned(std::size_t first, std::span<const double> weight,
                              std::span<const std::size_t> bin_first) const;

  // Sums over the nodes of one side with weights weight[node x stride], for several lists of such
  // weights at once, from node 0 on.
  struct Weights {
    const double* weight;
    std::size_t stride;
  };
  struct Sum {
    Spectrum radiance, apparent;  // on wavelengths first .. first + n - 1
  };
  [[nodiscard]] std::vector<Sum> sums(bool sky, std::span<const Weights> weights, std::size_t first,
                                      std::size_t n) const;

  // Change of a line of sight's air when it is replaced by the air in front of another place.
  struct AirChange {
    std::vector<double> transmittance;             // [band]
    std::vector<double> path_thermal, path_solar;  // [band], in their shapes
  };
  // An upper limit of
  //   sum_node sum_i weight[i] w[node](i) max over changes |L[node](first + i) dT(i) + dP(i)|
  // where each node has one weight on all wavelengths [node], or a weight on each: at(node, w)
  // sets w(first ..), or returns false: none. What is thermal and what is the sun's may not cancel
  // in it.
  using WeightsOfNode = std::function<bool(std::uint32_t node, std::span<double> w)>;
  [[nodiscard]] double changed(std::span<const AirChange> change, std::size_t first,
                               std::span<const double> weight,
                               std::span<const double> of_node) const;
  [[nodiscard]] double changed(std::span<const AirChange> change, std::size_t first,
                               std::span<const double> weight, const WeightsOfNode& at) const;

 private:
  // The integrand folded into each band, with the shapes of thermal light and of sunlight.
  struct Folded;
  [[nodiscard]] Folded fold(std::size_t first, std::span<const double> weight,
                            const double* function, std::size_t columns) const;
  [[nodiscard]] bool is_dark(std::uint32_t ring) const {
    return ring < sky_rings_ ? sky_dark_ : lower_dark_;
  }
  // The largest change of the light of a ring and of a node, in the bands.
  struct Changes;
  // Returns the relative error of straight lines for sunlight at a node.
  [[nodiscard]] double sunlight_error(std::uint32_t node) const;
  // Computes the sunlight of a node in the bands.
  void sunlight_of(std::uint32_t node, bool apparent, double* out) const;
  // Numbers of bands from first_band on, on wavelengths.
  [[nodiscard]] Spectrum spread(const double* thermal, const double* sunlight,
                                std::size_t first_band, std::size_t first, std::size_t n) const;
  struct BandRange {
    std::size_t first, count;
  };
  [[nodiscard]] BandRange bands_of(std::size_t first, std::size_t n) const;

  std::shared_ptr<const Shapes> shapes_;
  std::shared_ptr<const Thermal> thermal_;
  std::shared_ptr<const BandRows<double>> apparent_;
  // Sunlight is a sum: of a clear and an overcast sky under broken cloud. Empty: none.
  struct Sun {
    double fraction;
    std::shared_ptr<const Sunlight> light;
    std::shared_ptr<const Ratios> ratio;
  };
  std::vector<Sun> sun_;
  std::uint32_t rings_ = 0, sky_rings_ = 0, azimuths_ = 1;
  bool sky_dark_ = false, lower_dark_ = false;
};

}  // namespace irsig

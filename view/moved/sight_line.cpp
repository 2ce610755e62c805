#include "view/moved/sight_line.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

using LineValues = SightLine::Values;

LineValues per_bin(const BandGrid& grid, const std::vector<double>& weight,
                   const std::vector<double>& spectrum) {
  LineValues out(grid.lambda_um.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
      out[k] += weight[i] * spectrum[i];
  return out;
}

// Returns the arriving light per unit of the source's mean over the bin; for a bin without this
// source, that of a grey one.
LineValues arriving(const LineValues& seen, const LineValues& mean, const LineValues& grey) {
  LineValues out(seen.size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = mean[k] > 0 ? seen[k] / mean[k] : grey[k];
  return out;
}

// Weights of a side's directions that add up to 1: the solid angle around each ring, evenly over
// its azimuths.
std::vector<double> node_solid_angles(const DirectionNodes& nodes, std::uint32_t first,
                                      std::uint32_t count) {
  const std::uint32_t around = nodes.azimuths(), rings = count / around;
  const auto sine = [&](std::uint32_t ring) {
    return std::abs(nodes.sin_elevation(first + ring * around));
  };
  std::vector<double> out(count);
  for (std::uint32_t r = 0; r < rings; ++r) {
    const double low = r == 0 ? 0.0 : (sine(r - 1) + sine(r)) / 2;
    const double high = r + 1 == rings ? 1.0 : (sine(r) + sine(r + 1)) / 2;
    for (std::uint32_t a = 0; a < around; ++a) out[r * around + a] = (high - low) / around;
  }
  return out;
}

}  // namespace

SightLine sight_line(const ViewEnvironment& e, const DirectionNodes& nodes, const BandGrid& grid,
                     const Silhouette::Fractions& before) {
  SightLine out;

  struct Side {
    bool sky;
    std::uint32_t first, count;
    LineValues* share;
    // Means over the side's solid angle, on the band's nodes.
    IncidentRadiance::Sum mean;
  };
  std::array<Side, 2> sides{Side{true, 0, nodes.sky(), &out.directions[0], {}},
                            Side{false, nodes.sky(), nodes.lower(), &out.directions[1], {}}};
  const std::size_t bins = grid.lambda_um.size(), n = grid.node_um.size();
  const IncidentRadiance::Binned light = e.around.binned(0, grid.bin_weight, grid.bin_first);
  for (Side& side : sides) {
    std::vector<double> weight(nodes.sky() + nodes.lower());
    const std::vector<double> angle = node_solid_angles(nodes, side.first, side.count);
    std::copy(angle.begin(), angle.end(), weight.begin() + side.first);
    const IncidentRadiance::Weights list{weight.data(), 1};
    side.mean = std::move(e.around.sums(side.sky, {&list, 1}, 0, n).front());
    side.share->resize(side.count * bins);
    const double* radiance = light.source.data() + side.first * bins;
    const double* seen = light.apparent.data() + side.first * bins;
    for (std::size_t i = 0; i < side.share->size(); ++i)
      (*side.share)[i] = radiance[i] > 0 ? seen[i] / radiance[i] : -1;
  }

  // A fraction that is off goes to another node: each differs by so much from the mean.
  std::vector<std::vector<double>> away = e.background_apparent;
  std::vector<double> middle(n, 0.0);
  for (std::size_t k = 0; k < away.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) middle[i] += before.value[k] * away[k][i];
  for (std::vector<double>& node : away)
    for (std::size_t i = 0; i < n; ++i) node[i] = std::abs(node[i] - middle[i]);

  const std::vector<double> ones(e.transmittance.size(), 1.0);
  for (auto [to, weight] :
       {std::pair{&out.bin, &grid.bin_weight}, {&out.band, &grid.band_weight}}) {
    const auto integral = [&](const std::vector<double>& s) {
      return s.empty() ? LineValues() : per_bin(grid, *weight, s);
    };
    const auto mean = [&](const std::vector<double>& s) {
      return per_bin(grid, grid.bin_weight, s);
    };
    const auto of_side = [&](const IncidentRadiance::Sum& side) {
      return arriving(per_bin(grid, *weight, side.apparent),
                      per_bin(grid, grid.bin_weight, side.radiance), to->transmittance);
    };
    to->width = integral(ones);
    to->transmittance = integral(e.transmittance);
    to->path_radiance = integral(e.path_radiance);
    to->model_error_transmittance = integral(e.model_error_transmittance);
    to->model_error_path_radiance = integral(e.model_error_path_radiance);
    const auto behind = [&](const std::vector<std::vector<double>>& node,
                            const std::vector<double>& fraction) {
      std::vector<double> sum(n, 0.0);
      for (std::size_t k = 0; k < node.size(); ++k)
        if (fraction[k] != 0)
          for (std::size_t i = 0; i < n; ++i) sum[i] += fraction[k] * node[k][i];
      return integral(sum);
    };
    to->behind = behind(e.background_apparent, before.value);
    to->background_between_bound = behind(e.background_interpolation, before.value);
    if (e.one_sky) {
      const auto choice = [&](std::vector<double> one, const std::vector<double>& both) {
        for (std::size_t i = 0; i < n; ++i) one[i] = e.one_sky_sigma * (one[i] - both[i]);
        return one;
      };
      to->choice_transmittance = integral(choice(e.one_sky->transmittance, e.transmittance));
      to->choice_path_radiance = integral(choice(e.one_sky->path_radiance, e.path_radiance));
      std::vector<std::vector<double>> node = e.one_sky->background_apparent;
      for (std::size_t k = 0; k < node.size(); ++k)
        node[k] = choice(std::move(node[k]), e.background_apparent[k]);
      to->choice_behind = behind(node, before.value);
    }
    to->background_fraction_bound = behind(away, before.error);
    to->arriving = {to->transmittance,
                    arriving(integral(e.sun_apparent), mean(e.sun), to->transmittance),
                    of_side(sides[0].mean), of_side(sides[1].mean), to->transmittance};
  }
  return out;
}

}  // namespace irsig

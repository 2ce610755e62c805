#include "view/sight_line.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

using Values = SightLine::Values;

Values per_bin(const BandGrid& grid, std::size_t offset, const std::vector<double>& weight,
               const std::vector<double>& spectrum) {
  Values out(grid.lambda_um.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
      out[k] += weight[i] * spectrum[offset + i];
  return out;
}

// What arrives of a source, for each unit of the source's mean over the bin; where there is no such
// source, what arrives of a grey one.
Values arriving(const Values& seen, const Values& mean, const Values& grey) {
  Values out(seen.size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = mean[k] > 0 ? seen[k] / mean[k] : grey[k];
  return out;
}

// Weights of a side's directions that add up to 1: the solid angle around each ring, evenly over
// its azimuths.
std::vector<double> solid_angles(const DirectionNodes& nodes, std::uint32_t first,
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

void add(double weight, const std::vector<double>& spectrum, std::vector<double>& to) {
  to.resize(spectrum.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += weight * spectrum[i];
}

}  // namespace

SightLine sight_line(const ViewEnvironment& e, const DirectionNodes& nodes, const BandGrid& grid,
                     std::size_t offset) {
  SightLine out;
  out.sky_model_relative = e.sky_model_relative;
  out.sea_model_relative = e.lower_model_relative;
  out.sun_model_relative = e.sun_model_relative;

  struct Side {
    std::uint32_t first, count;
    std::vector<Values>* share;
    std::vector<double> radiance, seen;
  };
  std::array<Side, 2> sides{Side{0, nodes.sky(), &out.sky, {}, {}},
                            Side{nodes.sky(), nodes.lower(), &out.sea, {}, {}}};
  for (Side& side : sides) {
    const std::vector<double> weight = solid_angles(nodes, side.first, side.count);
    for (std::uint32_t n = side.first; n < side.first + side.count; ++n) {
      const std::vector<double> here = e.around.radiance(n), seen = e.around.apparent(n);
      add(weight[n - side.first], here, side.radiance);
      add(weight[n - side.first], seen, side.seen);
      const Values radiance = per_bin(grid, offset, grid.bin_weight, here);
      Values& share = side.share->emplace_back(per_bin(grid, offset, grid.bin_weight, seen));
      for (std::size_t k = 0; k < share.size(); ++k)
        share[k] = radiance[k] > 0 ? share[k] / radiance[k] : -1;
    }
  }

  const std::vector<double> ones(e.transmittance.size(), 1.0);
  for (auto [to, weight] :
       {std::pair{&out.bin, &grid.bin_weight}, {&out.band, &grid.band_weight}}) {
    const auto integral = [&](const std::vector<double>& s) {
      return s.empty() ? Values() : per_bin(grid, offset, *weight, s);
    };
    const auto mean = [&](const std::vector<double>& s) {
      return per_bin(grid, offset, grid.bin_weight, s);
    };
    to->width = integral(ones);
    to->transmittance = integral(e.transmittance);
    to->path_radiance = integral(e.path_radiance);
    to->model_error_transmittance = integral(e.model_error_transmittance);
    to->model_error_path_radiance = integral(e.model_error_path_radiance);
    if (!e.behind_apparent.empty()) to->behind = integral(e.behind_apparent.front());
    to->arriving = {to->transmittance,
                    arriving(integral(e.sun_apparent), mean(e.sun), to->transmittance),
                    arriving(integral(sides[0].seen), mean(sides[0].radiance), to->transmittance),
                    arriving(integral(sides[1].seen), mean(sides[1].radiance), to->transmittance),
                    to->transmittance};
  }
  return out;
}

}  // namespace irsig

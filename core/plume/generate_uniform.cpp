#include <cmath>

#include "core/base/status_macros.h"
#include "core/plume/generate_plume.h"
#include "core/plume/generated_volume.h"
#include "fmt/format.h"

namespace irsig {
namespace {

struct Extent {
  double x, y, z;  // half of it
};

absl::StatusOr<Extent> extent_of(const UniformPlume& p) {
  const auto wrong = [&](const char* what, double is) {
    return absl::InvalidArgumentError(
        fmt::format("{}: {} {:g}, expected at least a voxel ({:g} m) and at most 1e5 m", p.kind,
                    what, is, p.voxel_m));
  };
  const auto good = [&](double x) { return x >= p.voxel_m && x <= 1e5; };
  if (p.kind == "sphere") {
    if (!good(p.radius_m)) return wrong("radius", p.radius_m);
    return Extent{p.radius_m, p.radius_m, p.radius_m};
  }
  if (!good(p.length_m)) return wrong("length", p.length_m);
  if (p.kind == "cylinder") {
    if (!good(p.radius_m)) return wrong("radius", p.radius_m);
    return Extent{p.length_m / 2, p.radius_m, p.radius_m};
  }
  if (p.kind != "slab")
    return absl::InvalidArgumentError(
        fmt::format("plume \"{}\", expected funnel, slab, cylinder or sphere", p.kind));
  if (!good(p.width_m)) return wrong("width", p.width_m);
  if (!good(p.height_m)) return wrong("height", p.height_m);
  return Extent{p.length_m / 2, p.width_m / 2, p.height_m / 2};
}

bool inside_plume(const UniformPlume& p, const Extent& half, double x, double y, double z) {
  if (p.kind == "sphere") return x * x + y * y + z * z < p.radius_m * p.radius_m;
  if (!(std::abs(x) < half.x)) return false;
  if (p.kind == "cylinder") return y * y + z * z < p.radius_m * p.radius_m;
  return std::abs(y) < half.y && std::abs(z) < half.z;
}

}  // namespace

GeneratedVolume::GeneratedVolume(double voxel_m, double pressure_pa,
                                 const std::array<double, kPlumeSpecies>& fraction)
    : value_() {
  volume_.world_from_index = {voxel_m, 0,           0, voxel_m / 2, 0,       voxel_m,
                              0,       voxel_m / 2, 0, 0,           voxel_m, voxel_m / 2};
  volume_.channel = {"temperature"};
  GridOrConstant* species[] = {&grids_.co2, &grids_.h2o, &grids_.co, &grids_.soot};
  const char* names[] = {"co2", "h2o", "co", "soot"};
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    species[s]->unit = "1";
    if (fraction[s] > 0) {
      species[s]->grid = names[s];
      volume_.channel.emplace_back(names[s]);
      fraction_.emplace_back(fraction[s], s == kSoot);
    } else {
      species[s]->constant = 0;
    }
  }
  grids_.temperature = {"temperature", std::nullopt, "K"};
  grids_.pressure = {"", pressure_pa, "Pa"};
  volume_.background.assign(volume_.channel.size(), 0);
  value_.resize(512 * volume_.channel.size());
}

void GeneratedVolume::set(unsigned offset, double temperature_k, double share,
                          double soot_fraction) {
  float* to = value_.data() + offset * volume_.channel.size();
  to[0] = static_cast<float>(temperature_k);
  for (std::size_t c = 0; c < fraction_.size(); ++c)
    to[c + 1] =
        static_cast<float>(fraction_[c].first * (fraction_[c].second ? soot_fraction : share));
  mask_[offset >> 6] |= std::uint64_t{1} << (offset & 63);
}

void GeneratedVolume::add_block(std::array<std::int32_t, 3> origin) {
  VolumeWriter(volume_).add(origin, std::vector<VoxelMask>(volume_.channel.size(), mask_), value_);
  mask_.fill(0);
}

void GeneratedVolume::finish(GeneratedPlume& out) {
  out.volume = std::move(volume_);
  out.grids = grids_;
}

absl::StatusOr<GeneratedPlume> generate_uniform_plume(const UniformPlume& plume) {
  if (!(plume.voxel_m >= 1e-6 && plume.voxel_m <= 1e4))
    return absl::InvalidArgumentError(
        fmt::format("voxel_m {:g}, expected 1e-6 to 1e4", plume.voxel_m));
  ASSIGN_OR_RETURN(const Extent half, extent_of(plume));
  // Refuse what a field would be refused for.
  PlumeGrids said;
  said.temperature = {"", plume.temperature_k, "K"};
  said.pressure = {"", plume.pressure_pa, "Pa"};
  said.co2 = {"co2", std::nullopt, "1"};
  said.h2o = {"", plume.h2o, "1"};
  said.co = {"", plume.co, "1"};
  said.soot = {"", plume.soot, "1"};
  if (const auto checked = check_plume_grids(said); !checked.ok()) return checked.status();
  const double sum = plume.co2 + plume.h2o + plume.co;
  if (!(plume.co2 >= 0 && sum <= 1 && sum + plume.soot > 0))
    return absl::InvalidArgumentError(
        fmt::format("mole fractions co2 {:g}, h2o {:g} and co {:g}, expected 0 to 1 in all, and "
                    "some gas or soot",
                    plume.co2, plume.h2o, plume.co));

  const double h = plume.voxel_m;
  const auto blocks = [&](double x) { return static_cast<std::int32_t>(std::ceil(x / (8 * h))); };
  const double count =
      8.0 * std::ceil(half.x / (8 * h)) * std::ceil(half.y / (8 * h)) * std::ceil(half.z / (8 * h));
  if (count > static_cast<double>(kMostGeneratedBlocks))
    return absl::InvalidArgumentError(
        fmt::format("voxel_m {:g} makes {:g} blocks of 8^3 voxels, expected at most {}", h, count,
                    kMostGeneratedBlocks));
  GeneratedVolume volume(h, plume.pressure_pa, {plume.co2, plume.h2o, plume.co, plume.soot});
  constexpr int kPoints = 6;
  const auto share = [&](int i, int j, int k) {
    int in = 0, all = 0;
    const auto at = [&](int c, int n) { return h * (c + (n + 0.5) / kPoints); };
    for (int n = 0; n < kPoints * kPoints * kPoints; ++n, ++all)
      in += inside_plume(plume, half, at(i, n % kPoints), at(j, n / kPoints % kPoints),
                         at(k, n / kPoints / kPoints));
    return static_cast<double>(in) / all;
  };
  for (std::int32_t x = -blocks(half.x); x < blocks(half.x); ++x)
    for (std::int32_t y = -blocks(half.y); y < blocks(half.y); ++y)
      for (std::int32_t z = -blocks(half.z); z < blocks(half.z); ++z) {
        for (int v = 0; v < 512; ++v)
          if (const double in = share(8 * x + (v >> 6), 8 * y + (v >> 3 & 7), 8 * z + (v & 7));
              in > 0)
            volume.set(static_cast<unsigned>(v), plume.temperature_k, in, in);
        volume.add_block({8 * x, 8 * y, 8 * z});
      }
  GeneratedPlume out;
  volume.finish(out);
  return out;
}

}  // namespace irsig

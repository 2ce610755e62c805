#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_spectrum.h"
#include "core/plume/gas_light.h"
#include "core/plume/generate_plume.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "core/plume/vdb_subprocess.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/spectral/planck.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

namespace irsig {
namespace {

using enum PlumeInterpolation;
using Cell = std::array<std::int32_t, 3>;
using Field = std::shared_ptr<const PlumeField>;

constexpr double kPressurePa = 101325;

// Carbon dioxide of a voxel; none where the fraction is 0.
struct Voxel {
  double temperature_k = 0, co2 = 0;
};
constexpr Voxel kWarm{600, 0.1};

// [mol/m3] as a file of floats holds it.
double density(const Voxel& voxel) {
  return static_cast<double>(static_cast<float>(voxel.co2)) * kPressurePa /
         (kGasConstantJMolK * voxel.temperature_k);
}

// On the body's own axes. All voxels of [low, high].
VoxelVolume volume_of(Cell low, Cell high, const std::array<double, 12>& world_from_index,
                      const std::function<Voxel(int, int, int)>& voxel) {
  VoxelVolume out;
  out.world_from_index = world_from_index;
  out.channel = {"temperature", "co2"};
  out.background = {0, 0};
  VolumeWriter writer(out);
  std::vector<float> value(512 * 2);
  for (int x = low[0] & -8; x <= high[0]; x += 8)
    for (int y = low[1] & -8; y <= high[1]; y += 8)
      for (int z = low[2] & -8; z <= high[2]; z += 8) {
        VoxelMask mask{};
        for (int v = 0; v < 512; ++v) {
          const int i = x + (v >> 6), j = y + (v >> 3 & 7), k = z + (v & 7);
          if (i < low[0] || j < low[1] || k < low[2] || i > high[0] || j > high[1] || k > high[2])
            continue;
          const Voxel at = voxel(i, j, k);
          if (!(at.temperature_k != 0 || at.co2 != 0)) continue;
          mask[static_cast<std::size_t>(v >> 6)] |= std::uint64_t{1} << (v & 63);
          value[static_cast<std::size_t>(2 * v)] = static_cast<float>(at.temperature_k);
          value[static_cast<std::size_t>(2 * v + 1)] = static_cast<float>(at.co2);
        }
        writer.add({x, y, z}, {mask, mask}, value);
      }
  return out;
}
constexpr std::array<double, 12> cubes(double edge_m, double x_m = 0) {
  return {edge_m, 0, 0, x_m, 0, edge_m, 0, 0, 0, 0, edge_m, 0};
}
Voxel everywhere(int, int, int) { return kWarm; }

PlumeGrids grids(PlumeInterpolation interpolation) {
  PlumeGrids out;
  out.temperature = {"temperature", std::nullopt, "K"};
  out.pressure = {"", kPressurePa, "Pa"};
  out.co2 = {"co2", std::nullopt, "1"};
  out.h2o = out.co = out.soot = {"", 0.0, "1"};
  out.interpolation = interpolation;
  out.up_axis = "-z";
  return out;
}
absl::StatusOr<Field> field_of(VoxelVolume volume, PlumeInterpolation interpolation) {
  return plume_of(std::move(volume), grids(interpolation));
}

double amount(const std::vector<GasSegment>& segments) {
  double sum = 0;
  for (const GasSegment& s : segments) sum += s.amount[0];
  return sum;
}
double amount(const PlumeField& field, Vec<Body> from, Vec<Body> to, double end_m = 1000) {
  return amount(march(field, {from, to, 0, end_m}, {}));
}

const char* name_of(PlumeInterpolation how) { return how == kLinear ? "linear" : "constant"; }

// Rays that lie in faces and edges of voxels, from both sides, and in what separates blocks.
absl::StatusOr<Finding> along_faces(Effort) {
  Worst worst(3e-7);
  for (const PlumeInterpolation how : {kConstant, kLinear}) {
    ASSIGN_OR_RETURN(const auto field,
                     field_of(volume_of({0, 0, 0}, {15, 15, 7}, cubes(1), everywhere), how));
    // Linear: of centres at 0 and 15 the ramps beyond are half of a voxel's each.
    const double whole = 16 * density(kWarm);
    struct Ray {
      double y, z, share;
    };
    const std::vector<Ray> rays =
        how == kConstant
            ? std::vector<Ray>{{3.5, 3.5, 1}, {3.5, 2, 1},  {7.5, 7.4, 1}, {7.5, 3.5, 1},
                               {-0.5, 2, 1},  {15.5, 2, 0}, {3, 7.5, 0}}
            : std::vector<Ray>{{7, 3, 1},    {0, 0, 1},        {7.5, 3.5, 1}, {15, 7, 1},
                               {3, 7.5, .5}, {15.5, 7.5, .25}, {16, 3, 0},    {-1, 3, 0}};
    for (const Ray& ray : rays)
      for (const double way : {1.0, -1.0}) {
        const double got = amount(*field, {way > 0 ? -5.0 : 25.0, ray.y, ray.z}, {way, 0, 0}, 100);
        worst.see(std::abs(got / whole - ray.share), [&] {
          return absl::StrCat(name_of(how), ", y ", ray.y, ", z ", ray.z, ", along ", way, ": ",
                              got / whole, " of a row, expected ", ray.share);
        });
      }
  }
  return worst.finding();
}

// The diagonal of uniform blocks that touch at a corner, and of one far away.
absl::StatusOr<Finding> tile_corner(Effort) {
  Worst worst(3e-7);
  VoxelVolume volume;
  volume.world_from_index = cubes(1);
  volume.channel = {"temperature", "co2"};
  volume.background = {0, 0};
  VolumeWriter writer(volume);
  for (const int at : {0, 8, 128}) writer.add_uniform({at, at, at}, {600, 0.1F});
  const double root3 = std::sqrt(3.0), n = density(kWarm);
  for (const PlumeInterpolation how : {kConstant, kLinear}) {
    ASSIGN_OR_RETURN(const auto field, field_of(volume, how));
    const Vec<Body> diagonal = (1 / root3) * Vec<Body>{1, 1, 1};
    // Linear: the mean of (1 - s)^3 over a ramp is a quarter, of 1 - 3 s (1 - s) between the
    // blocks that touch a half.
    const double expected =
        how == kConstant ? 24 * root3 * n : (3 * 7 + 4 * 0.25 + 0.5) * root3 * n;
    for (const double way : {1.0, -1.0}) {
      const Vec<Body> to = way * diagonal;
      const double got = amount(*field, Vec<Body>{60, 60, 60} - 200.0 * to, to);
      worst.see(std::abs(got / expected - 1), [&] {
        return absl::StrCat(name_of(how), ": ", got, " mol/m2, expected ", expected);
      });
    }
    if (how == kLinear) continue;
    // Past the corner that two of them share, through neither.
    const Vec<Body> past = (1 / std::sqrt(2.0)) * Vec<Body>{1, -1, 0};
    worst.see(amount(*field, Vec<Body>{7.5, 7.5, 7.5} - 9.0 * past, past) / expected,
              [] { return std::string("past the corner of two blocks"); });
  }
  return worst.finding();
}

// A single voxel: through its centre, from inside, past it.
absl::StatusOr<Finding> one_voxel(Effort) {
  Worst worst(3e-7);
  for (const PlumeInterpolation how : {kConstant, kLinear}) {
    ASSIGN_OR_RETURN(const auto field,
                     field_of(volume_of({3, 4, 5}, {3, 4, 5}, cubes(1), everywhere), how));
    const Vec<Body> middle{3, 4, 5};
    for (const Vec<Body> to : {Vec<Body>{1, 0, 0}, Vec<Body>{0, -1, 0}, Vec<Body>{0, 0, 1}}) {
      worst.see(std::abs(amount(*field, middle - 10.0 * to, to) / density(kWarm) - 1),
                [&] { return absl::StrCat(name_of(how), ": through its centre"); });
      worst.see(std::abs(amount(*field, middle, to) / density(kWarm) - 0.5),
                [&] { return absl::StrCat(name_of(how), ": from its centre"); });
      worst.see(amount(*field, middle + 1.5 * to, to) / density(kWarm),
                [&] { return absl::StrCat(name_of(how), ": away from it"); });
    }
  }
  return worst.finding();
}

// 1e9 empty voxels between two that hold gas: both are found, in few steps.
absl::StatusOr<Finding> far_voxel(Effort) {
  Worst worst(3e-7);
  VoxelVolume volume = volume_of({0, 0, 0}, {0, 0, 0}, cubes(1e-3), everywhere);
  const VoxelVolume one = volume;
  for (const Cell origin : {Cell{1'000'000'000, 0, 0}, Cell{0, -800'000'000, 0}}) {
    volume.block.push_back({origin, VoxelBlock::Form::kPacked});
    volume.mask.insert(volume.mask.end(), one.mask.begin(), one.mask.end());
    volume.value.insert(volume.value.end(), one.value.begin(), one.value.end());
  }
  ASSIGN_OR_RETURN(const auto field, field_of(volume, kLinear));
  MarchCounts counts;
  const auto segments = march(*field, {{-1, 0, 0}, {1, 0, 0}, 0, 2e6}, {}, &counts);
  const double expected = 2e-3 * density(kWarm);
  worst.see(std::abs(amount(segments) / expected - 1),
            [&] { return absl::StrCat(amount(segments), " mol/m2, expected ", expected); });
  worst.require(counts.skips + counts.cells < 200,
                [&] { return absl::StrCat(counts.skips + counts.cells, " steps"); });
  worst.require(field->bytes() < 200'000, [&] { return absl::StrCat(field->bytes(), " bytes"); });
  return worst.finding();
}

GasLight light(const std::vector<GasSegment>& segments, const GreyAbsorption& grey,
               const std::function<double(double)>& blackbody, double background) {
  std::vector<double> depth;
  std::vector<SegmentSource> source;
  for (const GasSegment& s : segments) {
    depth.push_back(grey.optical_depth(s));
    source.push_back(segment_source(s, blackbody));
  }
  return light_through(depth, source, background);
}

// Optical depths of 1e-12 and 1e4 in one ray: each as if the other were not there.
absl::StatusOr<Finding> thin_and_thick(Effort) {
  Worst worst(3e-7);
  constexpr double kThin = 1e-12, kThick = 1e4;
  const double per_m = kThick / (4 * density({2000, 0.5}));
  const double thin = kThin / (4 * per_m) * kGasConstantJMolK * 300 / kPressurePa;
  const auto field = field_of(volume_of({0, -8, -8}, {23, 8, 8}, cubes(1),
                                        [&](int i, int, int) {
                                          if (i < 4) return Voxel{300, thin};
                                          return i >= 16 && i < 20 ? Voxel{2000, 0.5} : Voxel{};
                                        }),
                              kConstant);
  if (!field.ok()) return field.status();
  const GreyAbsorption grey{{per_m, 0, 0, 0}};
  const auto b = [](double t) { return planck_radiance_w_m2_sr_um(4.3, t); };
  const auto see = [&](const char* what, double got, double expected) {
    worst.see(std::abs(got / expected - 1),
              [&] { return absl::StrCat(what, ": ", got, ", expected ", expected); });
  };
  const auto segments = march(**field, {{-5, 0, 0}, {1, 0, 0}, 0, 100}, {});
  if (segments.size() != 2) return absl::InternalError("thin and thick gas are no two segments");
  see("thin optical depth", grey.optical_depth(segments[0]), kThin);
  see("thick optical depth", grey.optical_depth(segments[1]), kThick);
  const GasLight both = light(segments, grey, b, b(2000));
  see("radiance", both.emitted, b(2000));
  // Before a background as hot as the wall, all that is left is what the thin gas takes.
  see("contrast", both.contrast, kThin * (b(300) - b(2000)));
  const GasLight only = light({segments[0]}, grey, b, 0);
  see("thin radiance", only.emitted, kThin * b(300));
  see("thin absorption", only.absorptance, kThin);
  return worst.finding();
}

// Gas of 2000 K, and as warm as what is behind it: through zero with the right sign.
absl::StatusOr<Finding> gas_contrast_through_zero(Effort) {
  Worst worst(4e-5);
  const auto b = [](double t) { return planck_band_radiance_w_m2_sr(3, 5, t); };
  const double slope = (b(300.1) - b(299.9)) / 0.2;
  for (const double tau : {1e-9, 1.0, 100.0}) {
    const auto contrast = [&](double t) {
      const double depth[] = {tau};
      const SegmentSource source[] = {{b(t), 0, 0}};
      return light_through(depth, source, b(300)).contrast;
    };
    worst.require(contrast(300) == 0, [&] { return absl::StrCat("tau ", tau, ": not 0"); });
    for (const double step_k : {1e-3, -1e-3}) {
      const double expected = -std::expm1(-tau) * slope * step_k;
      worst.see(std::abs(contrast(300 + step_k) / expected - 1), [&] {
        return absl::StrCat("tau ", tau, ", ", step_k, " K: ", contrast(300 + step_k),
                            ", expected ", expected);
      });
    }
    worst.see(std::abs(contrast(2000) / (-std::expm1(-tau) * (b(2000) - b(300))) - 1),
              [&] { return absl::StrCat("tau ", tau, ", 2000 K"); });
  }
  return worst.finding();
}

// Scaled differently along its axes, turned and sheared: lengths are the world's.
absl::StatusOr<Finding> any_lattice(Effort) {
  Worst worst(3e-7);
  const std::array<std::array<double, 12>, 3> lattices = {{
      {0.02, 0, 0, 3, 0, 0.5, 0, -2, 0, 0, 4, 7},           // 1 : 25 : 200
      {0, -0.5, 0, 3, 0.5, 0, 0, -2, 0, 0, 0.5, 7},         // turned
      {0.5, 0.1, 0, 3, 0.05, 0.2, 0, -2, 0, 0.03, 1.5, 7},  // sheared
  }};
  for (const auto& m : lattices) {
    ASSIGN_OR_RETURN(const auto field,
                     field_of(volume_of({-20, -20, -20}, {20, 20, 20}, m, everywhere), kConstant));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vec<Body> edge{m[axis], m[4 + axis], m[8 + axis]};
      const Vec<Body> to = (1 / length(edge)) * edge;
      const double expected = 41 * length(edge) * density(kWarm);
      const double got = amount(*field, Vec<Body>{m[3], m[7], m[11]} - 300.0 * to, to);
      worst.see(std::abs(got / expected - 1), [&] {
        return absl::StrCat("along axis ", axis, " of a lattice of edges ", m[0], " ...: ", got,
                            " mol/m2, expected ", expected);
      });
    }
  }
  return worst.finding();
}

// Gas at the same places gives equal results with grid indices around 0 and around 1e6.
absl::StatusOr<Finding> far_from_origin(Effort) {
  Worst worst(1e-10);
  constexpr int kShift = 1'000'000;
  constexpr double kEdge = 0.125;
  const auto made = [&](int shift) {
    return field_of(
        volume_of({shift, 0, 0}, {shift + 39, 39, 39}, cubes(kEdge, -kEdge * shift),
                  [&](int i, int j, int k) {
                    const double x = (i - shift - 20) / 12.0, y = (j - 20) / 9.0,
                                 z = (k - 20) / 9.0;
                    const double share = std::exp(-x * x - y * y - z * z);
                    return share < 0.01 ? Voxel{} : Voxel{300 + 900 * share, 0.1 * share};
                  }),
        kLinear);
  };
  ASSIGN_OR_RETURN(const auto near, made(0));
  ASSIGN_OR_RETURN(const auto far, made(kShift));
  const Vec<Body> middle{20 * kEdge, 20 * kEdge, 20 * kEdge};
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec<Body> to = uniform_direction(0x91, 2 * i);
    const Vec<Body> at = middle + 1.5 * uniform(0x92, i) * uniform_direction(0x93, 2 * i);
    std::array<double, 2> gas{}, heat{};
    for (std::size_t which = 0; which < 2; ++which)
      // The far grid is entered from 50 km away.
      for (const GasSegment& s :
           march(which == 0 ? *near : *far,
                 {at - (which == 0 ? 20.0 : 5e4) * to, to, 0, which == 0 ? 40 : 1e5}, {})) {
        gas[which] += s.amount[0];
        heat[which] += s.weight * s.temperature_k;
      }
    if (!(gas[0] > 0)) continue;
    worst.see(std::max(std::abs(gas[1] / gas[0] - 1), std::abs(heat[1] / heat[0] - 1)),
              [&] { return absl::StrCat("ray ", i, ": ", gas[1], " mol/m2, near ", gas[0]); });
  }
  return worst.finding();
}

// A VDB file (OpenVDB's own bytes, uncompressed, in hex) of one active tile "temperature" whose
// transform is a frustum: cells between them are no parallelepipeds.
constexpr std::string_view kFrustumFile =
    "2042445600000000e00000000a000000000000000032353862636631652d323436342d343664362d623264312d33"
    "356135366365363465393000000000010000000b00000074656d706572617475726510000000547265655f666c6f"
    "61745f355f345f330000000000000000000000000000000000000000000000000000000000000000030000000500"
    "0000636c61737306000000737472696e670a000000666f6720766f6c756d651100000066696c655f64656c617965"
    "645f6c6f61640d0000005f5f64656c617965646c6f616400000000040000006e616d6506000000737472696e670b"
    "00000074656d7065726174757265130000004e6f6e6c696e6561724672757374756d4d6170000000000000000000"
    "000000000000000000000000000000000000000000244000000000000024400000000000002440000000000000e0"
    "3f000000000000244009000000416666696e654d6170000000000000e03f00000000000000000000000000000000"
    "00000000000000000000000000000000000000000000e03f00000000000000000000000000000000000000000000"
    "00000000000000000000000000000000e03f00000000000000000000000000000000000000000000000000000000"
    "00000000000000000000f03f010000000000000001000000000000000000000000000000000000000000164401";

std::string from_hex(std::string_view hex) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    out.push_back(static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  return out;
}

// Input that is no gas is refused, and the message names the reason.
absl::StatusOr<Finding> refused(Effort) {
  Worst worst(0);
  const auto refusal = [&](const char* what, const absl::Status& status, const char* reason) {
    worst.require(absl::IsInvalidArgument(status) && absl::StrContains(status.message(), reason),
                  [&] { return absl::StrCat(what, ": ", status.ToString()); });
  };
  const auto with = [](const std::function<Voxel(int, int, int)>& voxel) {
    return field_of(volume_of({0, 0, 0}, {8, 8, 8}, cubes(1), voxel), kLinear).status();
  };
  const auto odd = [&](Voxel at) {
    return with([=](int i, int j, int k) { return i == 3 && j == 4 && k == 5 ? at : kWarm; });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    refusal("temperature", odd({bad, 0.1}),
            "\"temperature\": not finite (1 voxel, the first at (3, 4, 5)");
    refusal("fraction", odd({600, bad}), "\"co2\": not finite (1 voxel, the first at (3, 4, 5)");
  }
  refusal("a temperature of 50 K", odd({50, 0.1}), "(3, 4, 5)");
  refusal("a fraction of 1.1", odd({600, 1.1}), "(3, 4, 5)");
  refusal("a fraction of -1e-6", odd({600, -1e-6}), "(3, 4, 5)");
  refusal("shares of a temperature", with([](int, int, int) {
            return Voxel{0.9, 0.1};
          }),
          "expected K or degC");
  refusal("no gas", with([](int, int, int) { return Voxel{600, 0}; }), "no gas");
  refusal("no voxels",
          field_of(volume_of({0, 0, 0}, {-1, -1, -1}, cubes(1), everywhere), kLinear).status(),
          "no gas");
  VoxelVolume flat = volume_of({0, 0, 0}, {8, 8, 8}, cubes(1), everywhere);
  flat.world_from_index[10] = 0;
  refusal("flat voxels", field_of(flat, kLinear).status(), "flat");
  refusal("a frustum", import_plume(from_hex(kFrustumFile), "a.vdb", grids(kLinear)).status(),
          "grid \"temperature\": its transform is a NonlinearFrustumMap");
  refusal("bytes that are no file", import_plume("no volume", "a.vdb", grids(kLinear)).status(),
          "a.vdb: ");
  return worst.finding();
}

// Radiance of exhaust of 700 K with soot, through `length_m` of it. The voxels have edges of 1/4 m,
// 16 in a row.
struct Column {
  std::vector<double> emitted_w_m2_sr, taken_w_m2_sr;  // [band]; taken of a blackbody
};
absl::StatusOr<Column> column_of(const Simulator& simulator, double length_m, double behind_k) {
  const std::vector<GasLayer> path = {{{700, kPressurePa, 0.06, 0.07, 0, 1e-7}, length_m}};
  Column out;
  for (const BandGrid& grid : simulator.band_grids()) {
    double emitted = 0, taken = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
      ASSIGN_OR_RETURN(const auto band, gas_band(grid.node_um[i]));
      ASSIGN_OR_RETURN(const auto gas, gas_spectrum(path, {band, band + 1}));
      const double absorbed = grid.band_weight[i] * gas.absorptance[0];
      emitted += absorbed * planck_radiance_w_m2_sr_um(grid.node_um[i], 700);
      taken += absorbed * planck_radiance_w_m2_sr_um(grid.node_um[i], behind_k);
    }
    out.emitted_w_m2_sr.push_back(emitted);
    out.taken_w_m2_sr.push_back(taken);
  }
  return out;
}

absl::StatusOr<Field> slab(double length_m, double width_m, Vec<Body> at) {
  UniformPlume spec{.kind = "slab", .length_m = length_m, .width_m = width_m, .height_m = width_m};
  spec.temperature_k = 700;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-7;
  spec.voxel_m = 0.25;
  ASSIGN_OR_RETURN(auto made, generate_uniform_plume(spec));
  made.grids.interpolation = kConstant;
  made.grids.position_m = at;
  return plume_of(std::move(made.volume), made.grids);
}

// From ahead, 100 km away.
absl::StatusOr<ViewResult> view_of_gas(const Simulator& simulator, Field gas,
                                       std::uint64_t samples) {
  ViewRequest r = dark_view(simulator, 0, 0, 1e5, {400});
  r.condition[0].gas = std::move(gas);
  r.accuracy.samples_per_replicate = samples;
  return simulator.simulate(r);
}

absl::StatusOr<std::unique_ptr<Simulator>> black_box(double edge_m) {
  ASSIGN_OR_RETURN(auto mesh, generate_mesh({"box", 12, 0, edge_m, edge_m, edge_m}));
  SceneSpec scene = one_body(std::move(mesh), grey_paint(1));
  scene.band = {{"MWIR", 3, 5, 0.25, {}}, {"LWIR", 8, 12, 0.5, {}}};
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  return Simulator::create(scene);
}

// Gas around the sensor's line alone: two voxels across, 50 m along it.
absl::StatusOr<Finding> line_of_sight(Effort) {
  Worst worst(4.5);
  ASSIGN_OR_RETURN(const auto simulator, black_box(0.01));
  ASSIGN_OR_RETURN(const auto gas, slab(50, 0.5, {30, 0, 0}));
  ASSIGN_OR_RETURN(const auto view, view_of_gas(*simulator, gas, 1024));
  ASSIGN_OR_RETURN(const auto column, column_of(*simulator, 50, 400));
  for (std::size_t b = 0; b < view.row.size(); ++b) {
    const double expected = 0.25 * column.emitted_w_m2_sr[b];
    const Estimate& got = view.row[b].plume_w_sr;
    // 50 m at 1e5 m: its near end looks 5e-4 larger, its far end as much smaller.
    worst.see(t_of(got, expected, 1e-3), [&] {
      return absl::StrCat("band ", b, ": ", got.value, " +- ", got.stderr_, " W/sr, expected ",
                          expected);
    });
    worst.require(got.stderr_ < 0.01 * expected,
                  [&] { return absl::StrCat("band ", b, ": known to ", got.stderr_, " W/sr"); });
  }
  return worst.finding();
}

// Gas that reaches into the hull: what is in it is not there; a face of voxels in a face of it.
absl::StatusOr<Finding> touching_hull(Effort) {
  Worst worst(4.5);
  ASSIGN_OR_RETURN(const auto simulator, black_box(2));
  const auto gas = slab(2, 4, {1, 0, 0});  // x from 0 to 2; the hull ends at 1
  if (!gas.ok()) return gas.status();
  ASSIGN_OR_RETURN(const auto view, view_of_gas(*simulator, *gas, 512));
  ASSIGN_OR_RETURN(const auto beside, column_of(*simulator, 2, 400));
  ASSIGN_OR_RETURN(const auto before, column_of(*simulator, 1, 400));
  for (std::size_t b = 0; b < view.row.size(); ++b) {
    const double expected =
        12 * beside.emitted_w_m2_sr[b] + 4 * (before.emitted_w_m2_sr[b] - before.taken_w_m2_sr[b]);
    const Estimate& got = view.row[b].plume_w_sr;
    worst.see(t_of(got, expected, 3e-3 + view.row[b].plume_bound_w_sr / expected), [&] {
      return absl::StrCat("band ", b, ": ", got.value, " +- ", got.stderr_, " W/sr, expected ",
                          expected);
    });
    worst.require(view.row[b].plume_bound_w_sr + got.stderr_ < 0.01 * expected, [&] {
      return absl::StrCat("band ", b, ": bound ", view.row[b].plume_bound_w_sr, " W/sr");
    });
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> plume_cases() {
  return {
      {"plume", "along_faces", "rays in faces and edges of voxels: amount of gas, relative",
       "the field's definition; amounts are sums of floats (6e-8) and exact along a ray",
       along_faces},
      {"plume", "tile_corner", "through the corner where uniform blocks touch, and past it: amount",
       "the same: cubic ramps of the linear field have integrals of 1/4 and 1/2", tile_corner},
      {"plume", "one_voxel", "through, from inside and away from one voxel: amount, relative",
       "its length in the voxel x its density; voxels are floats", one_voxel},
      {"plume", "far_voxel", "1e9 empty voxels between two: amount, relative; in 200 steps",
       "the same; steps through what is empty are up to 4096 voxels of nodes that are there",
       far_voxel},
      {"plume", "thin_and_thick", "optical depths 1e-12 and 1e4 in one ray: each, relative",
       "light of both is a sum without cancellation; floats of mole fractions near 1e-12",
       thin_and_thick},
      {"plume", "contrast_through_zero", "gas of 300 K -+ 1 mK and 2000 K before 300 K, relative",
       "B(T) - B(300) by its slope: curvature at 1 mK is 2e-5 of it", gas_contrast_through_zero},
      {"plume", "any_lattice", "voxels of 1 : 25 : 200, turned, sheared: amount along their edges",
       "41 edges of world metres; floats", any_lattice},
      {"plume", "far_from_origin", "a million voxels from the lattice's origin, from 50 km: amount",
       "the same voxels elsewhere: doubles of 50 km hold places to 1e-11 m", far_from_origin},
      {"plume", "refused", "NaN, infinite, too cold, negative, no gas, flat or frustum lattices",
       "each is refused, with the grid or the voxel", refused},
      {"plume", "line_of_sight", "gas two voxels across around the sensor's line, 50 m of it [t]",
       "Student's t; area times the spectrum of its column, and 1e-3 of perspective",
       line_of_sight},
      {"plume", "touching_hull", "gas half inside the hull: what is outside sends and takes [t]",
       "Student's t; closed form of three areas, 3e-3 of perspective, and the stated bound",
       touching_hull},
  };
}

}  // namespace irsig

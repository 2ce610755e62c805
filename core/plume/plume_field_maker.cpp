#include "core/plume/plume_field_maker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"

namespace irsig {
namespace {

using Form = VoxelBlock::Form;
using Cell = BlockTree::Cell;

// Beyond it the corners of blocks would leave 32 bits.
constexpr std::int32_t kMostIndex = 1 << 30;

absl::Status refuse(const std::string& what) { return absl::InvalidArgumentError(what); }

std::string place(const Cell& at) { return fmt::format("({}, {}, {})", at[0], at[1], at[2]); }

Cell at_offset(const Cell& origin, unsigned offset) {
  return {origin[0] + static_cast<int>(offset >> 6), origin[1] + static_cast<int>(offset >> 3 & 7),
          origin[2] + static_cast<int>(offset & 7)};
}

}  // namespace

absl::Status PlumeFieldMaker::match_channels() {
  for (const std::string& name : reading_.grid) {
    const auto at = std::find(volume_.channel.begin(), volume_.channel.end(), name);
    if (at == volume_.channel.end()) return refuse(fmt::format("no grid \"{}\"", name));
    channel_.push_back(static_cast<std::size_t>(at - volume_.channel.begin()));
  }
  not_finite_.resize(channel_.size());
  outside_.resize(channel_.size());
  background_.resize(channel_.size());
  return absl::OkStatus();
}

// Body from index and its inverse. Condition: the ratio of the longest to the shortest edge and the
// skew of a voxel together; a flat one is a mistake, and costs digits.
absl::Status PlumeFieldMaker::check_lattice() {
  const auto& w = volume_.world_from_index;
  const auto& b = reading_.body_from_world;
  std::array<double, 12>& m = field_->body_from_index_;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      m[4 * r + c] = b[4 * r] * w[c] + b[4 * r + 1] * w[4 + c] + b[4 * r + 2] * w[8 + c] +
                     (c == 3 ? b[4 * r + 3] : 0);
  const auto e = [&](std::size_t r, std::size_t c) { return m[4 * (r % 3) + c % 3]; };
  double det = 0, size = 0, inverse_size = 0;
  for (std::size_t c = 0; c < 3; ++c)
    det += e(0, c) * (e(1, c + 1) * e(2, c + 2) - e(1, c + 2) * e(2, c + 1));
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const double cofactor = e(r + 1, c + 1) * e(r + 2, c + 2) - e(r + 1, c + 2) * e(r + 2, c + 1);
      field_->index_from_body_[4 * c + r] = cofactor / det;
      size += e(r, c) * e(r, c);
      inverse_size += (cofactor / det) * (cofactor / det);
    }
  constexpr double kMostCondition = 1e4;
  const double condition = std::sqrt(size * inverse_size) / 3;
  if (!(condition <= kMostCondition))
    return refuse(
        fmt::format("grid \"{}\": its voxels are flat: the ratio of their edges, skew included, is "
                    "{:.3g}, expected at most {:g}",
                    reading_.grid[0], condition, kMostCondition));
  field_->voxel_volume_m3_ = std::abs(det);
  if (!(std::cbrt(std::abs(det)) >= 1e-6 && std::cbrt(std::abs(det)) <= 1e4))
    return refuse(
        fmt::format("grid \"{}\": a voxel of {:.3g} m, expected 1e-6 to 1e4 m: is unit_m right?",
                    reading_.grid[0], std::cbrt(std::abs(det))));
  return absl::OkStatus();
}

PlumeFieldMaker::Voxel PlumeFieldMaker::voxel_of(const VoxelMask* masks, unsigned offset,
                                                 const float* values, const Cell& origin) {
  Voxel out;
  out.at = at_offset(origin, offset);
  // The value of a quantity and whether the voxel has it.
  const auto get = [&](const PlumeQuantity& q, double& value) {
    if (q.channel < 0) {
      value = q.constant;
      return true;
    }
    const std::size_t grid = static_cast<std::size_t>(q.channel), channel = channel_[grid];
    if (!holds(masks[channel], offset)) return false;
    const auto raw = static_cast<double>(values[channel]);
    if (!std::isfinite(raw)) {
      not_finite_[grid].add(out.at, raw);
      out.finite = false;
      return true;
    }
    value = q.scale * raw + q.offset;
    return true;
  };
  out.has_temperature = get(reading_.temperature, out.temperature_k);
  out.has_pressure = get(reading_.pressure, out.pressure_pa);
  bool any_species = false;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    const PlumeQuantity& q = reading_.species[s];
    const bool there = get(q, out.fraction[s]);
    any_species = any_species || (there && q.channel >= 0);
    if (q.channel < 0 || !there) continue;
    const double x = out.fraction[s];
    if (out.finite && !(x >= 0 && x <= 1))
      outside_[static_cast<std::size_t>(q.channel)].add(out.at, x);
  }
  // A constant species is where the temperature is; where that is constant too, where a species is.
  const bool there = reading_.temperature.channel >= 0 ? out.has_temperature : any_species;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s)
    if (reading_.species[s].channel < 0 && !there) out.fraction[s] = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    const int q = reading_.species[s].channel;
    if (q < 0 || !there || holds(masks[channel_[static_cast<std::size_t>(q)]], offset)) continue;
    const float background = volume_.background[channel_[static_cast<std::size_t>(q)]];
    if (background != 0)
      background_[static_cast<std::size_t>(q)].add(out.at, static_cast<double>(background));
  }
  return out;
}

bool PlumeFieldMaker::has_gas(const Voxel& voxel) {
  const bool any =
      std::any_of(voxel.fraction.begin(), voxel.fraction.end(), [](double x) { return x > 0; });
  if (!any && voxel.has_temperature) ++field_->report_.warm_without_gas;
  return any;
}

void PlumeFieldMaker::check_gas(const Voxel& v) {
  if (!v.has_temperature) return without_temperature_.add(v.at, 0);
  if (!v.has_pressure) return without_pressure_.add(v.at, 0);
  const PlumeQuantity& t = reading_.temperature;
  most_raw_temperature_ = std::max(most_raw_temperature_, (v.temperature_k - t.offset) / t.scale);
  if (v.temperature_k < kLeastPlumeK) cold_.add(v.at, v.temperature_k);
  if (v.temperature_k > kMostPlumeK) hot_.add(v.at, v.temperature_k);
  if (!(v.pressure_pa >= kLeastPlumePa && v.pressure_pa <= kMostPlumePa))
    pressure_.add(v.at, v.pressure_pa);
  const double sum = v.fraction[0] + v.fraction[1] + v.fraction[2];
  if (sum > 1 + 1e-6) sum_.add(v.at, sum);
  PlumeReport& report = field_->report_;
  report.least_k =
      report.gas_voxels == 0 ? v.temperature_k : std::min(report.least_k, v.temperature_k);
  report.most_k = std::max(report.most_k, v.temperature_k);
  report.least_pa =
      report.gas_voxels == 0 ? v.pressure_pa : std::min(report.least_pa, v.pressure_pa);
  report.most_pa = std::max(report.most_pa, v.pressure_pa);
  report.most_soot = std::max(report.most_soot, v.fraction[kSoot]);
  ++report.gas_voxels;
}

// Returns the gas of a voxel as it is stored, and counts it for that many voxels.
StoredGas PlumeFieldMaker::store(const Voxel& v, std::uint64_t voxels) {
  const double all_mol_m3 = v.pressure_pa / (kGasConstantJMolK * v.temperature_k);
  std::array<double, kPlumeSpecies> amount{};
  double weight = 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    amount[s] = v.fraction[s] * (s == kSoot ? 1 : all_mol_m3);
    weight += amount[s] * (s == kSoot ? kSootMolPerM3 : 1);
    field_->report_.amount[s] += amount[s] * field_->voxel_volume_m3_ * static_cast<double>(voxels);
  }
  return {static_cast<float>(weight),        static_cast<float>(v.temperature_k),
          static_cast<float>(v.pressure_pa), static_cast<float>(amount[0]),
          static_cast<float>(amount[1]),     static_cast<float>(amount[2]),
          static_cast<float>(amount[3])};
}

void PlumeFieldMaker::take_block(std::size_t b, std::size_t& read) {
  const VoxelBlock& block = volume_.block[b];
  for (const std::int32_t at : block.origin)
    if (at < -kMostIndex || at > kMostIndex) far_.add(block.origin, at);
  const std::size_t in = volume_.channel.size();
  const VoxelMask* masks = volume_.mask.data() + b * in;
  const VoxelMask held = held_by_any(volume_, b);
  const bool uniform = block.form == Form::kUniform, dense = block.form == Form::kDense;
  const std::size_t stored = stored_voxels(block.form, held);
  std::vector<Voxel> voxels;
  std::vector<unsigned> offsets;
  PlumeField::ValueBlock values;
  std::size_t at = read;
  for (unsigned offset = 0; offset < (uniform ? 1U : 512U); ++offset) {
    const bool is_held = holds(held, offset);
    if (is_held) {
      const Voxel v = voxel_of(masks, offset, volume_.value.data() + at * in, block.origin);
      if (v.finite && has_gas(v)) {
        check_gas(v);
        voxels.push_back(v);
        offsets.push_back(offset);
        values.gas[offset >> 6] |= std::uint64_t{1} << (offset & 63);
      }
    }
    at += dense || uniform || is_held;
  }
  read += stored;
  if (voxels.empty()) return;
  values.form = uniform                         ? Form::kUniform
                : dense && voxels.size() >= 256 ? Form::kDense
                                                : Form::kPacked;
  if (uniform) {
    values.gas.fill(~0ULL);
    field_->report_.gas_voxels += 511;
  }
  unsigned before = 0;
  for (std::size_t w = 0; w < 8; ++w) {
    values.before[w] = static_cast<std::uint16_t>(before);
    before += static_cast<unsigned>(std::popcount(values.gas[w]));
  }
  std::vector<StoredGas>& stored_gas = field_->values_;
  values.first = stored_gas.size();
  stored_gas.resize(values.first + (values.form == Form::kDense ? 512 : voxels.size()));
  for (std::size_t v = 0; v < voxels.size(); ++v)
    stored_gas[values.first + (values.form == Form::kDense ? offsets[v] : v)] =
        store(voxels[v], uniform ? 512 : 1);
  origin_.push_back(block.origin);
  field_->value_blocks_.push_back(values);
}

absl::Status PlumeFieldMaker::faults() const {
  std::vector<std::string> wrong;
  const auto say = [&](const Fault& fault, const std::string& what, const std::string& of = "") {
    if (fault.count > 0)
      wrong.push_back(fmt::format("{} ({} voxel{}, the first at {}{})", what, fault.count,
                                  fault.count == 1 ? "" : "s", place(fault.first),
                                  of.empty() ? "" : ": " + of));
  };
  const auto grid = [&](const PlumeQuantity& q) {
    return q.channel < 0 ? std::string(q.name)
                         : fmt::format("grid \"{}\" ({})",
                                       reading_.grid[static_cast<std::size_t>(q.channel)], q.name);
  };
  for (std::size_t c = 0; c < channel_.size(); ++c)
    say(not_finite_[c], fmt::format("grid \"{}\": not finite", reading_.grid[c]),
        fmt::format("{}", not_finite_[c].value));
  say(far_, fmt::format("grid \"{}\": further than {} voxels from its origin", reading_.grid[0],
                        kMostIndex));
  const std::string t = grid(reading_.temperature), p = grid(reading_.pressure);
  if (cold_.count > 0 && most_raw_temperature_ <= 1) {
    wrong.push_back(fmt::format(
        "{}: the hottest gas has {:g}: this is a share of some temperature, expected K or degC", t,
        most_raw_temperature_));
  } else {
    say(cold_, fmt::format("{}: gas colder than {} K", t, kLeastPlumeK),
        fmt::format("{:g} K", cold_.value));
  }
  say(hot_, fmt::format("{}: gas hotter than {} K", t, kMostPlumeK),
      fmt::format("{:g} K", hot_.value));
  say(without_temperature_,
      fmt::format("{}: gas without a temperature, where the grid is not active", t));
  say(without_pressure_,
      fmt::format("{}: gas without a pressure, where the grid is not active", p));
  say(pressure_, fmt::format("{}: outside {:g} to {:g} Pa", p, kLeastPlumePa, kMostPlumePa),
      fmt::format("{:g} Pa", pressure_.value));
  for (const PlumeQuantity& q : reading_.species) {
    if (q.channel < 0) continue;
    const auto c = static_cast<std::size_t>(q.channel);
    say(outside_[c], grid(q) + ": outside 0 to 1", fmt::format("{:g}", outside_[c].value));
    say(background_[c],
        fmt::format("{}: not active where the gas is, and its background is {:g}, expected 0",
                    grid(q), background_[c].value));
  }
  say(sum_, "the mole fractions of CO2, H2O and CO add up to more than 1",
      fmt::format("{:g}", sum_.value));
  if (wrong.empty()) return absl::OkStatus();
  std::string text;
  for (const std::string& what : wrong) text += (text.empty() ? "" : "\n") + what;
  return refuse(text);
}

void PlumeFieldMaker::sort_values() {
  std::vector<std::size_t> order(origin_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return BlockTree::before(origin_[a], origin_[b]);
  });
  std::vector<Cell> origins;
  std::vector<PlumeField::ValueBlock> blocks;
  origins.reserve(order.size());
  blocks.reserve(order.size());
  for (const std::size_t i : order) {
    origins.push_back(origin_[i]);
    blocks.push_back(field_->value_blocks_[i]);
  }
  origin_ = std::move(origins);
  field_->value_blocks_ = std::move(blocks);
}

absl::StatusOr<std::shared_ptr<const PlumeField>> PlumeFieldMaker::make() {
  field_.reset(new PlumeField());
  RETURN_IF_ERROR(match_channels());
  RETURN_IF_ERROR(check_lattice());
  field_->interpolation_ = reading_.interpolation;
  std::size_t read = 0;
  for (std::size_t b = 0; b < volume_.block.size(); ++b) take_block(b, read);
  RETURN_IF_ERROR(faults());
  if (origin_.empty())
    return refuse(fmt::format("no gas: in the {} active voxels co2, h2o, co and soot are all 0",
                              field_->report_.warm_without_gas));
  field_->values_.shrink_to_fit();
  volume_ = {};
  sort_values();
  for (std::size_t b = 1; b < origin_.size(); ++b)
    if (origin_[b] == origin_[b - 1])
      return refuse(fmt::format("the block at {} is there twice", place(origin_[b])));
  build_cells();
  build_points();
  return std::shared_ptr<const PlumeField>(std::move(field_));
}

}  // namespace irsig

#include "core/atmosphere/absorber_amounts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/atmosphere/band_loops.h"
#include "core/atmosphere/gas_table.h"
#include "core/atmosphere/line_loops.h"
#include "core/base/check.h"
#include "core/base/work_counts.h"

namespace irsig {
namespace {

LineTerms lines_of(std::size_t gas) {
  constexpr std::size_t kLanes = GasTable::kLanes;
  const GasTable& table = gas_table();
  std::vector<std::uint32_t> entries;
  for (std::size_t e = kLanes * table.gas_begin[gas]; e < kLanes * table.gas_begin[gas + 1]; ++e) {
    if (table.entry[e].band < kAirBandCount) entries.push_back(static_cast<std::uint32_t>(e));
  }
  return line_terms(std::move(entries));
}

// Calls each(part, first, last): part(amounts) is an array of them of which the bands need
// [first, last).
template <typename Each>
void for_parts(const BandChoice& bands, const Each& each) {
  for (const std::uint16_t g : bands.line_groups()) {
    const std::size_t first = GasTable::kLanes * g, last = first + GasTable::kLanes;
    each([](auto& amounts) { return amounts.gas_scaled_kg_m2.data(); }, first, last);
    each([](auto& amounts) { return amounts.gas_plain_kg_m2.data(); }, first, last);
  }
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t g = 0; g < kGreyAbsorberCount; ++g) {
      each([g](auto& amounts) { return amounts.optical_depth[g].data(); }, r.first, r.last);
    }
  }
}

// The array has room for the table's entries of no band.
using Transmittances = std::array<double, kAirBandCount + 1>;

}  // namespace

double air_band_centre_cm1(std::size_t band) {
  return kAirFirstCm1 + (static_cast<double>(band) + 0.5) * kAirBandWidthCm1;
}

double air_band_lambda_um(std::size_t band) { return 1e4 / air_band_centre_cm1(band); }

absl::StatusOr<std::size_t> air_band(double lambda_um) {
  if (!(lambda_um >= 1e4 / kAirLastCm1 && lambda_um <= 1e4 / kAirFirstCm1)) {
    return absl::OutOfRangeError(absl::StrFormat("the air's table covers %.4g-%.4g um, not %g um",
                                                 1e4 / kAirLastCm1, 1e4 / kAirFirstCm1, lambda_um));
  }
  const double band = (1e4 / lambda_um - kAirFirstCm1) / kAirBandWidthCm1;
  return std::min(static_cast<std::size_t>(std::max(0.0, band)), kAirBandCount - 1);
}

AbsorberAmounts::AbsorberAmounts()
    : gas_scaled_kg_m2(gas_table().entry.size(), 0.0),
      gas_plain_kg_m2(gas_table().entry.size(), 0.0) {
  optical_depth.fill(AirSpectrum(kAirBandCount, 0.0));
}

AbsorberAmounts& AbsorberAmounts::operator+=(const AbsorberAmounts& other) {
  for (std::size_t i = 0; i < gas_plain_kg_m2.size(); ++i) {
    gas_scaled_kg_m2[i] += other.gas_scaled_kg_m2[i];
    gas_plain_kg_m2[i] += other.gas_plain_kg_m2[i];
  }
  for (std::size_t g = 0; g < kGreyAbsorberCount; ++g) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      optical_depth[g][b] += other.optical_depth[g][b];
    }
  }
  return *this;
}

AbsorberAmounts operator+(AbsorberAmounts a, const AbsorberAmounts& b) { return a += b; }

void set_sum(AbsorberAmounts& sum, const AbsorberAmounts& a, const AbsorberAmounts& b,
             const BandChoice& bands) {
  for_parts(bands, [&](auto part, std::size_t first, std::size_t last) {
    double* out = part(sum);
    const double *x = part(a), *y = part(b);
    for (std::size_t i = first; i < last; ++i) out[i] = x[i] + y[i];
  });
}

PackedAmounts::PackedAmounts(const AbsorberAmounts& amounts, const BandChoice& bands) {
  std::size_t count = 0;
  for_parts(bands, [&](auto, std::size_t first, std::size_t last) { count += last - first; });
  value_.reserve(count);
  for_parts(bands, [&](auto part, std::size_t first, std::size_t last) {
    value_.insert(value_.end(), part(amounts) + first, part(amounts) + last);
  });
}

AbsorberAmounts PackedAmounts::unpacked(const BandChoice& bands) const {
  AbsorberAmounts out;
  const double* next = value_.data();
  for_parts(bands, [&](auto part, std::size_t first, std::size_t last) {
    std::copy(next, next + (last - first), part(out) + first);
    next += last - first;
  });
  return out;
}

void set_sum(AbsorberAmounts& sum, const PackedAmounts& a, const AbsorberAmounts& b,
             const BandChoice& bands) {
  const double* next = a.value_.data();
  for_parts(bands, [&](auto part, std::size_t first, std::size_t last) {
    double* out = part(sum);
    const double* y = part(b);
    for (std::size_t i = first; i < last; ++i) out[i] = *next++ + y[i];
  });
}

void add_between(AbsorberAmounts& sum, const AbsorberAmounts& low, const AbsorberAmounts& high,
                 double fraction, const BandChoice& bands) {
  for_parts(bands, [&](auto part, std::size_t first, std::size_t last) {
    double* out = part(sum);
    const double *x = part(low), *y = part(high);
    for (std::size_t i = first; i < last; ++i) {
      out[i] += std::max(0.0, x[i] + fraction * (y[i] - x[i]));
    }
  });
}

BandChoice::Sets BandChoice::sets_of(std::vector<unsigned char> wanted) {
  IRSIG_CHECK(wanted.size() == kAirBandCount);
  Sets out;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (wanted[b] == 0) continue;
    if (out.ranges.empty() || out.ranges.back().last != b) out.ranges.push_back({b, b});
    ++out.ranges.back().last;
  }
  const GasTable& table = gas_table();
  std::vector<std::uint32_t> entries;
  for (std::size_t e = 0; e < table.entry.size(); ++e) {
    if (table.entry[e].band >= kAirBandCount || wanted[table.entry[e].band] == 0) continue;
    entries.push_back(static_cast<std::uint32_t>(e));
    const auto group = static_cast<std::uint16_t>(e / GasTable::kLanes);
    if (out.line_groups.empty() || out.line_groups.back() != group) {
      out.line_groups.push_back(group);
    }
  }
  out.line_terms = std::make_shared<const LineTerms>(irsig::line_terms(std::move(entries)));
  out.wanted = std::move(wanted);
  return out;
}

void pack(std::vector<double>& to, const AirSpectrum& of, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges())
    to.insert(to.end(), of.data() + r.first, of.data() + r.last);
}
const double* unpack(AirSpectrum& to, const double* from, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges()) {
    std::copy(from, from + r.size(), to.data() + r.first);
    from += r.size();
  }
  return from;
}

BandChoice::BandChoice() {
  static const auto all =
      std::make_shared<const Sets>(sets_of(std::vector<unsigned char>(kAirBandCount, 1)));
  sets_ = all;
}

BandChoice::BandChoice(const std::vector<unsigned char>& wanted)
    : sets_(std::make_shared<const Sets>(sets_of(wanted))) {}

AirSpectrum transmittance(const AbsorberAmounts& amounts) {
  return transmittance(amounts, BandChoice());
}

AirSpectrum transmittance(const AbsorberAmounts& amounts, const BandChoice& bands) {
  IRSIG_CHECK(amounts.gas_plain_kg_m2.size() == gas_table().entry.size());
  Transmittances t{};
  for (const BandChoice::Range& r : bands.ranges()) {
    std::array<const double*, kGreyAbsorberCount> depth{};
    for (std::size_t g = 0; g < depth.size(); ++g) depth[g] = &amounts.optical_depth[g][r.first];
    grey_transmittance(r.size(), depth, &t[r.first]);
  }
  count_work(Work::kLineTerms, bands.line_terms().weight.size());
  multiply_lines(bands.line_terms(), amounts.gas_scaled_kg_m2.data(),
                 amounts.gas_plain_kg_m2.data(), t.data());
  return AirSpectrum(t.begin(), t.end() - 1);
}

AirSpectrum transmittance(const AbsorberAmounts& amounts, Gas gas) {
  Transmittances t;
  t.fill(1.0);
  multiply_lines(lines_of(static_cast<std::size_t>(gas)), amounts.gas_scaled_kg_m2.data(),
                 amounts.gas_plain_kg_m2.data(), t.data());
  return AirSpectrum(t.begin(), t.end() - 1);
}

AirSpectrum scattering_optical_depth(const AbsorberAmounts& amounts) {
  AirSpectrum sum = amounts.grey(GreyAbsorber::kAerosolScattering);
  const AirSpectrum& molecular = amounts.grey(GreyAbsorber::kMolecularScattering);
  for (std::size_t b = 0; b < kAirBandCount; ++b) sum[b] += molecular[b];
  return sum;
}

}  // namespace irsig

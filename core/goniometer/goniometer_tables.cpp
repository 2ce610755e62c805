#include "core/goniometer/goniometer_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "fmt/format.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSameAngleDeg = 1e-6;

std::string comments(const std::vector<std::string>& provenance) {
  std::string out;
  for (const std::string& line : provenance) out += "# " + line + "\n";
  return out;
}

std::optional<std::size_t> index_of(const std::vector<double>& list, double angle_deg) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (std::abs(list[i] - angle_deg) < kSameAngleDeg) return i;
  return std::nullopt;
}

// 360 is 0, and 270 is 90 on the other side.
double folded(double azimuth_deg) { return std::abs(std::remainder(azimuth_deg, 360.0)); }

// Relative differences of pairs that should be equal.
struct Pairs {
  double squares = 0, noise = 0;
  std::size_t count = 0;
  void add(const Estimate& a, const Estimate& b) {
    const double mean = 0.5 * (a.value + b.value);
    if (!(mean > 0)) return;
    squares += (a.value - b.value) * (a.value - b.value) / (mean * mean);
    noise += (a.stderr_ * a.stderr_ + b.stderr_ * b.stderr_) / (mean * mean);
    ++count;
  }
  [[nodiscard]] double rms() const {
    return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
  }
  [[nodiscard]] double expected() const {
    return count == 0 ? 0 : std::sqrt(noise / static_cast<double>(count));
  }
};

}  // namespace

GoniometerChecks check_result(const GoniometerResult& r) {
  GoniometerChecks out;
  for (const Estimate& e : r.emissivity_plus_dhr) {
    const double off = std::abs(e.value - 1);
    out.largest_closure = std::max(out.largest_closure, off);
    if (e.stderr_ > 0) out.largest_closure_t = std::max(out.largest_closure_t, off / e.stderr_);
  }
  Pairs mirror, reciprocal;
  const GoniometerSpec& s = r.spec;
  for (std::size_t ch = 0; ch < r.channel.size(); ++ch)
    for (std::size_t j = 0; j < s.source_zenith_deg.size(); ++j)
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z) {
        if (s.view_zenith_deg[z] == 0) continue;
        const auto source_of_view = index_of(s.source_zenith_deg, s.view_zenith_deg[z]);
        const auto view_of_source = index_of(s.view_zenith_deg, s.source_zenith_deg[j]);
        for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a) {
          const double azimuth_deg = s.view_azimuth_deg[a];
          const auto other = index_of(s.view_azimuth_deg, 360 - azimuth_deg);
          if (other && *other > a && azimuth_deg > 0)
            mirror.add(r.brdf(ch, j, z, a), r.brdf(ch, j, z, *other));
          if (source_of_view && view_of_source && *source_of_view < j)
            reciprocal.add(r.brdf(ch, j, z, a), r.brdf(ch, *source_of_view, *view_of_source, a));
        }
      }
  out.mirror_rms = mirror.rms();
  out.mirror_noise = mirror.expected();
  out.mirror_pairs = mirror.count;
  out.reciprocity_rms = reciprocal.rms();
  out.reciprocity_noise = reciprocal.expected();
  out.reciprocity_pairs = reciprocal.count;
  return out;
}

std::string brdf_csv(const GoniometerResult& r, const std::vector<std::string>& provenance) {
  std::string out = comments(provenance);
  out +=
      "band,lambda_um,source_zenith_deg,view_zenith_deg,view_azimuth_deg,brdf_per_sr,"
      "brdf_stderr_per_sr,reflectance_factor,reflectance_factor_stderr\n";
  const GoniometerSpec& s = r.spec;
  for (std::size_t ch = 0; ch < r.channel.size(); ++ch)
    for (std::size_t j = 0; j < s.source_zenith_deg.size(); ++j)
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z)
        for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a) {
          const Estimate& e = r.brdf(ch, j, z, a);
          fmt::format_to(std::back_inserter(out),
                         "{},{:.6g},{:g},{:g},{:g},{:.7g},{:.3g},{:.7g},{:.3g}\n",
                         r.channel[ch].band, r.channel[ch].lambda_um, s.source_zenith_deg[j],
                         s.view_zenith_deg[z], s.view_azimuth_deg[a], e.value, e.stderr_,
                         kPi * e.value, kPi * e.stderr_);
        }
  return out;
}

std::string emissivity_csv(const GoniometerResult& r, const std::vector<std::string>& provenance) {
  std::string out = comments(provenance);
  out +=
      "band,lambda_um,view_zenith_deg,view_azimuth_deg,directional_emissivity,"
      "directional_emissivity_stderr,one_minus_dhr,dhr_stderr,emissivity_plus_dhr,"
      "emissivity_plus_dhr_stderr\n";
  const GoniometerSpec& s = r.spec;
  for (std::size_t ch = 0; ch < r.channel.size(); ++ch)
    for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z)
      for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a) {
        const std::size_t at = ch * r.views() + r.view(z, a);
        fmt::format_to(std::back_inserter(out),
                       "{},{:.6g},{:g},{:g},{:.7g},{:.3g},{:.7g},{:.3g},{:.9g},{:.3g}\n",
                       r.channel[ch].band, r.channel[ch].lambda_um, s.view_zenith_deg[z],
                       s.view_azimuth_deg[a], r.emissivity[at].value, r.emissivity[at].stderr_,
                       1 - r.dhr[at].value, r.dhr[at].stderr_, r.emissivity_plus_dhr[at].value,
                       r.emissivity_plus_dhr[at].stderr_);
      }
  return out;
}

absl::StatusOr<std::string> material_csv(const GoniometerResult& r,
                                         const std::vector<std::string>& provenance) {
  const GoniometerSpec& s = r.spec;
  std::vector<std::size_t> order(r.channel.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return r.channel[a].lambda_um < r.channel[b].lambda_um;
  });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (!(r.channel[order[i]].lambda_um > r.channel[order[i - 1]].lambda_um + 1e-9))
      return absl::InvalidArgumentError(fmt::format(
          "two bands share the wavelength {} um, expected bands that do not overlap: a tabulated "
          "material has one BRDF at each wavelength",
          r.channel[order[i]].lambda_um));
  // 0 and 180 are reached from both sides: a grid that lacks them would not be a full one.
  std::set<double> azimuths;
  for (const double a : s.view_azimuth_deg) azimuths.insert(folded(a));
  if (!azimuths.contains(0) || !azimuths.contains(180))
    return absl::InvalidArgumentError(
        "view azimuths without 0 or 180 deg, expected both: a tabulated material covers 0 to 180");

  std::string out = comments(provenance);
  out += "lambda_um,theta_i_deg,theta_r_deg,phi_deg,brdf_per_sr\n";
  const auto mean_at = [&](std::size_t ch, std::size_t j, std::size_t z, double azimuth_deg) {
    double sum = 0;
    int count = 0;
    for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a)
      if (std::abs(folded(s.view_azimuth_deg[a]) - azimuth_deg) < kSameAngleDeg) {
        sum += r.brdf(ch, j, z, a).value;
        ++count;
      }
    return sum / count;
  };
  for (const std::size_t ch : order)
    for (std::size_t j = 0; j < s.source_zenith_deg.size(); ++j)
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z)
        for (const double azimuth_deg : azimuths) {
          double value = mean_at(ch, j, z, azimuth_deg);
          const auto source = index_of(s.source_zenith_deg, s.view_zenith_deg[z]);
          const auto view = index_of(s.view_zenith_deg, s.source_zenith_deg[j]);
          if (source && view) value = 0.5 * (value + mean_at(ch, *source, *view, azimuth_deg));
          fmt::format_to(std::back_inserter(out), "{:.9g},{:g},{:g},{:g},{:.7g}\n",
                         r.channel[ch].lambda_um, s.source_zenith_deg[j], s.view_zenith_deg[z],
                         azimuth_deg, value);
        }
  return out;
}

std::string summary_text(const GoniometerResult& r) {
  const GoniometerSpec& s = r.spec;
  const GoniometerChecks checks = check_result(r);
  std::string out;
  const auto line = [&](const std::string& text) { out += text + "\n"; };
  line(fmt::format("{} views x {} sources x {} channels, {} rays, {} replicates of {} samples",
                   r.views(), s.source_zenith_deg.size(), r.channel.size(), r.rays, s.replicates,
                   s.samples_per_replicate));
  line("reflectance factor (pi x BRDF) in the source's plane: zenith below 0 on the source's side");
  for (std::size_t j = 0; j < s.source_zenith_deg.size(); ++j) {
    const auto back = index_of(s.view_azimuth_deg, 0), forward = index_of(s.view_azimuth_deg, 180);
    if (!back || !forward) break;
    std::string header = fmt::format("  source {:g} deg", s.source_zenith_deg[j]);
    header.resize(std::max<std::size_t>(header.size(), 24), ' ');
    for (std::size_t z = s.view_zenith_deg.size(); z-- > 0;)
      if (s.view_zenith_deg[z] > 0) header += fmt::format("{:>9g}", -s.view_zenith_deg[z]);
    for (const double z : s.view_zenith_deg) header += fmt::format("{:>9g}", z);
    line(header);
    for (std::size_t ch = 0; ch < r.channel.size(); ++ch) {
      std::string row =
          fmt::format("    {} {:.4g} um", r.channel[ch].band, r.channel[ch].lambda_um);
      row.resize(std::max<std::size_t>(row.size(), 24), ' ');
      for (std::size_t z = s.view_zenith_deg.size(); z-- > 0;)
        if (s.view_zenith_deg[z] > 0)
          row += fmt::format("{:>9.4f}", kPi * r.brdf(ch, j, z, *back).value);
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z)
        row += fmt::format("{:>9.4f}", kPi * r.brdf(ch, j, z, *forward).value);
      line(row);
    }
  }
  line("directional emissivity (mean over azimuth), by emission | 1 - DHR");
  for (std::size_t ch = 0; ch < r.channel.size(); ++ch)
    for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z) {
      double e = 0, d = 0;
      for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a) {
        e += r.emissivity[ch * r.views() + r.view(z, a)].value;
        d += r.dhr[ch * r.views() + r.view(z, a)].value;
      }
      const auto n = static_cast<double>(s.view_azimuth_deg.size());
      line(fmt::format("    {} {:.4g} um, zenith {:g}: {:.5f} | {:.5f}", r.channel[ch].band,
                       r.channel[ch].lambda_um, s.view_zenith_deg[z], e / n, 1 - d / n));
    }
  double relative = 0;
  for (const Estimate& e : r.brdf_per_sr)
    if (e.value > 0) relative = std::max(relative, e.stderr_ / e.value);
  line("checks");
  line(fmt::format("    largest relative standard error of a BRDF      {:.3g}", relative));
  line(fmt::format(
      "    |emissivity + DHR - 1|, largest                {:.2g} ({:.1f} standard errors)",
      checks.largest_closure, checks.largest_closure_t));
  line(fmt::format("    radiance after exactly {} reflections, the most  {:.2g} at most",
                   s.max_reflections, r.last_reflection));
  line(fmt::format("    reflected light lost past the plate's border   {:.2g} at most", r.leaked));
  line(fmt::format("    field of view that meets nothing               {:.2g} at most",
                   r.missed_field));
  line(
      fmt::format("    border beyond the field of view                {:.4g} m, {} {:.4g} m for "
                  "shadows and grains at the largest zenith",
                  r.border_m, r.border_m < r.wanted_border_m ? "LESS than the" : "more than the",
                  r.wanted_border_m));
  if (checks.mirror_pairs > 0)
    line(fmt::format(
        "    azimuth against -azimuth, rms                  {:.2g} (noise alone {:.2g})",
        checks.mirror_rms, checks.mirror_noise));
  if (checks.reciprocity_pairs > 0)
    line(fmt::format(
        "    f(in, out) against f(out, in), rms             {:.2g} (noise alone {:.2g})",
        checks.reciprocity_rms, checks.reciprocity_noise));
  line(fmt::format("    back faces met and numbers not finite          {}", r.guarded));
  if (r.creates_energy)
    line("    A MATERIAL CREATES ENERGY: emissivities and BRDFs are not physical");
  return out;
}

}  // namespace irsig

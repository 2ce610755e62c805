#include "core/gas/lines/water_levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/gas/lines/lowest_eigenstates.h"
#include "core/gas/lines/water_surface.h"

namespace irsig {
namespace {

constexpr double kHydrogenU = 1.00727646688, kDeuteriumU = 2.01355321,
                 kOxygenU = 15.990526;           // nuclei
constexpr double kHalfSquareCm1U = 16.85762920;  // hbar^2 / 2 over 1 u angstrom^2 [cm-1]
constexpr double kDebyePerEA = 4.80320471;       // e angstrom

// c[i][j] += sum over k of a[i][k] b[k][j]
void add_product(std::size_t n, std::size_t m, std::size_t inner, const double* a, const double* b,
                 double* c) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k0 = 0; k0 < inner; k0 += 4) {
      if (k0 + 4 <= inner) {
        const double *b0 = b + k0 * m, *b1 = b0 + m, *b2 = b1 + m, *b3 = b2 + m;
        const double x0 = a[i * inner + k0], x1 = a[i * inner + k0 + 1], x2 = a[i * inner + k0 + 2],
                     x3 = a[i * inner + k0 + 3];
        double* row = c + i * m;
        for (std::size_t j = 0; j < m; ++j)
          row[j] += x0 * b0[j] + x1 * b1[j] + x2 * b2[j] + x3 * b3[j];
      } else {
        for (std::size_t k = k0; k < inner; ++k)
          for (std::size_t j = 0; j < m; ++j) c[i * m + j] += a[i * inner + k] * b[k * m + j];
      }
    }
}

std::vector<double> transposed(const std::vector<double>& a, std::size_t rows,
                               std::size_t columns) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) out[j * rows + i] = a[i * columns + j];
  return out;
}

// The molecule's nuclei, and how bonds follow from Radau's vectors: bond i = r_i + a r1 + b r2.
struct Nuclei {
  double mass1, mass2, a, b;
};
Nuclei nuclei(WaterKind kind) {
  const double m1 = kHydrogenU, m2 = kind == WaterKind::kH2o ? kHydrogenU : kDeuteriumU;
  const double root = std::sqrt(kOxygenU / (kOxygenU + m1 + m2));
  const double c = (1 - root) / root / (m1 + m2);
  return {m1, m2, c * m1, c * m2};
}

WaterShape shape_of(const Nuclei& of, double r1, double r2, double angle) {
  const double cosine = std::cos(angle);
  const auto dot = [&](double a1, double a2, double b1, double b2) {
    return a1 * b1 * r1 * r1 + a2 * b2 * r2 * r2 + (a1 * b2 + a2 * b1) * r1 * r2 * cosine;
  };
  const double d1 = std::sqrt(dot(1 + of.a, of.b, 1 + of.a, of.b)),
               d2 = std::sqrt(dot(of.a, 1 + of.b, of.a, 1 + of.b));
  return {d1, d2, dot(1 + of.a, of.b, of.a, 1 + of.b) / (d1 * d2)};
}

// Sines in a box, on their points.
struct Box {
  std::vector<double> point;
  std::vector<double> second;  // -d^2, [i * n + j]
  std::vector<double> slope;   // d, antisymmetric
};
Box box(double from, double to, std::size_t n) {
  Box out;
  const double length = to - from, count = static_cast<double>(n + 1);
  std::vector<double> u(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    out.point.push_back(from + length * static_cast<double>(i + 1) / count);
    for (std::size_t m = 0; m < n; ++m)
      u[i * n + m] = std::sqrt(2 / count) *
                     std::sin(std::numbers::pi * static_cast<double>((i + 1) * (m + 1)) / count);
  }
  out.second.assign(n * n, 0);
  out.slope.assign(n * n, 0);
  // d of the sines: <m| d |k> = (2 / L) m k' integral sin cos = 4 m k / (L (m^2 - k^2)), m + k odd.
  std::vector<double> d(n * n), half(n * n, 0.0);
  for (std::size_t m = 1; m <= n; ++m)
    for (std::size_t k = 1; k <= n; ++k)
      if ((m + k) % 2 == 1) {
        const auto a = static_cast<double>(m), b = static_cast<double>(k);
        d[(m - 1) * n + k - 1] = 4 * a * b / (length * (a * a - b * b));
      }
  add_product(n, n, n, u.data(), d.data(), half.data());
  add_product(n, n, n, half.data(), u.data(), out.slope.data());  // u is its own transpose
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t m = 0; m < n; ++m) {
        const double k = std::numbers::pi * static_cast<double>(m + 1) / length;
        out.second[i * n + j] += u[i * n + m] * k * k * u[j * n + m];
      }
  return out;
}

// Points fitted to the states of one stretch, and its kinetic energy there.
struct Stretch {
  std::vector<double> point, kinetic;
};
constexpr double kMeanAngle = 1.835;
Stretch stretch(double mass, std::size_t n) {
  const double inverse_mass = kHalfSquareCm1U / mass;
  const Nuclei water = nuclei(WaterKind::kH2o);
  const Box fine = box(0.55, 2.4, 120);
  const std::size_t m = fine.point.size();
  std::vector<double> h(m * m);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) {
      h[i * m + j] = inverse_mass * fine.second[i * m + j];
      if (i == j)
        h[i * m + j] +=
            std::min(1e5, water_potential_cm1(shape_of(water, fine.point[i], 0.95, kMeanAngle)));
    }
  const LowestEigenstates states = lowest_eigenstates(h, m, 1e9);
  std::vector<double> r(n * n);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t i = 0; i < m; ++i)
        r[a * n + b] += states.vector[a * m + i] * fine.point[i] * states.vector[b * m + i];
  const LowestEigenstates at = lowest_eigenstates(r, n, 1e9);
  // Kinetic energy among the states, then on the points.
  std::vector<double> t(n * n), half(n * n);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      double sum = 0;
      for (std::size_t i = 0; i < m; ++i)
        for (std::size_t j = 0; j < m; ++j)
          sum += states.vector[a * m + i] * inverse_mass * fine.second[i * m + j] *
                 states.vector[b * m + j];
      t[a * n + b] = sum;
    }
  add_product(n, n, n, at.vector.data(), t.data(), half.data());
  Stretch out{at.value, std::vector<double>(n * n, 0.0)};
  add_product(n, n, n, half.data(), transposed(at.vector, n, n).data(), out.kinetic.data());
  return out;
}

constexpr std::size_t kStretchPoints = 15, kAnglePoints = 36;
constexpr double kLeastAngle = 0.75, kMostPotential = 42000, kMostOfAngle = 28000;

// The grid of pairs of stretches and angles. Of H2O pairs with i <= j stand for both orders, and
// those with i = j are empty where s = 1.
struct Grid {
  bool symmetric;
  Nuclei of;
  Stretch r1, r2;
  Box angle;
  struct Pair {
    std::size_t i, j;
  };
  std::vector<Pair> pair;
  std::vector<double> potential, g;  // [angle * pairs + pair]; [pair]
  [[nodiscard]] std::size_t pairs() const { return pair.size(); }
  [[nodiscard]] std::size_t size() const { return pair.size() * angle.point.size(); }
  // 1 / (2 m r^2) of both.
  [[nodiscard]] std::array<double, 2> spin(const Pair& at) const {
    const double a = r1.point[at.i], b = r2.point[at.j];
    return {kHalfSquareCm1U / (of.mass1 * a * a), kHalfSquareCm1U / (of.mass2 * b * b)};
  }
};

Grid grid(WaterKind kind) {
  const Nuclei of = nuclei(kind);
  Grid out{kind == WaterKind::kH2o,
           of,
           stretch(of.mass1, kStretchPoints),
           stretch(of.mass2, kStretchPoints),
           box(kLeastAngle, std::numbers::pi, kAnglePoints),
           {},
           {},
           {}};
  for (std::size_t i = 0; i < kStretchPoints; ++i)
    for (std::size_t j = out.symmetric ? i : 0; j < kStretchPoints; ++j) {
      out.pair.push_back({i, j});
      const auto [a, b] = out.spin({i, j});
      out.g.push_back(a + b);
    }
  for (const double t : out.angle.point)
    for (const auto& [i, j] : out.pair)
      out.potential.push_back(std::min(
          kMostPotential, water_potential_cm1(shape_of(of, out.r1.point[i], out.r2.point[j], t))));
  return out;
}

// The two stretches at each angle, s of both.
struct AtAngle {
  std::vector<double> energy, vector;  // [state * pairs + pair]
};
std::vector<AtAngle> at_angles(const Grid& on, std::size_t s) {
  const std::size_t n = on.pairs();
  std::vector<AtAngle> out;
  for (std::size_t t = 0; t < kAnglePoints; ++t) {
    std::vector<std::size_t> use;
    for (std::size_t q = 0; q < n; ++q)
      if (s == 0 || on.pair[q].i != on.pair[q].j) use.push_back(q);
    std::vector<double> h(use.size() * use.size());
    const auto plain = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
      return (j == l ? on.r1.kinetic[i * kStretchPoints + k] : 0.0) +
             (i == k ? on.r2.kinetic[j * kStretchPoints + l] : 0.0);
    };
    const double sign = s == 0 ? 1 : -1;
    for (std::size_t x = 0; x < use.size(); ++x)
      for (std::size_t y = 0; y < use.size(); ++y) {
        const auto [i, j] = on.pair[use[x]];
        const auto [k, l] = on.pair[use[y]];
        double e = plain(i, j, k, l);
        if (on.symmetric) {  // |i j> + sign |j i> over sqrt 2, or |i i>
          const double norm =
              (i == j ? std::numbers::sqrt2 / 2 : 1.0) * (k == l ? std::numbers::sqrt2 / 2 : 1.0);
          e = norm * (e + sign * plain(i, j, l, k));
        }
        if (x == y) e += on.potential[t * n + use[x]];
        h[x * use.size() + y] = e;
      }
    const LowestEigenstates found = lowest_eigenstates(h, use.size(), kMostOfAngle);
    AtAngle& one = out.emplace_back();
    one.energy = found.value;
    one.vector.assign(found.value.size() * n, 0.0);
    for (std::size_t v = 0; v < found.value.size(); ++v)
      for (std::size_t x = 0; x < use.size(); ++x)
        one.vector[v * n + use[x]] = found.vector[v * use.size() + x];
  }
  return out;
}

// States on the grid, [state * grid size + angle * pairs + pair].
struct OnGrid {
  std::vector<double> energy, vector;
};
OnGrid vibrations(const Grid& on, const std::vector<AtAngle>& at, std::size_t k, double at_most) {
  const std::size_t n = on.pairs(), angles = kAnglePoints;
  std::vector<std::size_t> first{0};
  for (const AtAngle& one : at) first.push_back(first.back() + one.energy.size());
  const std::size_t size = first.back();
  std::vector<double> h(size * size, 0.0);
  const auto kk = static_cast<double>(k);
  for (std::size_t t = 0; t < angles; ++t) {
    const double angle = on.angle.point[t], sine = std::sin(angle), cos_half = std::cos(angle / 2),
                 sin_half = std::sin(angle / 2);
    // (a + b) / 2 K + g K^2 / (4 cos^2) and the rest of the bend's kinetic energy, over g.
    const double extra = 0.125 * (1 + 1 / (sin_half * sin_half)) * kk +
                         0.25 * kk * kk / (cos_half * cos_half) - 0.25 * (1 + 1 / (sine * sine));
    for (std::size_t u = 0; u <= t; ++u) {
      const double bend = on.angle.second[t * angles + u] + (t == u ? extra : 0);
      for (std::size_t a = 0; a < at[t].energy.size(); ++a) {
        std::vector<double> scaled(n);
        for (std::size_t q = 0; q < n; ++q) scaled[q] = at[t].vector[a * n + q] * on.g[q];
        for (std::size_t b = 0; b < at[u].energy.size(); ++b) {
          double sum = 0;
          const double* other = &at[u].vector[b * n];
          for (std::size_t q = 0; q < n; ++q) sum += scaled[q] * other[q];
          double e = bend * sum;
          if (t == u && a == b) e += at[t].energy[a];
          h[(first[t] + a) * size + first[u] + b] = h[(first[u] + b) * size + first[t] + a] = e;
        }
      }
    }
  }
  const LowestEigenstates found = lowest_eigenstates(h, size, at_most);
  OnGrid out{found.value, std::vector<double>(found.value.size() * on.size(), 0.0)};
  for (std::size_t v = 0; v < found.value.size(); ++v)
    for (std::size_t t = 0; t < angles; ++t)
      for (std::size_t a = 0; a < at[t].energy.size(); ++a) {
        const double c = found.vector[v * size + first[t] + a];
        for (std::size_t q = 0; q < n; ++q)
          out.vector[v * on.size() + t * n + q] += c * at[t].vector[a * n + q];
      }
  return out;
}

// <row| f |column>, f given on the grid.
std::vector<double> between(const Grid& on, const OnGrid& row, const OnGrid& column,
                            const std::vector<double>& f) {
  const std::size_t n = row.energy.size(), m = column.energy.size(), size = on.size();
  std::vector<double> scaled(m * size), out(n * m, 0.0);
  for (std::size_t b = 0; b < m; ++b)
    for (std::size_t q = 0; q < size; ++q)
      scaled[b * size + q] = f[q] * column.vector[b * size + q];
  const std::vector<double> other = transposed(scaled, m, size);
  add_product(n, m, size, row.vector.data(), other.data(), out.data());
  return out;
}

OnGrid sloped(const Grid& on, const OnGrid& of) {
  OnGrid out{of.energy, std::vector<double>(of.vector.size(), 0.0)};
  const std::size_t n = on.pairs(), angles = kAnglePoints;
  for (std::size_t v = 0; v < of.energy.size(); ++v)
    add_product(angles, n, angles, on.angle.slope.data(), &of.vector[v * on.size()],
                &out.vector[v * on.size()]);
  return out;
}

struct Operators {
  std::vector<double> along, twist, f, by_sine, dipole_x, dipole_z;
};
Operators operators(const Grid& on) {
  Operators out;
  for (const double t : on.angle.point) {
    const double sin_half = std::sin(t / 2), cos_half = std::cos(t / 2);
    for (std::size_t q = 0; q < on.pairs(); ++q) {
      const auto [i, j] = on.pair[q];
      const double r1 = on.r1.point[i], r2 = on.r2.point[j];
      const double a = on.g[q] / (4 * sin_half * sin_half), b = on.g[q] / 4;
      out.along.push_back((a + b) / 2);
      out.twist.push_back((a - b) / 4);
      const auto [first, second] = on.spin({i, j});
      const double f = first - second;
      out.f.push_back(-0.5 * f);
      out.by_sine.push_back(-0.25 * f / std::sin(t));
      // In x and z, r1 = r1 (cos, sin) and r2 = r2 (cos, -sin) of half the angle.
      const WaterCharges charge = water_charges(shape_of(on.of, r1, r2, t));
      const double total = charge.first + charge.second;
      const double along1 = (charge.first + on.of.a * total) * r1,
                   along2 = (charge.second + on.of.b * total) * r2;
      out.dipole_x.push_back(kDebyePerEA * cos_half * (along1 + along2));
      out.dipole_z.push_back(kDebyePerEA * sin_half * (along1 - along2));
    }
  }
  return out;
}

}  // namespace

WaterBasis::WaterBasis(const WaterBasisOptions& options) : options_(options) {
  const Grid on = grid(options.kind);
  const Operators of = operators(on);
  std::vector<std::vector<AtAngle>> at;
  for (std::size_t s = 0; s < symmetries(); ++s) at.push_back(at_angles(on, s));
  zero_cm1_ = vibrations(on, at[0], 0, 8000).energy.at(0);
  states_.resize(2 * (options.most_j + 1));
  // States of K, K + 1 and K + 2 are held at a time.
  const auto make = [&](std::size_t k) {
    std::array<OnGrid, 2> out;
    if (k > options.most_j) return out;
    for (std::size_t s = 0; s < symmetries(); ++s)
      out[s] = vibrations(on, at[s], k, zero_cm1_ + options.highest_cm1);
    return out;
  };
  std::array<std::array<OnGrid, 2>, 3> held = {make(0), make(1), make(2)};
  for (std::size_t k = 0; k <= options.most_j; ++k) {
    for (std::size_t s = 0; s < symmetries(); ++s) {
      States& out = states_[2 * k + s];
      const OnGrid& here = held[0][s];
      for (const double e : here.energy) out.energy_cm1.push_back(e - zero_cm1_);
      out.along = between(on, here, here, of.along);
      out.twist = between(on, held[2][s], here, of.twist);
      if (k == 1) out.twist_one = between(on, here, here, of.twist);
      out.coupling = between(on, held[1][other(s)], sloped(on, here), of.f);
      const std::vector<double> rest = between(on, held[1][other(s)], here, of.by_sine);
      for (std::size_t i = 0; i < rest.size(); ++i)
        out.coupling[i] += static_cast<double>(2 * k + 1) * rest[i];
      out.dipole_z = between(on, held[0][other(s)], here, of.dipole_z);
      out.dipole_x = between(on, held[1][s], here, of.dipole_x);
    }
    held[0] = std::move(held[1]);
    held[1] = std::move(held[2]);
    held[2] = make(k + 3);
  }
}

WaterLevels water_levels(const WaterBasis& basis, std::size_t j, std::size_t p, std::size_t s,
                         double highest_cm1) {
  WaterLevels out;
  out.j = j, out.p = p, out.s = s;
  // Even under exchange: s + J + K + p, with the vibrations' own symmetry.
  out.nuclear_weight = basis.symmetries() == 1 || (s + j + p) % 2 == 0 ? 1 : 3;
  const auto jj = static_cast<double>(j * (j + 1));
  std::vector<std::size_t> used;
  out.first.push_back(0);
  const auto symmetry = [&](std::size_t k) { return k % 2 == 0 ? s : basis.other(s); };
  for (std::size_t k = 0; k <= j; ++k) {
    const WaterBasis::States& states = basis.states(k, symmetry(k));
    const std::size_t count = states.energy_cm1.size();
    std::size_t n = 0;
    const double spin = jj - static_cast<double>(k * (k + 1));
    if (k > 0 || p == 0)
      while (n < count && states.energy_cm1[n] + spin * states.along[n * count + n] <
                              basis.options().highest_cm1)
        ++n;
    out.first.push_back(out.first.back() + n);
    used.push_back(n);
  }
  const std::size_t size = out.size();
  std::vector<double> h(size * size, 0.0);
  const auto put = [&](std::size_t k1, std::size_t k2, const std::vector<double>& of,
                       std::size_t stride, double factor) {
    for (std::size_t a = 0; a < used[k1]; ++a)
      for (std::size_t b = 0; b < used[k2]; ++b) {
        const double e = factor * of[a * stride + b];
        h[(out.first[k1] + a) * size + out.first[k2] + b] += e;
        if (k1 != k2) h[(out.first[k2] + b) * size + out.first[k1] + a] += e;
      }
  };
  const auto up = [&](std::size_t k) { return std::sqrt(jj - static_cast<double>(k * (k + 1))); };
  for (std::size_t k = 0; k <= j; ++k) {
    const WaterBasis::States& states = basis.states(k, symmetry(k));
    const std::size_t count = states.energy_cm1.size();
    for (std::size_t a = 0; a < used[k]; ++a)
      h[(out.first[k] + a) * (size + 1)] += states.energy_cm1[a];
    put(k, k, states.along, count, jj - static_cast<double>(k * (k + 1)));
    if (k == 1) put(1, 1, states.twist_one, count, p == 1 ? jj : -jj);
    const double from_zero = k == 0 ? std::numbers::sqrt2 : 1;
    if (k + 1 <= j) put(k + 1, k, states.coupling, count, from_zero * up(k));
    if (k + 2 <= j) put(k + 2, k, states.twist, count, from_zero * up(k) * up(k + 1));
  }
  LowestEigenstates found = lowest_eigenstates(h, size, highest_cm1);
  out.energy_cm1 = std::move(found.value);
  out.vector = std::move(found.vector);
  return out;
}

std::vector<double> water_moments(const WaterBasis& basis, const WaterLevels& from,
                                  const WaterLevels& to) {
  const bool same = to.j == from.j && to.p != from.p, next = to.j == from.j + 1 && to.p == from.p;
  if ((!same && !next) || to.s != basis.other(from.s)) return {};
  const auto jj = static_cast<double>(from.j);
  // Clebsch-Gordan coefficient of J K, 1 q, J' K + q.
  const auto coefficient = [&](std::size_t k, int q) {
    const auto kk = static_cast<double>(k);
    if (same) {
      if (jj == 0) return 0.0;
      const double under = 2 * jj * (jj + 1);
      if (q == 0) return kk / std::sqrt(jj * (jj + 1));
      return q > 0 ? -std::sqrt((jj - kk) * (jj + kk + 1) / under)
                   : std::sqrt((jj + kk) * (jj - kk + 1) / under);
    }
    if (q == 0) return std::sqrt((jj - kk + 1) * (jj + kk + 1) / ((2 * jj + 1) * (jj + 1)));
    const double under = (2 * jj + 1) * (2 * jj + 2);
    return q > 0 ? std::sqrt((jj + kk + 1) * (jj + kk + 2) / under)
                 : std::sqrt((jj - kk + 1) * (jj - kk + 2) / under);
  };
  const std::size_t n = from.energy_cm1.size(), m = to.energy_cm1.size();
  const std::vector<double> vectors = transposed(from.vector, n, from.size());  // [state][level]
  std::vector<double> moved(to.size() * n, 0.0);                                // [state][level]
  const auto add = [&](std::size_t k_to, std::size_t k_from, const std::vector<double>& of,
                       std::size_t stride, bool turned, double factor) {
    const std::size_t rows = to.first[k_to + 1] - to.first[k_to],
                      columns = from.first[k_from + 1] - from.first[k_from];
    if (rows == 0 || columns == 0) return;
    std::vector<double> block(rows * columns);
    for (std::size_t a = 0; a < rows; ++a)
      for (std::size_t b = 0; b < columns; ++b)
        block[a * columns + b] = factor * (turned ? of[b * stride + a] : of[a * stride + b]);
    add_product(rows, n, columns, block.data(), &vectors[from.first[k_from] * n],
                &moved[to.first[k_to] * n]);
  };
  const auto count = [&](std::size_t k, std::size_t s) {
    return basis.states(k, s).energy_cm1.size();
  };
  for (std::size_t k = 0; k <= from.j; ++k) {
    const std::size_t s = k % 2 == 0 ? from.s : basis.other(from.s);
    if (k <= to.j) add(k, k, basis.states(k, s).dipole_z, count(k, s), false, coefficient(k, 0));
    const double root = std::numbers::sqrt2 / 2;
    if (k + 1 <= to.j)
      add(k + 1, k, basis.states(k, s).dipole_x, count(k, s), false,
          -root * coefficient(k, 1) * (k == 0 ? std::numbers::sqrt2 : 1));
    if (k > 0)
      add(k - 1, k, basis.states(k - 1, s).dipole_x, count(k - 1, s), true,
          root * coefficient(k, -1) * (k == 1 ? std::numbers::sqrt2 : 1));
  }
  std::vector<double> out(m * n, 0.0);
  add_product(m, n, to.size(), to.vector.data(), moved.data(), out.data());
  for (double& x : out) x = (2 * jj + 1) * x * x;
  return out;
}

}  // namespace irsig

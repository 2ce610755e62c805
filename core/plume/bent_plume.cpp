#include "core/plume/bent_plume.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"

namespace irsig {
namespace {

constexpr double kGravityMS2 = 9.80665;
constexpr double kMolarMassKgMol = 28.9647e-3;

// Fluxes divided by pi, and where the axis is.
struct State {
  double mass = 0, along = 0, up = 0, x = 0, z = 0;
  friend State operator+(State a, const State& b) {
    a.mass += b.mass, a.along += b.along, a.up += b.up, a.x += b.x, a.z += b.z;
    return a;
  }
  friend State operator*(double f, State a) {
    a.mass *= f, a.along *= f, a.up *= f, a.x *= f, a.z *= f;
    return a;
  }
};

class Model {
 public:
  Model(const PlumeExit& exit, const PlumeAir& air) : exit_(exit), air_(air) {
    const double radius = exit.diameter_m / 2;
    start_.mass = density(exit.temperature_k) * exit.velocity_m_s * radius * radius;
    start_.up = start_.mass * exit.velocity_m_s;
  }

  [[nodiscard]] const State& start() const { return start_; }
  [[nodiscard]] double density(double t) const { return density_kg_m3(air_, t); }

  [[nodiscard]] PlumeStation station(const State& y, double s) const {
    PlumeStation out;
    out.s_m = s;
    out.x_m = y.x;
    out.height_m = y.z;
    out.velocity_m_s = std::hypot(y.along, y.up) / y.mass;
    out.angle_rad = std::atan2(y.up, y.along);
    out.share = start_.mass / y.mass;
    out.radius_m = std::sqrt(y.mass / (density(temperature(out.share)) * out.velocity_m_s));
    return out;
  }

  [[nodiscard]] State slope(const State& y) const {
    const PlumeStation at = station(y, 0);
    const double wind = air_.wind_m_s, r = at.radius_m, air = density(air_.temperature_k);
    const double cosine = y.along / (y.mass * at.velocity_m_s),
                 sine = y.up / (y.mass * at.velocity_m_s);
    State out;
    out.mass = 2 * r * air *
               (kEntrainmentAlong * std::abs(at.velocity_m_s - wind * cosine) +
                kEntrainmentAcross * wind * std::abs(sine));
    out.along = wind * out.mass;
    out.up = kGravityMS2 * (air - density(temperature(at.share))) * r * r;
    out.x = cosine;
    out.z = sine;
    return out;
  }

 private:
  [[nodiscard]] double temperature(double share) const {
    return air_.temperature_k + share * (exit_.temperature_k - air_.temperature_k);
  }

  const PlumeExit& exit_;
  const PlumeAir& air_;
  State start_;
};

State step(const Model& model, const State& y, double h) {
  const State a = model.slope(y), b = model.slope(y + 0.5 * h * a),
              c = model.slope(y + 0.5 * h * b), d = model.slope(y + h * c);
  return y + h / 6 * (a + 2 * b + 2 * c + d);
}

absl::Status check(const PlumeExit& exit, const PlumeAir& air, double length_m) {
  const auto in = [](double x, double least, double most) { return x >= least && x <= most; };
  const auto refuse = [](const char* what, double is, const char* expected) {
    return absl::InvalidArgumentError(fmt::format("{} {:g}, expected {}", what, is, expected));
  };
  if (!in(exit.diameter_m, 1e-3, 100)) return refuse("diameter", exit.diameter_m, "0.001 to 100 m");
  if (!in(exit.velocity_m_s, 0.1, 500))
    return refuse(
        "exit velocity", exit.velocity_m_s,
        "0.1 to 500 m/s: slower gas does not fill its opening, faster gas is compressible");
  if (!in(air.temperature_k, 180, 340))
    return refuse("air temperature", air.temperature_k, "180 to 340 K");
  if (!in(air.pressure_pa, 1e4, 1.2e5))
    return refuse("air pressure", air.pressure_pa, "10 to 120 kPa");
  if (!in(air.wind_m_s, 0, 150)) return refuse("relative wind", air.wind_m_s, "0 to 150 m/s");
  if (!in(exit.temperature_k, air.temperature_k + 1, 3000))
    return refuse("exit temperature", exit.temperature_k,
                  "at least 1 K more than the air and at most 3000 K");
  if (!in(length_m, exit.diameter_m, 1e5))
    return refuse("length", length_m, "one diameter to 100 km");
  return absl::OkStatus();
}

}  // namespace

double density_kg_m3(const PlumeAir& air, double temperature_k) {
  return air.pressure_pa * kMolarMassKgMol / (kGasConstantJMolK * temperature_k);
}

double buoyancy_flux_m4_s3(const PlumeExit& exit, const PlumeAir& air) {
  return kGravityMS2 * exit.velocity_m_s * exit.diameter_m * exit.diameter_m / 4 *
         (exit.temperature_k - air.temperature_k) / exit.temperature_k;
}

absl::StatusOr<std::vector<PlumeStation>> bent_plume(const PlumeExit& exit, const PlumeAir& air,
                                                     double length_m, double step_fraction) {
  RETURN_IF_ERROR(check(exit, air, length_m));
  const Model model(exit, air);
  State y = model.start();
  std::vector<PlumeStation> out{model.station(y, 0)};
  for (double s = 0; s < length_m;) {
    // The last step is not a rounding error.
    double h = step_fraction * out.back().radius_m;
    if (s + 1.5 * h >= length_m) h = length_m - s;
    y = step(model, y, h);
    s = h == length_m - s ? length_m : s + h;
    out.push_back(model.station(y, s));
  }
  return out;
}

}  // namespace irsig

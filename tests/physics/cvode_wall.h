#pragma once

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/base/constants.h"
#include "tests/physics/wall_run.h"

namespace irsig::wall {

// A wall by other means: finite volumes with unknowns in the middle of cells, faces without heat
// capacity solved by secants, and SUNDIALS' CVODE (variable order, its own Newton iteration) in
// time.
class CvodeWall {
 public:
  struct Face {
    FaceProperties properties;
    Weather begin, end;
    [[nodiscard]] double heat_w_m2(double share, double t) const {
      const auto at = [&](double Weather::*value) {
        return begin.*value + share * (end.*value - begin.*value);
      };
      const double above = t - at(&Weather::fluid_k);
      const Convection& c = properties.convection;
      const double n = (above > 0 ? c.natural_warm : c.natural_cold) * std::cbrt(std::abs(above));
      const double f = at(&Weather::forced_h_w_m2_k);
      return at(&Weather::absorbed_w_m2) +
             properties.emissivity *
                 (at(&Weather::incoming_w_m2) - kStefanBoltzmannWM2K4 * t * t * t * std::abs(t)) -
             std::sqrt(n * n + f * f + 2 * c.mixing * n * f) * above;
    }
  };

  // cells: of each layer, finer towards its ends.
  CvodeWall(const std::vector<Layer>& layers, std::size_t cells, bool inner_fixed, double start_k)
      : inner_fixed_(inner_fixed) {
    for (const Layer& layer : layers) {
      for (std::size_t i = 0; i < cells; ++i) {
        const auto edge = [&](std::size_t k) {
          const double x = static_cast<double>(k) / static_cast<double>(cells);
          return layer.thickness_m * x * x * (3 - 2 * x);
        };
        const double d = edge(i + 1) - edge(i);
        capacity_.push_back(d * layer.density_kg_m3 * layer.specific_heat_j_kg_k);
        half_.push_back(layer.conductivity_w_m_k > 0 ? 0.5 * d / layer.conductivity_w_m_k : 1e30);
      }
    }
    const auto n = static_cast<sunindextype>(half_.size());
    SUNContext_Create(nullptr, &context_);
    y_ = N_VNew_Serial(n, context_);
    N_VConst(start_k, y_);
    matrix_ = SUNBandMatrix(n, 1, 1, context_);
    solver_ = SUNLinSol_Band(y_, matrix_, context_);
    cvode_ = CVodeCreate(CV_BDF, context_);
    CVodeInit(cvode_, &CvodeWall::right_side, 0, y_);
    CVodeSetUserData(cvode_, this);
    CVodeSStolerances(cvode_, 1e-9, 1e-7);
    CVodeSetLinearSolver(cvode_, solver_, matrix_);
    CVodeSetMaxNumSteps(cvode_, 1000000);
  }
  ~CvodeWall() {
    CVodeFree(&cvode_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  CvodeWall(const CvodeWall&) = delete;
  CvodeWall& operator=(const CvodeWall&) = delete;

  // Over one interval; the temperatures of the outer and the inner face at its end.
  std::array<double, 2> advance(const Face& outer, const Face& inner, double length_s) {
    face_ = {outer, inner};
    length_s_ = length_s;
    CVodeReInit(cvode_, 0, y_);
    CVodeSetStopTime(cvode_, length_s);
    double reached = 0;
    EXPECT_GE(CVode(cvode_, length_s, y_, &reached, CV_NORMAL), 0);
    const double* t = N_VGetArrayPointer(y_);
    const double behind = t[half_.size() - 1];
    return {t[0] + face_rise_k(0, 1, t[0]), behind + face_rise_k(1, 1, behind)};
  }

 private:
  // How much warmer a face is than the middle of its cell: a small number by itself, not a
  // difference of large ones.
  double face_rise_k(std::size_t side, double share, double cell_k) {
    if (side == 1 && inner_fixed_) {
      return face_[1].begin.fluid_k + share * (face_[1].end.fluid_k - face_[1].begin.fluid_k) -
             cell_k;
    }
    const double g = 1 / half_[side == 0 ? 0 : half_.size() - 1];
    const auto into = [&](double rise) {
      return face_[side].heat_w_m2(share, cell_k + rise) - g * rise;
    };
    double& guess = rise_guess_[side];
    double low = guess - 1e-3, high = guess + 1e-3;
    for (double step = 1e-3; into(low) < 0; step *= 4) low -= step;
    for (double step = 1e-3; into(high) > 0; step *= 4) high += step;
    double f_low = into(low), f_high = into(high);
    int kept = 0;
    for (int k = 0; k < 100; ++k) {  // Illinois method
      double rise = (low * f_high - high * f_low) / (f_high - f_low);
      if (!(rise > low && rise < high)) rise = 0.5 * (low + high);
      guess = rise;
      const double f = into(rise);
      if (std::abs(f) <= 1e-9 + 1e-13 * g * std::abs(rise)) break;
      if (f > 0) {
        low = rise;
        f_low = f;
        if (kept == 1) f_high /= 2;
        kept = 1;
      } else {
        high = rise;
        f_high = f;
        if (kept == -1) f_low /= 2;
        kept = -1;
      }
    }
    return guess;
  }

  static int right_side(double time_s, N_Vector y, N_Vector out, void* self) {
    auto& wall = *static_cast<CvodeWall*>(self);
    const double* t = N_VGetArrayPointer(y);
    double* rate = N_VGetArrayPointer(out);
    const std::size_t n = wall.half_.size();
    const double share = time_s / wall.length_s_;
    double in = wall.face_rise_k(0, share, t[0]) / wall.half_[0];
    for (std::size_t i = 0; i < n; ++i) {
      const double to_next = i + 1 < n ? (t[i] - t[i + 1]) / (wall.half_[i] + wall.half_[i + 1])
                                       : -wall.face_rise_k(1, share, t[i]) / wall.half_[i];
      rate[i] = (in - to_next) / wall.capacity_[i];
      in = to_next;
    }
    return 0;
  }

  bool inner_fixed_;
  std::vector<double> capacity_, half_;  // [cell] J/(m2 K); m2 K/W
  std::array<Face, 2> face_;
  std::array<double, 2> rise_guess_{};
  double length_s_ = 1;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;
};

}  // namespace irsig::wall

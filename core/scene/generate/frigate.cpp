// A frigate of the size of the ship paper's (153.8 x 20.4 m): raked and flared bow, transom stern,
// sloped deckhouses, two funnels, one raked mast, a gun. Its lines are polynomials and straight
// edges of our own drawing, so that it has the same bits on every machine.
//
// The number of triangles is met within 2 % from 2000 on (tests/unit/mesh_test.cpp). Facets are
// about square where the part is wider than a facet; slender parts (the gun's barrel, yards) have
// facets as narrow as they are.
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/scene/generate/frigate_loft.h"
#include "core/scene/generate/generate_kinds.h"

namespace irsig {
namespace {

constexpr double design_length_m = 153.8, design_width_m = 20.4, design_freeboard_m = 6.4;
// The hull is closed just above the sea, not in it: two surfaces in one plane hide each other.
constexpr double keel_m = 0.001;

double square(double x) { return x * x; }

// Half-breadths and deck height over u = 0 (stern) to 1 (stem).
double deck_half_breadth_m(double u) {
  constexpr double full = 0.5 * design_width_m, stem = 0.22;
  if (u < 0.35) return full - 1.9 * square((0.35 - u) / 0.35);
  if (u < 0.55) return full;
  const double s = (u - 0.55) / 0.45;
  return full - (full - stem) * (0.55 * s * s + 0.45 * s * s * s);
}

double waterline_half_breadth_m(double u) {
  constexpr double full = 9.3, stem = 0.12;
  if (u < 0.3) return full - 1.7 * square((0.3 - u) / 0.3);
  if (u < 0.4) return full;
  const double s = (u - 0.4) / 0.6;
  return full - (full - stem) * (0.7 * s * s + 0.3 * s * s * s);
}

double deck_height_m(double u) {
  const double sheer = u < 0.55 ? 0 : (u - 0.55) / 0.45;
  return design_freeboard_m + 2.6 * sheer * sheer;
}

Loft hull(std::uint64_t stations) {
  constexpr double half_length_m = 0.5 * design_length_m;
  Loft loft{"hull", "deck", {}, 0.5, true};
  for (std::uint64_t i = 0; i <= stations; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(stations);
    // The stem rakes by 8 m, the transom by 1.
    loft.section.push_back({-half_length_m + 1 + u * (design_length_m - 9),
                            half_length_m * (2 * u - 1), waterline_half_breadth_m(u),
                            deck_half_breadth_m(u), keel_m, deck_height_m(u)});
  }
  return loft;
}

// A house whose walls lean: x of the aft and fore wall at its foot and roof, half-breadths,
// heights.
Loft block(const char* group, double aft_low, double aft_high, double fore_low, double fore_high,
           double y_low, double y_high, double h_low, double h_high, double y_inner_low = 0,
           double y_inner_high = 0) {
  return {group,
          group,
          {{aft_low, aft_high, y_low, y_high, h_low, h_high, y_inner_low, y_inner_high},
           {fore_low, fore_high, y_low, y_high, h_low, h_high, y_inner_low, y_inner_high}}};
}

// Everything on the hull. Each part sinks 0.1 m or more into what carries it, at heights that no
// two parts share, so that no two facets coincide.
std::vector<Loft> upperworks() {
  const char *house = "superstructure", *funnel = "funnel", *hot = "funnel_top", *mast = "mast";
  std::vector<Loft> out;
  // Deckhouse, its two upper levels with slanted corners (radar panels), bridge, upper bridge.
  out.push_back({house,
                 house,
                 {{-6, -5.6, 8.7, 8.3, 6.3, 9.7},
                  {27, 26.6, 8.7, 8.3, 6.3, 9.7},
                  {35, 33.8, 5.6, 5.2, 6.3, 9.7}}});
  out.push_back({house,
                 house,
                 {{-1, -0.5, 8.0, 7.2, 9.58, 14.2},
                  {22, 21.5, 8.0, 7.2, 9.58, 14.2},
                  {30.5, 28.9, 4.4, 3.9, 9.58, 14.2}}});
  out.push_back({house,
                 house,
                 {{13, 13.3, 6.6, 6.2, 14.08, 17.0},
                  {22, 21.6, 6.9, 6.5, 14.08, 17.0},
                  {28.3, 27.4, 3.6, 3.3, 14.08, 17.0}}});
  out.push_back(block(house, 12.4, 12.8, 20, 19.4, 3.2, 2.8, 16.9, 19.4));
  out.push_back(block(house, 16, 16.3, 18.4, 18.1, 1.0, 0.8, 19.3, 21.2));
  // Amidships house between the deckhouses, hangar, the houses on it, boat bays, launcher, close-in
  // gun before the bridge.
  out.push_back(block(house, -31, -30.8, -5.5, -5.7, 6.6, 6.2, 6.26, 9.3));
  out.push_back(block(house, -54, -53.2, -29.5, -30.3, 7.9, 7.2, 6.22, 12.4));
  out.push_back(block(house, -37, -36.6, -31.4, -31.8, 4.0, 3.5, 12.3, 14.8));
  out.push_back(block(house, -48, -47.8, -46, -46.2, 1.0, 0.8, 12.28, 14.6));
  out.push_back(block(house, -15, -14.6, -7, -7.4, 9.0, 8.6, 6.18, 8.6, 7.4, 7.5));
  out.push_back(block(house, 37, 37, 42, 42, 3.2, 3.2, 6.6, 7.5));
  out.push_back(block(house, 31.2, 31.4, 32.8, 32.5, 0.9, 0.6, 9.56, 11.8));
  // Funnels, each with two exhaust openings that stand 0.275 m proud: 4 x 2.75 m2 are seen.
  out.push_back(block(funnel, -12, -11, -3, -4.5, 3.4, 2.7, 9.1, 19.6));
  out.push_back(block(funnel, -28, -27, -19.5, -20.8, 3.4, 2.7, 9.08, 18.4));
  out.push_back(block(hot, -8.4, -8.4, -7.1, -7.1, 1.7, 1.7, 19.5, 19.875, 0.6, 0.6));
  out.push_back(block(hot, -24.5, -24.5, -23.2, -23.2, 1.7, 1.7, 18.3, 18.675, 0.6, 0.6));
  // Raked mast: trunk, pole, two legs, platform, yards; the wall that the forward funnel's exhaust
  // heats stands 0.08 m proud of the trunk's after face: 5 m2 are seen.
  out.push_back(block(mast, 6, 4.5, 9, 5.7, 1.2, 0.5, 13.9, 30));
  out.push_back(block(mast, 4.75, 2.9, 5.4, 3.2, 0.3, 0.12, 29.5, 41));
  out.push_back(block(mast, 0, 4.9, 0.9, 5.5, 4.3, 0.75, 13.86, 26, 3.6, 0.35));
  out.push_back(block(mast, 4.6, 4.6, 9.6, 9.6, 1.9, 1.9, 21, 21.4));
  out.push_back(block(mast, 5.5, 5.5, 6.0, 6.0, 5.5, 5.5, 24, 24.35));
  out.push_back(block(mast, 4.9, 4.9, 5.3, 5.3, 3.6, 3.6, 28, 28.3));
  out.push_back(block("mast_hot", 5.7243, 5.5012, 5.9043, 5.6812, 0.9, 0.9, 16, 18.395));
  // Gun: house and barrel.
  out.push_back(block("turret", 44, 44.4, 49.5, 47.8, 1.9, 1.2, 7.0, 10.0));
  out.push_back({"turret",
                 "turret",
                 {{47, 47, 0.16, 0.16, 8.45, 8.77}, {55.2, 55.2, 0.13, 0.13, 9.0, 9.26}}});
  return out;
}

// The hull's stations are chosen apart: they take up what the other parts' divisions leave over.
struct Division {
  double edge_m = 1;
  std::uint64_t stations = 1;
};

std::uint64_t count(const std::vector<Loft>& parts, double edge_m) {
  std::uint64_t out = 0;
  for (const Loft& part : parts) out += divide(part, edge_m).triangles;
  return out;
}

std::uint64_t stations_for(double edge_m) {
  return static_cast<std::uint64_t>(std::max(24.0, std::floor(design_length_m / edge_m)));
}

Division division_for(const std::vector<Loft>& parts, std::uint64_t triangles) {
  double fine_m = 1e-3, coarse_m = 50;
  for (int i = 0; i < 50; ++i) {
    const double edge_m = std::sqrt(fine_m * coarse_m);
    const std::uint64_t n =
        count(parts, edge_m) + divide(hull(stations_for(edge_m)), edge_m).triangles;
    (n > triangles ? fine_m : coarse_m) = edge_m;
  }
  Division best{coarse_m, stations_for(coarse_m)};
  const std::uint64_t others = count(parts, best.edge_m);
  std::uint64_t best_miss = std::numeric_limits<std::uint64_t>::max();
  for (std::uint64_t stations = best.stations * 3 / 4; stations <= best.stations * 5 / 4;
       ++stations) {
    const std::uint64_t n = others + divide(hull(stations), best.edge_m).triangles;
    const std::uint64_t miss = n > triangles ? n - triangles : triangles - n;
    if (miss >= best_miss) continue;
    best_miss = miss;
    best.stations = stations;
  }
  return best;
}

}  // namespace

Mesh make_frigate(double length_m, double width_m, double freeboard_m, std::uint64_t triangles) {
  const std::vector<Loft> parts = upperworks();
  const Division division = division_for(parts, triangles);
  Mesh half;
  const Loft lines = hull(division.stations);
  add_starboard_half(lines, divide(lines, division.edge_m), half);
  for (const Loft& part : parts) add_starboard_half(part, divide(part, division.edge_m), half);
  Mesh mesh = with_port_half(half);
  const double sx = length_m / design_length_m, sy = width_m / design_width_m,
               sz = freeboard_m / design_freeboard_m;
  for (Vec<Body>& v : mesh.vertex) v = {sx * v.x, sy * v.y, sz * v.z};
  return mesh;
}

}  // namespace irsig

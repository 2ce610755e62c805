// Exchange factors of faces, and what they have of the sun.
#include "core/thermal/scene/exchange_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/thermal/scene/sun_visibility.h"
#include "heat_scene.h"

namespace irsig {
namespace {

TEST(ExchangeFactors, RowsAddUpAndAreasTimesSharesAreSymmetric) {
  // A large ground below a small box: one facet of the ground meets the box with a few rays.
  Mesh mesh = plate("ground", {-20, -20, 1}, {0, 40, 0}, {40, 0, 0}, 3);
  append(mesh, generated("box", 48));
  const Target target = target_of(mesh, {part("ground", true), part("box")});
  const ThermalFaces faces = make_thermal_faces(target);
  ASSERT_EQ(faces.size(), faces.fronts + 18);
  const ExchangeFactors f = exchange_factors(target, faces, {.rays = 256, .surface_z_m = INFINITY});
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    double sum = static_cast<double>(f.sky[i]) + static_cast<double>(f.lower[i]);
    for (std::size_t k = f.first[i]; k < f.first[i + 1]; ++k) {
      const double there = faces.area_m2[i] * static_cast<double>(f.share[k]);
      sum += static_cast<double>(f.share[k]);
      const auto begin = f.to.begin() + static_cast<std::ptrdiff_t>(f.first[f.to[k]]),
                 end = f.to.begin() + static_cast<std::ptrdiff_t>(f.first[f.to[k] + 1]);
      const auto found = std::find(begin, end, i);
      ASSERT_NE(found, end);
      const double back =
          faces.area_m2[f.to[k]] *
          static_cast<double>(f.share[static_cast<std::size_t>(found - f.to.begin())]);
      EXPECT_NEAR(there, back, 1e-5 * there);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

// A box that stands in a plate, its lower half below: what of the plate lies inside it does not
// count, and the rest of the plate sees what it would see of a box on the plate.
// Rationale: what is inside a body is seen by nobody, and must not make a face uneven.
// Expected: a slab on a deck hides a quarter of it and no sky from the rest: even. A wall of 4 m
// along two of its edges takes sky from the places beside it.
TEST(ExchangeFactors, OnlyExposedPlacesDiffer) {
  for (const bool wall : {false, true}) {
    Mesh mesh = plate("plate", {-2, -2, 0}, {0, 4, 0}, {4, 0, 0}, 1);
    append(mesh, named(generated("box", 12, 0, 2, 2, 0.01), "box"));
    append(mesh, plate("wall", {2.01, -2, wall ? 0.0 : 90.0}, {0, 4, 0}, {0, 0, -4}, 1));
    const Target target = target_of(mesh, {part("plate"), part("box"), part("wall", true)});
    const ThermalFaces faces = make_thermal_faces(target);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const ExchangeFactors f =
          exchange_factors(target, faces, {.rays = 4096, .seed = seed, .surface_z_m = INFINITY});
      for (std::uint32_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(f.exposed[i], 0.75, 0.04);
        if (wall) {
          EXPECT_GT(f.uneven_sky[i], 0.05) << seed;
        } else {
          EXPECT_LT(f.uneven_sky[i], 0.02) << seed;
        }
        EXPECT_EQ(f.uneven_lower[i], 0) << seed;
        EXPECT_EQ(f.uneven_aims_w_m2[i], 0) << seed;
      }
    }
  }
}

TEST(ExchangeFactors, PlacesInsideABodyDoNotCount) {
  Mesh mesh = plate("plate", {-2, -2, 0}, {0, 4, 0}, {4, 0, 0}, 1);
  Mesh box = generated("box", 12, 0, 2, 2, 2);
  box = named(std::move(box), "box");
  append(mesh, box);
  const Target target = target_of(mesh, {part("plate"), part("box")});
  const ThermalFaces faces = make_thermal_faces(target);
  const ExchangeFactors f =
      exchange_factors(target, faces, {.rays = 4096, .surface_z_m = INFINITY});
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(f.exposed[i], 0.75, 0.02);
    double sum = static_cast<double>(f.sky[i]);
    for (std::size_t k = f.first[i]; k < f.first[i + 1]; ++k)
      sum += static_cast<double>(f.share[k]);
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

// A hot block on a deck: what of the deck lies below it is as if it were not there.
TEST(ExchangeFactors, WhatIsHiddenExchangesNothing) {
  Mesh mesh = plate("deck", {-4, -4, 0}, {0, 8, 0}, {8, 0, 0}, 8);
  Mesh block = generated("box", 48, 0, 4, 4, 1);
  for (auto& v : block.vertex) v.z -= 0.5;
  block = named(std::move(block), "block");
  append(mesh, block);
  const Target target = target_of(mesh, {part("deck"), part("block")});
  const ThermalFaces faces = make_thermal_faces(target);
  const ExchangeFactors f =
      exchange_factors(target, faces, {.rays = 1024, .surface_z_m = INFINITY});
  int hidden = 0;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    double to_others = 0, sum = static_cast<double>(f.sky[i]) + static_cast<double>(f.lower[i]);
    for (std::size_t k = f.first[i]; k < f.first[i + 1]; ++k) {
      sum += static_cast<double>(f.share[k]);
      to_others += f.to[k] != i ? static_cast<double>(f.share[k]) : 0;
    }
    EXPECT_NEAR(sum, f.exposed[i] > 0 ? 1 : 0, 1e-6);
    if (f.exposed[i] > 0) continue;
    ++hidden;
    EXPECT_EQ(to_others, 0);
  }
  EXPECT_GE(hidden, 32) << "the deck's facets below the block";
}

// Rationale: 256 rays and 128 may agree by luck on a share of the sky that both are wrong about.
// Expected: where nothing of the target is seen, (1 + cos t) / 2 to rounding, and no ray; where
// something is, blocks of rays that add up to all of them.
TEST(ExchangeFactors, WhoSeesNothingOfTheTargetKnowsItsSky) {
  Mesh mesh = generated("box", 12, 0, 2, 1, 1);
  mesh = named(std::move(mesh), "box");
  const double turn = 0.4;
  for (auto& v : mesh.vertex)
    v = {v.x, std::cos(turn) * v.y - std::sin(turn) * v.z,
         std::sin(turn) * v.y + std::cos(turn) * v.z};
  const auto box = static_cast<std::uint32_t>(mesh.triangle.size());
  // A floor that the box hangs above, so that the target as a whole is not convex.
  append(mesh, plate("floor", {-3, -3, 3}, {0, 6, 0}, {6, 0, 0}, 1));
  const Target target = target_of(mesh, {part("box"), part("floor")});
  ASSERT_FALSE(target.convex);
  const ThermalFaces faces = make_thermal_faces(target);
  const ExchangeFactors f =
      exchange_factors(target, faces, {.rays = 256, .surface_z_m = INFINITY, .keep_hits = true});
  int alone = 0;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    double rays = 0, hits = 0;
    for (std::size_t b = 0; b < ExchangeFactors::kBlocks; ++b) {
      rays += f.all_hits[i * ExchangeFactors::kBlocks + b];
      hits += f.sky_hits[i * ExchangeFactors::kBlocks + b] +
              f.lower_hits[i * ExchangeFactors::kBlocks + b];
    }
    for (std::size_t h = f.first_hit[i]; h < f.first_hit[i + 1]; ++h) hits += f.hit[h].count;
    EXPECT_EQ(hits, rays) << i;
    if (i < box && normal_of(target, faces, i).z < -0.6f) {
      ++alone;
      EXPECT_EQ(rays, 0) << i;
      EXPECT_NEAR(f.sky[i], 0.5 * (1 - static_cast<double>(normal_of(target, faces, i).z)), 1e-6);
      EXPECT_NEAR(f.sky[i] + f.lower[i], 1, 1e-6);
    } else {
      EXPECT_EQ(rays, 256) << i;
    }
  }
  EXPECT_EQ(alone, 2);
}

TEST(SunVisibility, HalfOfAPlateInTheShadow) {
  // A wall of height 1 beside a plate; the sun stands 45 deg high behind the wall, whose shadow is
  // 1 long.
  Mesh mesh = plate("floor", {0, 0, 0}, {0, 2, 0}, {2, 0, 0}, 1);
  append(mesh, plate("wall", {0, -5, 0}, {0, 12, 0}, {0, 0, -1}, 1));
  const Target target = target_of(mesh, {part("floor"), part("wall", true)});
  const ThermalFaces faces = make_thermal_faces(target);
  const double s = std::sqrt(0.5);
  double mean = 0, area = 0;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    std::vector<float> lit(faces.size());
    sun_visibility(target, faces, {{-s, 0, -s}, 0.0047},
                   {.points = 16, .seed = seed, .surface_z_m = INFINITY}, lit);
    for (std::uint32_t i = 0; i < 2; ++i) {
      mean += faces.area_m2[i] * static_cast<double>(lit[i]);
      area += faces.area_m2[i];
    }
    // The wall's side that faces the sun has all of it.
    for (std::uint32_t i = 2; i < faces.size(); ++i)
      EXPECT_NEAR(lit[i], faces.is_back(i) ? 0 : s, 1e-5);
  }
  EXPECT_NEAR(mean / area, 0.5 * s, 0.01);
}

}  // namespace
}  // namespace irsig

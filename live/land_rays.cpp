#include "live/land_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

PacketGrid packet_grid(const HeightGrid& of, double bend_per_m) {
  PacketGrid out{of.columns, of.rows, {}};
  out.vertex.reserve(3 * of.z_m.size() + 4);
  for (std::uint32_t row = 0; row <= of.rows; ++row)
    for (std::uint32_t column = 0; column <= of.columns; ++column) {
      const double x_m = of.west_m + column * of.spacing_m, y_m = of.south_m + row * of.spacing_m;
      const auto z_m = static_cast<double>(of.z_m[std::size_t{row} * (of.columns + 1) + column]);
      for (const double v : {x_m, y_m, z_m + bend_per_m * (x_m * x_m + y_m * y_m)})
        out.vertex.push_back(static_cast<float>(v));
    }
  return out;
}

}  // namespace

absl::StatusOr<std::unique_ptr<const LandRays>> LandRays::make(const LandScene& land,
                                                               double bend_per_m) {
  std::unique_ptr<LandRays> out(new LandRays(land, bend_per_m));
  const HeightGrid& outer = land.field->outer();
  std::vector<PacketGrid> grid;
  grid.push_back(packet_grid(outer, bend_per_m));
  if (const HeightGrid* inset = land.field->inset()) {
    const auto cells = [&](double from_m, double start_m) {
      return static_cast<std::uint32_t>(std::lround((from_m - start_m) / outer.spacing_m));
    };
    PacketGrid& around = grid.front();
    around.hole_left = cells(inset->west_m, outer.west_m);
    around.hole_low = cells(inset->south_m, outer.south_m);
    around.hole_columns = cells(inset->columns * inset->spacing_m, 0);
    around.hole_rows = cells(inset->rows * inset->spacing_m, 0);
    grid.push_back(packet_grid(*inset, bend_per_m));
  }
  std::vector<PacketMesh> mesh;
  std::vector<PacketInstance> instance;
  if (const LandObjects* objects = land.objects.get()) {
    for (std::size_t s = 0; s < objects->shapes(); ++s) {
      const LandObjects::ShapeMesh shape = objects->mesh(s);
      mesh.push_back({shape.vertex, shape.triangle});
    }
    for (std::size_t i = 0; i < objects->count(); ++i) {
      const LandObjects::Stand at = objects->stand(i);
      const double c = at.scale * at.cos_heading, s = at.scale * at.sin_heading;
      const Vec<Enu>& m = at.middle_m;
      const auto number = [](double v) { return static_cast<float>(v); };
      instance.push_back(
          {at.shape,
           {number(s), number(c), 0, number(c), number(-s), 0, 0, 0, number(-at.scale)},
           {number(m.x), number(m.y), number(m.z + bend_per_m * (m.x * m.x + m.y * m.y))}});
    }
  }
  ASSIGN_OR_RETURN(out->scene_, PacketScene::make(std::move(grid), mesh, std::move(instance)));
  return out;
}

void LandRays::mix_at(std::uint32_t instance, std::uint32_t triangle, double x_m, double y_m,
                      Vec<Enu> normal, LandMix& mix) const {
  mix.fraction.resize(land_.cover.materials());
  const bool object = instance != PacketScene::kGround;
  if (object) {
    std::fill(mix.fraction.begin(), mix.fraction.end(), 0.0f);
    mix.fraction[land_.objects->material(land_.objects->stand(instance).shape, triangle)] = 1;
  } else {
    land_.cover.at(x_m, y_m, mix.fraction);
  }
  mix.kind.clear();
  if (land_.kinds) return land_.kinds->at(x_m, y_m, normal, object, mix.fraction, mix.kind);
  for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
    if (mix.fraction[m] > 0) mix.kind.push_back({m, mix.fraction[m]});
}

}  // namespace irsig

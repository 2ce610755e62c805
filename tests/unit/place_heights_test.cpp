#include "core/land/place_heights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::string hgt_of(int side, int (*height)(int column, int row)) {
  std::string out;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const auto value = static_cast<std::uint16_t>(height(column, row));
      out.push_back(static_cast<char>(value >> 8));
      out.push_back(static_cast<char>(value & 0xff));
    }
  return out;
}

TEST(Hgt, NameAndSizeStateTheTile) {
  const std::string tile = hgt_of(
      1201, [](int column, int row) { return row == 7 && column == 3 ? -32768 : column - row; });
  const auto raster = read_hgt(tile, "maps/s01W172.hgt");
  ASSERT_TRUE(raster.ok()) << raster.status();
  EXPECT_TRUE(std::holds_alternative<GeographicDegrees>(raster->system));
  EXPECT_EQ(raster->x0, -172);
  EXPECT_EQ(raster->y0, 0);
  EXPECT_EQ(raster->x_step, 1.0 / 1200);
  EXPECT_EQ(raster->y_step, -1.0 / 1200);
  EXPECT_EQ(raster->height_m[1200], 1200);
  EXPECT_EQ(raster->height_m[1201 * 1200], -1200);
  EXPECT_TRUE(std::isnan(raster->height_m[7 * 1201 + 3]));
}

TEST(Hgt, RefusesOtherNamesAndSizes) {
  const auto message = [](const std::string& bytes, const std::string& name) {
    return std::string(read_hgt(bytes, name).status().message());
  };
  const std::string good = hgt_of(1201, [](int, int) { return 0; });
  EXPECT_EQ(message(good, "N46E007.hgt"), "");
  EXPECT_EQ(message(good, "N46E007.SRTMGL3.hgt"), "");
  for (const char* name : {"alps.hgt", "N46E07.hgt", "N91E007.hgt", "N46E200.hgt", "X46E007.hgt",
                           "N+6E007.hgt", "N-6E007.hgt", "", "N46"})
    EXPECT_THAT(message(good, name), HasSubstr("expected a name that begins as N46E007.hgt"))
        << name;
  EXPECT_THAT(message(good.substr(1), "N46E007.hgt"),
              HasSubstr("N46E007.hgt: 2884801 bytes are no tile"));
  EXPECT_THAT(message("", "N46E007.hgt"), HasSubstr("0 bytes are no tile"));
}

const char* const kAsc =
    "NCOLS 3\r\nnrows 2\nxllcorner 100\nyllcorner -20\ncellsize 10\nNODATA_value -9999\n"
    "1 2 3.5\n-9999 5e1 -6\n";

TEST(Asc, HasItsSamplesAtCellCentres) {
  const auto raster = read_asc(kAsc, "a.asc", LocalMetres{});
  ASSERT_TRUE(raster.ok()) << raster.status();
  EXPECT_EQ(raster->columns, 3U);
  EXPECT_EQ(raster->rows, 2U);
  EXPECT_EQ(raster->x0, 105);
  EXPECT_EQ(raster->y0, -5);
  EXPECT_EQ(raster->y_step, -10);
  EXPECT_EQ(raster->height_m[2], 3.5F);
  EXPECT_TRUE(std::isnan(raster->height_m[3]));
  HeightRaster precise = *raster;
  precise.x0 = -199999.9512345678;
  precise.height_m[0] = 1234.5678F;
  const auto far = read_asc(write_asc(precise), "c.asc", LocalMetres{});
  ASSERT_TRUE(far.ok()) << far.status();
  EXPECT_EQ(far->x0, precise.x0);
  EXPECT_EQ(far->height_m[0], precise.height_m[0]);
  const auto again = read_asc(write_asc(*raster), "b.asc", LocalMetres{});
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->x0, raster->x0);
  EXPECT_EQ(again->y0, raster->y0);
  EXPECT_TRUE(std::isnan(again->height_m[3]));
  EXPECT_EQ(again->height_m[5], -6);
}

TEST(Asc, RefusalsNamePlaceAndReason) {
  const auto message = [](std::string from, std::string to) {
    std::string text = kAsc;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return std::string(read_asc(text, "a.asc", LocalMetres{}).status().message());
  };
  EXPECT_EQ(message("5e1", "50"), "");
  EXPECT_THAT(message("5e1", "x7"), HasSubstr("a.asc:8:7: \"x7\" is no finite number"));
  EXPECT_THAT(message("5e1", "nan"), HasSubstr("a.asc:8:7: \"nan\" is no finite number"));
  EXPECT_THAT(message("5e1", "1e999"), HasSubstr("is no finite number"));
  EXPECT_THAT(message("5e1", "-3e38"),
              HasSubstr("a.asc:8:7: a height of -3e+38 m is beyond 100 km"));
  EXPECT_THAT(message(" -6\n", ""), HasSubstr("the file ends after 5 of 6 heights"));
  EXPECT_THAT(message("-6\n", "-6 7"), HasSubstr("a.asc:8:14: more than the 3 x 2 heights"));
  EXPECT_THAT(message("cellsize 10", "cellsize 0"), HasSubstr("cellsize is 0"));
  EXPECT_THAT(message("cellsize 10\n", ""), HasSubstr("header is not complete"));
  EXPECT_THAT(message("cellsize 10", "cellsize ten"),
              HasSubstr("a.asc:5:10: cellsize needs a finite"));
  EXPECT_THAT(message("xllcorner 100", "xllcorner 100\nxllcenter 105"),
              HasSubstr("one of xllcorner"));
  EXPECT_THAT(message("nrows 2", "nrows 2\nnrows 2"), HasSubstr("a.asc:3:1: nrows is given twice"));
  EXPECT_THAT(message("nrows 2", "levels 2"), HasSubstr("a.asc:2:1: \"levels\" is no key"));
  EXPECT_THAT(message("nrows 2", "nrows 2.5"), HasSubstr("expected whole numbers"));
  EXPECT_THAT(message("nrows 2", "nrows -2"), HasSubstr("expected whole numbers"));
  // Sizes that the file does not hold take no memory.
  EXPECT_THAT(message("nrows 2", "nrows 80000000"), HasSubstr("more than the file holds"));
  EXPECT_THAT(message("nrows 2", "nrows 2147483648"), HasSubstr("expected whole numbers"));
  EXPECT_FALSE(read_asc("", "a.asc", LocalMetres{}).ok());
  EXPECT_FALSE(read_asc("ncols", "a.asc", LocalMetres{}).ok());
  EXPECT_FALSE(read_asc(std::string("\0\x1b[2J", 5), "a.asc", LocalMetres{}).ok());
}

TEST(MapSystem, KnowsDegreesAndUtm) {
  EXPECT_TRUE(std::holds_alternative<GeographicDegrees>(*map_system(4326)));
  EXPECT_EQ(std::get<UtmZone>(*map_system(32632)).zone, 32);
  EXPECT_TRUE(std::get<UtmZone>(*map_system(32760)).south);
  for (const std::uint64_t other :
       {0ULL, 3857ULL, 32600ULL, 32661ULL, 32700ULL, 32761ULL, 4294967295ULL})
    EXPECT_THAT(std::string(map_system(other).status().message()),
                HasSubstr("gdalwarp -t_srs EPSG:326ZZ"));
}

// Expected: false origins at the equator, and 0.9996 times the meridian's arc of 45 degrees along
// the central meridian. Source: definition of UTM; arc of WGS 84, 4984944.378 m.
TEST(Utm, HasItsDefinition) {
  EXPECT_NEAR(utm_point({31, false}, 0, 3).easting_m, 5e5, 1e-6);
  EXPECT_NEAR(utm_point({31, false}, 0, 3).northing_m, 0, 1e-6);
  EXPECT_NEAR(utm_point({31, true}, 0, 3).northing_m, 1e7, 1e-6);
  EXPECT_NEAR(utm_point({31, false}, 45, 3).northing_m, 0.9996 * 4984944.378, 1e-3);
}

// A smooth land of 3000 m in the coordinates of a raster.
double hill_m(double x, double y) { return 1500 + 1500 * std::sin(x) * std::cos(y); }

HeightRaster raster_of(const MapSystem& system, double x0, double y0, double step, double scale,
                       std::uint32_t side) {
  HeightRaster out{system, x0, y0, step, -step, side, side, {}};
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column)
      out.height_m.push_back(
          static_cast<float>(hill_m((x0 + column * step) / scale, (y0 - row * step) / scale)));
  return out;
}

// Rationale: a vertex must stand on the ellipsoid at the height that the raster has below it.
// Expected: the geodetic height of each vertex is the land's at its own latitude and longitude, to
// 1 cm and the error of bilinear interpolation, h'' s^2 / 8. Source: GeographicLib.
TEST(PlaceHeights, VerticesHaveTheHeightOfTheirPlace) {
  const GeodeticPosition origin{47.3, 179.98, 250};  // the map reaches over the date line
  const LandMap map{origin, -50000, -40000, 100, 1000, 800, 48.5, std::nullopt};
  const auto check = [&](const HeightRaster& raster, double scale, double per_metre,
                         const auto& at) {
    const auto grid = place_heights(raster, map);
    ASSERT_TRUE(grid.ok()) << grid.status();
    ASSERT_TRUE(HeightField::create(*grid).ok());
    const double step_m = raster.x_step / per_metre;
    const double bend = 1500 * std::pow(step_m * per_metre / scale, 2) / 4;
    std::mt19937_64 random(1);
    for (int k = 0; k < 3000; ++k) {
      const std::size_t vertex = random() % grid->z_m.size();
      const double x = map.west_m + 100 * double(vertex % 1001),
                   y = map.south_m + 100 * double(vertex / 1001);
      const GeodeticPosition place = geodetic_position(origin, {x, y, grid->z_m[vertex]});
      const auto [east, north] = at(place);
      EXPECT_NEAR(place.height_m - map.geoid_m, hill_m(east / scale, north / scale), 0.01 + bend)
          << x << " " << y;
    }
  };
  check(raster_of(GeographicDegrees{}, 178.9, 48.3, 0.001, 0.3, 2100), 0.3, 1.0 / 75000,
        [](const GeodeticPosition& p) {
          return std::pair(p.longitude_deg < 0 ? p.longitude_deg + 360 : p.longitude_deg,
                           p.latitude_deg);
        });
  const UtmZone zone{60, false};
  const UtmPoint centre = utm_point(zone, origin.latitude_deg, origin.longitude_deg);
  check(raster_of(zone, centre.easting_m - 60000, centre.northing_m + 60000, 90, 30000, 1400),
        30000, 1.0, [&](const GeodeticPosition& p) {
          const UtmPoint point = utm_point(zone, p.latitude_deg, p.longitude_deg);
          return std::pair(point.easting_m, point.northing_m);
        });
}

// Expected: level land in local metres falls away as the ellipsoid does: 196 m at 50 km.
TEST(PlaceHeights, LocalHeightsFollowTheEllipsoid) {
  HeightRaster raster{LocalMetres{}, -50000, 50000, 1000, -1000, 101, 101, {}};
  raster.height_m.assign(101 * 101, 20);
  const LandMap map{{0, 10, 20}, -50000, -50000, 500, 200, 200, 0, std::nullopt};
  const auto grid = place_heights(raster, map);
  ASSERT_TRUE(grid.ok()) << grid.status();
  EXPECT_NEAR(grid->z_m[201 * 100 + 100], 0, 1e-4);
  // East along the equator the section is a circle of 6378137 m.
  const double radius = 6378137 + 20;
  EXPECT_NEAR(grid->z_m[201 * 100 + 200], std::sqrt(radius * radius - 5e4 * 5e4) - radius, 2e-3);
}

TEST(PlaceHeights, MissingHeightsAreRefusedOrFilled) {
  HeightRaster raster{LocalMetres{}, 0, 100, 10, -10, 11, 11, {}};
  raster.height_m.assign(121, 5);
  raster.height_m[3 * 11 + 4] = std::nanf("");  // at x = 40, y = 70
  LandMap map{{50, 0, 0}, 0, 0, 10, 10, 10, 0, std::nullopt};
  EXPECT_THAT(std::string(place_heights(raster, map).status().message()),
              HasSubstr("1 of 121 vertices have no height, the first at x = 40 m, y = 70 m"));
  map.fill_m = 7;
  const auto filled = place_heights(raster, map);
  ASSERT_TRUE(filled.ok());
  EXPECT_NEAR(filled->z_m[7 * 11 + 4], 7, 1e-2);
  EXPECT_NEAR(filled->z_m[7 * 11 + 5], 5, 1e-2);
  map.fill_m.reset();
  map.columns = 12;
  EXPECT_THAT(std::string(place_heights(raster, map).status().message()),
              HasSubstr("have no height"));
}

TEST(PlaceHeights, RefusesMapsBeyondItsLimits) {
  HeightRaster raster{LocalMetres{}, 0, 10, 10, -10, 2, 2, {1, 1, 1, 1}};
  const LandMap good{{50, 0, 0}, 0, 0, 10, 1, 1, 0, std::nullopt};
  EXPECT_TRUE(place_heights(raster, good).ok());
  const auto refused = [&](auto change) {
    LandMap map = good;
    change(map);
    return std::string(place_heights(raster, map).status().message());
  };
  EXPECT_THAT(refused([](LandMap& m) { m.west_m = -5e5; }), HasSubstr("more than 400 km"));
  EXPECT_THAT(refused([](LandMap& m) { m.spacing_m = std::nan(""); }),
              HasSubstr("more than 400 km"));
  EXPECT_THAT(refused([](LandMap& m) { m.spacing_m = 0; }), HasSubstr("spacing above 0"));
  EXPECT_THAT(refused([](LandMap& m) { m.columns = 0; }), HasSubstr("at least 2 x 2"));
  EXPECT_THAT(refused([](LandMap& m) {
                m.columns = m.rows = 0x7fffffff;
                m.spacing_m = 1e-5;
              }),
              HasSubstr("limit"));
  EXPECT_THAT(refused([](LandMap& m) { m.origin.latitude_deg = 90; }),
              HasSubstr("within 89 degrees"));
  EXPECT_THAT(refused([](LandMap& m) {
                m.origin.latitude_deg = 88.9;
                m.south_m = 20000;
              }),
              HasSubstr("beyond a latitude of 89 degrees"));
  raster.height_m[2] = -3.4e38F;
  EXPECT_THAT(refused([](LandMap&) {}), HasSubstr("state it as nodata_value"));
}

}  // namespace
}  // namespace irsig

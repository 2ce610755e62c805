#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>

#include "core/land/geotiff/read_geotiff.h"
#include "core/land/read_heights.h"
#include "tests/fuzz/mutator.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <typename T>
std::string packed(std::initializer_list<T> values) {
  std::string out;
  for (const T value : values) out.append(reinterpret_cast<const char*>(&value), sizeof value);
  return out;
}

// A TIFF of one directory, little-endian, written by hand: libtiff must not judge itself.
struct Tiff {
  struct Tag {
    std::uint16_t type;
    std::string bytes;  // of its values
  };
  std::map<std::uint16_t, Tag> tag;
  std::string data;  // one strip

  void shorts(std::uint16_t id, std::initializer_list<std::uint16_t> v) {
    tag[id] = {3, packed(v)};
  }
  void longs(std::uint16_t id, std::initializer_list<std::uint32_t> v) { tag[id] = {4, packed(v)}; }
  void doubles(std::uint16_t id, std::initializer_list<double> v) { tag[id] = {12, packed(v)}; }
  void text(std::uint16_t id, const std::string& v) { tag[id] = {2, v + '\0'}; }

  [[nodiscard]] std::string bytes() const {
    static constexpr std::size_t kSize[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};
    std::string body = data, directory;
    const auto at = [&] { return static_cast<std::uint32_t>(8 + body.size()); };
    std::map<std::uint16_t, Tag> all = tag;
    if (!tag.contains(324) && !tag.contains(273)) {  // neither tiles nor a stated offset
      all[273] = {4, packed({std::uint32_t{8}})};
      all[279] = {4, packed({static_cast<std::uint32_t>(data.size())})};
    }
    for (const auto& [id, t] : all) {
      const auto count = static_cast<std::uint32_t>(t.bytes.size() / kSize[t.type]);
      directory += packed({id, t.type}) + packed({count});
      if (t.bytes.size() <= 4) {
        directory += t.bytes + std::string(4 - t.bytes.size(), '\0');
      } else {
        directory += packed({at()});
        body += t.bytes;
      }
    }
    const auto entries = static_cast<std::uint16_t>(all.size());
    return "II" + packed({std::uint16_t{42}}) + packed({at()}) + body + packed({entries}) +
           directory + packed({std::uint32_t{0}});
  }
};

// 3 x 2 heights in UTM zone 32, 30 m apart.
Tiff sound() {
  Tiff out;
  out.longs(256, {3});
  out.longs(257, {2});
  out.shorts(258, {32});
  out.shorts(259, {1});
  out.shorts(262, {1});
  out.shorts(277, {1});
  out.longs(278, {2});
  out.shorts(339, {3});
  out.doubles(33550, {30, 30, 0});
  out.doubles(33922, {0, 0, 0, 500000, 5200000, 0});
  out.shorts(34735, {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632});
  out.text(42113, "-9999");
  out.data = packed({1.5F, 2.F, 3.F, 4.F, -9999.F, 6.F});
  return out;
}

void expect_sound(const absl::StatusOr<HeightRaster>& raster) {
  ASSERT_TRUE(raster.ok()) << raster.status();
  EXPECT_EQ(raster->columns, 3U);
  EXPECT_EQ(raster->rows, 2U);
  EXPECT_EQ(std::get<UtmZone>(raster->system).zone, 32);
  EXPECT_EQ(raster->x0, 500015);
  EXPECT_EQ(raster->y0, 5199985);
  EXPECT_EQ(raster->x_step, 30);
  EXPECT_EQ(raster->y_step, -30);
  EXPECT_EQ(raster->height_m[0], 1.5F);
  EXPECT_EQ(raster->height_m[3], 4);
  EXPECT_TRUE(std::isnan(raster->height_m[4]));
}

TEST(GeoTiff, IsReadHereAndInItsOwnProcess) {
  expect_sound(read_geotiff(sound().bytes()));
  expect_sound(read_heights(sound().bytes(), "Alps.TIF"));
}

TEST(GeoTiff, OtherPlacesAndForms) {
  Tiff points = sound();  // samples as points, tied at sample (2, 1), in degrees
  points.doubles(33550, {0.01, 0.02, 0});
  points.doubles(33922, {2, 1, 0, 7, 46, 0});
  points.shorts(34735, {1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 2, 2048, 0, 1, 4326});
  const auto at_points = read_geotiff(points.bytes());
  ASSERT_TRUE(at_points.ok()) << at_points.status();
  EXPECT_TRUE(std::holds_alternative<GeographicDegrees>(at_points->system));
  EXPECT_DOUBLE_EQ(at_points->x0, 6.98);
  EXPECT_DOUBLE_EQ(at_points->y0, 46.02);
  Tiff matrix = sound();
  matrix.tag.erase(33550);
  matrix.tag.erase(33922);
  matrix.doubles(34264, {30, 0, 0, 500000, 0, -30, 0, 5200000, 0, 0, 0, 0, 0, 0, 0, 1});
  expect_sound(read_geotiff(matrix.bytes()));
  Tiff integers = sound();
  integers.shorts(258, {16});
  integers.shorts(339, {2});
  integers.data = packed<std::int16_t>({1, 2, 3, 4, -9999, -6});
  const auto whole = read_geotiff(integers.bytes());
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(whole->height_m[5], -6);
  EXPECT_TRUE(std::isnan(whole->height_m[4]));
  Tiff zipped = sound();
  zipped.shorts(259, {8});
  uLongf size = compressBound(24);
  std::string strip(size, '\0');
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(strip.data()), &size,
                     reinterpret_cast<const Bytef*>(zipped.data.data()), 24),
            Z_OK);
  zipped.data = strip.substr(0, size);
  expect_sound(read_geotiff(zipped.bytes()));
}

// 20 x 20 samples in tiles of 16 x 16: the last ones reach beyond the raster.
TEST(GeoTiff, TilesAreRead) {
  Tiff tiled = sound();
  tiled.longs(256, {20});
  tiled.longs(257, {20});
  tiled.tag.erase(278);
  tiled.longs(322, {16});
  tiled.longs(323, {16});
  tiled.data.clear();
  for (int tile = 0; tile < 4; ++tile)
    for (int row = 0; row < 16; ++row)
      for (int column = 0; column < 16; ++column)
        tiled.data += packed({float(100 * (row + tile / 2 * 16) + column + tile % 2 * 16)});
  tiled.longs(324, {8, 8 + 1024, 8 + 2048, 8 + 3072});
  tiled.longs(325, {1024, 1024, 1024, 1024});
  const auto raster = read_geotiff(tiled.bytes());
  ASSERT_TRUE(raster.ok()) << raster.status();
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column)
      EXPECT_EQ(raster->height_m[std::size_t(20 * row + column)], float(100 * row + column));
}

TEST(GeoTiff, RefusalsNameReasonAndRemedy) {
  const auto refused = [](const std::function<void(Tiff&)>& change) {
    Tiff tiff = sound();
    change(tiff);
    return std::string(read_geotiff(tiff.bytes()).status().message());
  };
  EXPECT_EQ(refused([](Tiff&) {}), "");
  EXPECT_THAT(
      refused([](Tiff& t) {
        t.shorts(34735, {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 3857});
      }),
      HasSubstr(
          "EPSG:3857 are not read; convert the file to a UTM zone: gdalwarp -t_srs EPSG:326ZZ"));
  EXPECT_THAT(refused([](Tiff& t) { t.tag.erase(34735); }),
              HasSubstr("does not state the EPSG code"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.doubles(34735, {1, 1, 0, 0});
              }),
              HasSubstr("does not state the EPSG code"));
  EXPECT_THAT(refused([](Tiff& t) { t.tag.erase(33922); }),
              HasSubstr("does not state where its raster lies"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.longs(33550, {30, 30, 0});
              }),
              HasSubstr("does not state where"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.doubles(34264, {26, 15, 0, 5e5, -15, 26, 0, 5e6, 0, 0, 0, 0, 0, 0, 0, 1});
              }),
              HasSubstr("the raster is rotated"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.doubles(33550, {0, 30, 0});
              }),
              HasSubstr("no finite number above 0"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.doubles(33550, {std::nan(""), 30, 0});
              }),
              HasSubstr("no finite number"));
  EXPECT_THAT(refused([](Tiff& t) { t.shorts(277, {3}); }),
              HasSubstr("3 bands; keep the one of heights"));
  EXPECT_THAT(refused([](Tiff& t) { t.shorts(258, {64}), t.shorts(339, {6}); }),
              HasSubstr("gdal_translate -ot Float32"));
  EXPECT_THAT(refused([](Tiff& t) {
                for (const int id : {256, 257, 278})
                  t.longs(static_cast<std::uint16_t>(id), {65536});
              }),
              HasSubstr("a raster of 65536 x 65536 samples"));
  EXPECT_THAT(refused([](Tiff& t) { t.longs(256, {0x80000000U}), t.longs(257, {0x80000000U}); }),
              HasSubstr("no TIFF that can be read"));
  EXPECT_THAT(refused([](Tiff& t) {
                t.shorts(34735, {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32767});
              }),
              HasSubstr("gdal_edit.py -a_srs"));
  EXPECT_THAT(refused([](Tiff& t) { t.longs(257, {1}); }), HasSubstr("a raster of 3 x 1 samples"));
  EXPECT_THAT(refused([](Tiff& t) { t.longs(273, {1U << 20}), t.longs(279, {24}); }),
              HasSubstr("the file is damaged: strip or tile 0"));
  EXPECT_THAT(refused([](Tiff& t) { t.shorts(259, {8}); }), HasSubstr("the file is damaged"));
  EXPECT_THAT(std::string(read_geotiff("").status().message()),
              HasSubstr("no TIFF that can be read"));
  EXPECT_THAT(std::string(read_heights("II*", "maps/a.tif").status().message()),
              HasSubstr("maps/a.tif: the file is no TIFF"));
  EXPECT_THAT(std::string(read_heights("", "a.vrt").status().message()),
              HasSubstr("expected .hgt, .asc, .tif"));
}

// Rationale: a file of 500 bytes may state 4 GB of tiles. Expected: it is refused, and no other
// process takes its memory.
TEST(GeoTiff, HostileSizesEndInTheirOwnProcess) {
  Tiff large = sound();
  large.longs(256, {16384});
  large.longs(257, {16384});
  large.longs(278, {16384});
  EXPECT_THAT(std::string(read_heights(large.bytes(), "a.tif").status().message()),
              AllOf(HasSubstr("a.tif: "), HasSubstr("the file is damaged")));
  large.tag.erase(278);
  large.longs(256, {200});
  large.longs(257, {200});
  large.longs(322, {1U << 16});
  large.longs(323, {1U << 16});
  EXPECT_THAT(std::string(read_heights(large.bytes(), "a.tif").status().message()),
              HasSubstr("a.tif: the file is damaged: its strips or tiles"));
}

// Expected: whatever bytes change, a file is refused in words or read as a whole raster.
TEST(GeoTiff, MutantsAreRefusedOrRead) {
  const std::vector<const char*> words = {"II*", "\xff\xff\xff\xff", "\x01\x00", "\x0c\x00",
                                          "-9999"};
  fuzz::Mutator mutator(3, words, 200);
  int read = 0, refused = 0;
  for (int turn = 0; turn < 20000; ++turn) {
    const auto raster = read_geotiff(mutator.mutate(sound().bytes()));
    if (!raster.ok()) {
      ++refused;
      EXPECT_FALSE(raster.status().message().empty());
      continue;
    }
    ++read;
    EXPECT_EQ(raster->height_m.size(), std::size_t{raster->columns} * raster->rows);
    EXPECT_TRUE(std::isfinite(raster->x0) && std::isfinite(1 / raster->x_step));
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(RasterReply, TravelsWhole) {
  const auto raster = read_geotiff(sound().bytes());
  const std::string bytes = encode_raster(raster);
  expect_sound(decode_raster(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(decode_raster(bytes.substr(0, size)).status().code(), absl::StatusCode::kDataLoss)
        << size;
  EXPECT_EQ(decode_raster(encode_raster(absl::InvalidArgumentError("no"))).status().message(),
            "no");
}

}  // namespace
}  // namespace irsig

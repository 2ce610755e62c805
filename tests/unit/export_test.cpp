// Exported files: read back with other software (xarray on netCDF4), and never left half-written.
#include "view/export.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fake_store_reader.h"
#include "view/atomic_file.h"
#include "view/query_table.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  return out.str();
}

class Export : public ::testing::Test {
 protected:
  Export() : folder_(::testing::TempDir() + "irsig_export_test_" + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
  }
  ~Export() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_),
                                                  std::filesystem::directory_iterator()));
  }
  // Runs a Python script on the exported file; it fails if an assertion in it does.
  [[nodiscard]] int python(const std::string& script, const std::string& file) const {
    std::ofstream(path("check.py")) << script;
    return std::system(("/usr/bin/python3 " + path("check.py") + " " + file + " >&2").c_str());
  }

 private:
  std::string folder_;
};

// More rows than are read at once.
TEST_F(Export, ATableHasTheRowsOfTheQueryInTheirOrder) {
  FakeStoreReader db = fake_database();
  const auto rows = run_query(db, {});
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_GT(rows->size(), 1000U);
  std::ostringstream all, streamed;
  ASSERT_TRUE(write_rows(db, *rows, {.causes = true}, "csv", all).ok());
  ASSERT_TRUE(export_csv(db, {}, streamed).ok());
  EXPECT_TRUE(all.str() == streamed.str());
  for (std::size_t i = 0; i < rows->size(); ++i) EXPECT_EQ((*rows)[i].signature.row, i + 1);
}

TEST_F(Export, NetcdfOpensInXarray) {
  FakeStoreReader db = fake_database();
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("all.nc")).ok());
  EXPECT_EQ(files(), 1U);
  const StoredSignature& s = db.signatures[(10 * 3 + 2) * 2 + 1];  // viewpoint 10, summer, lwir
  std::ostringstream script;
  script.precision(17);
  script << R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
assert d.attrs["Conventions"] == "CF-1.10", d.attrs
assert dict(d.sizes) == {"viewpoint": 191, "season": 3, "time_of_day": 1, "band": 2, "part": 2,
                         "bin": 9, "edge": 2}, d.sizes
assert list(d["season"].values) == ["winter", "spring", "summer"]
assert list(d["band"].values) == ["mwir", "lwir"]
i = d["intensity_w_sr"]
assert i.dims == ("viewpoint", "season", "time_of_day", "band") and i.attrs["units"] == "W sr-1"
assert i.attrs["long_name"] == "intensity"
assert not np.isnan(i.values).any()
assert d["row"].values[10, 2, 0, 1] == )"
         << s.row << "\nassert i.values[10, 2, 0, 1] == " << s.intensity_w_sr
         << "\nassert d['aspect_azimuth_deg'].values[10] == " << s.aspect_azimuth_deg << R"(
lwir = d.sel(band="lwir")
spectrum = lwir["spectral_intensity_w_sr_um"]
assert spectrum.dims == ("viewpoint", "season", "time_of_day", "bin")
assert spectrum.attrs["units"] == "W sr-1 um-1"
band = (spectrum * lwir["in_band_weight_um"]).sum("bin").values
assert np.allclose(band, lwir["intensity_w_sr"].values, rtol=1e-6)
mwir = d.sel(band="mwir")
assert np.isfinite(mwir["lambda_um"].values).sum() == 5 and np.isnan(mwir["lambda_um"].values[5:]).all()
assert np.isnan(mwir["spectral_intensity_w_sr_um"].values[..., 5:]).all()
assert not np.isnan(mwir["spectral_intensity_w_sr_um"].values[..., :5]).any()
bounds = lwir["lambda_bounds_um"].values
assert (bounds[1:, 0] == bounds[:-1, 1]).all() and (bounds.mean(axis=1) == lwir["lambda_um"].values).all()
summer = d.sel(season="summer", time_of_day="01:30:00Z")
assert str(summer["time"].values)[:16] == "2025-06-21T01:30", summer["time"]
assert float(summer["air_temperature_k"]) == 301.5 and float(d.sel(season="winter")["air_temperature_k"].values) == 280.5
assert "wind_speed_m_s" not in d and str(summer["warning"].values) == "odd\nodder"
assert np.allclose(d["part_intensity_w_sr"].sum("part"), i)
c = d["contrast_intensity_w_sr"]
assert c.values.min() < 0 < c.values.max() and c.attrs["units"] == "W sr-1"
assert d["background_radiance_w_m2_sr"].attrs["units"] == "W m-2 sr-1"
cs = lwir["contrast_spectral_intensity_w_sr_um"]
assert cs.attrs["units"] == "W sr-1 um-1"
assert np.allclose((cs * lwir["in_band_weight_um"]).sum("bin"), lwir["contrast_intensity_w_sr"], rtol=1e-5)
assert np.allclose(lwir["spectral_path_transmittance"], 0.8) and np.allclose(d["path_transmittance"], 0.8)
assert d["path_radiance_w_m2_sr_um"].attrs["units"] == "W m-2 sr-1 um-1"
assert d["lambda_um"].attrs["units"] == "um"
for name, v in d.variables.items():
    assert "long_name" in v.attrs and len(v.attrs["long_name"]) > 2, name
)";
  EXPECT_EQ(python(script.str(), path("all.nc")), 0);
}

TEST_F(Export, NetcdfOfAnUnfinishedSweepHasNan) {
  FakeStoreReader db = fake_database();
  std::erase_if(db.signatures, [](const auto& s) { return s.row == 8; });
  db.signatures[0].apparent_temperature_k = 0;
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("part.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
assert np.isnan(d["intensity_w_sr"].values).sum() == 1
assert np.isnan(d["intensity_w_sr"].values[1, 0, 0, 1]) and d["row"].values[1, 0, 0, 1] == -1
assert np.isnan(d["spectral_intensity_w_sr_um"].values[1, 0, 0, 1]).all()
assert np.isnan(d["apparent_temperature_k"].values[0, 0, 0, 0])
)",
                   path("part.nc")),
            0);
}

// One time of day of each season is an axis; a season with several dates has instants.
TEST_F(Export, NetcdfOfSeasonsWithSeveralDates) {
  FakeStoreReader db = fake_database();
  for (auto& s : db.signatures)
    if (s.season == "spring") {
      s.season = "summer";
      s.time_utc = "2025-06-22T01:30:00Z";
    }
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("dates.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
assert d.sizes["season"] == 2 and d.sizes["time_of_day"] == 3, d.sizes
i = d["intensity_w_sr"].sel(band="lwir").isel(viewpoint=0)
assert np.isnan(i.values).sum() == 3
assert not np.isnan(i.sel(season="summer", time_of_day="2025-06-22T01:30:00Z"))
assert np.isnat(d["time"].sel(season="winter", time_of_day="2025-06-22T01:30:00Z").values)
)",
                   path("dates.nc")),
            0);
}

TEST_F(Export, CsvHasTheCausesAndTheFilters) {
  FakeStoreReader db = fake_database();
  ASSERT_TRUE(
      export_file(db, {.query = {.season = "winter", .band = "mwir"}}, "csv", path("w.csv")).ok());
  const std::string text = contents(path("w.csv"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 192);
  EXPECT_THAT(text, HasSubstr("sun_reflected_w_sr"));
}

TEST_F(Export, RefusalsLeaveNothingBehind) {
  FakeStoreReader db = fake_database();
  std::ofstream(path("old.nc")) << "old";
  EXPECT_EQ(
      export_file(db, {.query = {.max_relative_error = 1e-9}}, "netcdf", path("old.nc")).code(),
      absl::StatusCode::kNotFound);
  EXPECT_EQ(export_file(db, {}, "parquet", path("old.nc")).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(
      export_file(db, {.query = {.aspect = SignatureFilter::Direction{0, 20}, .interpolate = true}},
                  "netcdf", path("old.nc"))
          .code(),
      absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(export_file(db, {}, "csv", path("no/such/folder.csv")).code(),
            absl::StatusCode::kInvalidArgument);
  // A store that breaks in the middle of the export.
  db.spectra[db.signatures[700].signature_id].set_lambda_um(0, 1.5);
  EXPECT_EQ(export_file(db, {}, "netcdf", path("old.nc")).code(), absl::StatusCode::kInternal);
  EXPECT_EQ(contents(path("old.nc")), "old");
  EXPECT_EQ(files(), 1U);
}

TEST_F(Export, ReplacesAFileInOneStep) {
  std::ofstream(path("a")) << "old";
  EXPECT_TRUE(replace_file(path("a"), "new").ok());
  EXPECT_EQ(contents(path("a")), "new");
  EXPECT_EQ(
      replace_file(path("a"), [](const std::string&) { return absl::InternalError("broken"); })
          .code(),
      absl::StatusCode::kInternal);
  EXPECT_EQ(contents(path("a")), "new");
  EXPECT_EQ(replace_file(path(""), "x").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(files(), 1U);
}

}  // namespace
}  // namespace irsig

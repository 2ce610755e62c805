// Exported files: read back with other software (xarray on netCDF4), and never left half-written.
#include "view/export/export.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/match.h"
#include "fake_database.h"
#include "view/base/atomic_file.h"
#include "view/query/query_table.h"

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
  FakeDatabase db = fake_database();
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
  FakeDatabase db = fake_database();
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
                         "bin": 9, "edge": 2, "response_point": 2}, d.sizes
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
assert d["lambda_um"].attrs["bounds"] == "lambda_bounds_um"  # and the unit that CF asks for
assert d["lambda_bounds_um"].attrs["units"] == d["lambda_um"].attrs["units"]
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
  FakeDatabase db = fake_database();
  std::erase_if(db.signatures, [](const auto& s) { return s.row == 8; });
  db.signatures[0].source_radiance_temperature_k = 0;
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("part.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
assert np.isnan(d["intensity_w_sr"].values).sum() == 1
assert np.isnan(d["intensity_w_sr"].values[1, 0, 0, 1]) and d["row"].values[1, 0, 0, 1] == -1
assert np.isnan(d["spectral_intensity_w_sr_um"].values[1, 0, 0, 1]).all()
assert np.isnan(d["source_radiance_temperature_k"].values[0, 0, 0, 0])
)",
                   path("part.nc")),
            0);
}

// Once "wind_speed_m_s" was in "s", and a calm not stated.
TEST_F(Export, NetcdfHasUnitsOfEverythingAndZerosThatAreStated) {
  FakeDatabase db = fake_database();
  schema::ResolvedSweep& sweep = db.sweeps["box ship"].resolved;
  sweep.mutable_sweep()->mutable_transport()->set_sun(true);
  std::uint32_t place = 0;
  for (schema::Condition& c : *sweep.mutable_condition()) {
    c.set_season_index(place++);
    schema::Season& season = *sweep.mutable_sweep()->add_season();
    season.set_name(c.season());
    schema::Weather& weather = *c.mutable_weather();
    weather.set_surface_stated(c.season() != "spring");
    weather.set_air_temperature_k(280.5);
    weather.set_pressure_pa(c.season() == "summer" ? 99000 : 101300);
    weather.set_relative_humidity_percent(c.season() == "winter" ? 0 : 70);
    weather.set_visibility_m(c.season() == "winter" ? 0 : 23000);
    if (c.season() == "winter") season.set_wind_speed_m_s(0);
    if (c.season() == "summer") weather.set_wind_speed_m_s(5);
    c.set_sun_irradiance_w_m2(c.season() == "winter" ? 0 : 700);
    c.mutable_surroundings()->set_sea_temperature_k(c.season() == "winter" ? 0 : 285);
  }
  for (StoredSignature& s : db.signatures) {
    s.input_uncertainty_w_sr = 1;
    db.input[s.signature_id] = {{"wind_speed_m_s", {1, 0.1, 0}, {1, 0.1, 0}, {1, 0.1, 0}}};
  }
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("units.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1], decode_times=False)
UNITS = {"_w_m2_sr_um": "W m-2 sr-1 um-1", "_w_sr_um": "W sr-1 um-1", "_w_m2_sr": "W m-2 sr-1", "_w_sr": "W sr-1", "_w_m2": "W m-2",
         "_m2": "m2", "_m_s": "m s-1", "_deg": "degree", "_percent": "percent", "_pa": "Pa", "_um": "um", "_k": "K", "_m": "m"}
NONE = {"row", "samples", "path_transmittance", "spectral_path_transmittance", "backface_fraction", "response", "response_at_point",
        "clutter_skewness", "clutter_skewness_stderr", "clutter_cells", "clutter_modes_fraction", "visible_fraction"}
for name, v in d.variables.items():
    if v.dtype == object:
        assert "units" not in v.attrs, name
        continue
    if name == "time":
        assert v.attrs["units"] == "seconds since 1970-01-01 00:00:00"
        continue
    ending = next((e for e in UNITS if name.endswith(e)), None)
    assert (ending is None) == (name in NONE), f"{name}: a suffix that is not understood"
    assert v.attrs["units"] == (UNITS[ending] if ending else "1"), (name, v.attrs)
assert d["wind_speed_m_s"].attrs["long_name"] == "wind speed"
of = lambda name: d[name].sel(season=["winter", "spring", "summer"]).values[:, 0].tolist()
nan = float("nan")
for name, expected in (("wind_speed_m_s", [0, nan, 5]), ("relative_humidity_percent", [0, 70, 70]), ("pressure_pa", [101300, 101300, 99000]),
                       ("visibility_m", [nan, 23000, 23000]), ("sun_irradiance_w_m2", [0, 700, 700]),
                       ("sea_temperature_k", [0, 285, 285])):
    np.testing.assert_equal(of(name), expected, name)
assert "ground_temperature_k" not in d
)",
                   path("units.nc")),
            0);
}

TEST_F(Export, NetcdfHasTheResponsesOfTheBands) {
  FakeDatabase db = fake_database();
  schema::ResolvedSweep& sweep = db.sweeps["box ship"].resolved;
  for (const auto& [um, value] : {std::pair{3.0, 0.0}, {3.25, 0.5}, {4.5, 1.0}, {5.0, 0.8}}) {
    schema::SpectralPoint& p = *sweep.mutable_sweep()->mutable_band(0)->add_response();
    p.set_lambda_um(um);
    p.set_value(value);
  }
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("response.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
mwir, lwir = d.sel(band="mwir"), d.sel(band="lwir")
np.testing.assert_allclose(mwir["response"].values, [0, 0.6, 0.8, 1, 0.8] + 4 * [np.nan], rtol=1e-12)
assert (lwir["response"].values == 1).all()
assert mwir["response_lambda_um"].values.tolist() == [3, 3.25, 4.5, 5]
assert mwir["response_at_point"].values.tolist() == [0, 0.5, 1, 0.8]
assert lwir["response_lambda_um"].values.tolist()[:2] == [8, 12] and lwir["response_at_point"].values.tolist()[:2] == [1, 1]
# Of a spectrum that is 1 everywhere the weights are the response's integral.
area = np.trapz([0, 0.5, 1, 0.8], [3, 3.25, 4.5, 5])
assert abs(float(mwir["in_band_weight_um"].sum()) - area) < 1e-9, (mwir["in_band_weight_um"].values, area)
comment = d["in_band_weight_um"].attrs["comment"]
assert "is not stored" in comment and "contrast_intensity_w_sr" in comment
)",
                   path("response.nc")),
            0);
}

TEST_F(Export, NetcdfOfSeveralSweepsHasAGroupForEach) {
  FakeDatabase db = fake_database();
  const FakeDatabase other = fake_database();
  db.sweeps["a/b"] = db.sweeps["box ship"];
  for (StoredSignature s : other.signatures) {
    if (s.season != "summer") continue;
    s.sweep = "a/b";
    s.intensity_w_sr *= 2;
    db.signatures.push_back(s);
  }
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("two.nc")).ok());
  ASSERT_TRUE(export_file(db, {.query = {.sweep = "box ship"}}, "netcdf", path("one.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, netCDF4, numpy as np, xarray as xr
path = sys.argv[1]
with netCDF4.Dataset(path) as file:
    assert sorted(file.groups) == ["a_b", "box ship"] and not file.variables and file.Conventions == "CF-1.10"
one = xr.open_dataset(path.replace("two", "one"))
same = xr.open_dataset(path, group="box ship")
xr.testing.assert_identical(one, same)
other = xr.open_dataset(path, group="a_b")
assert other.attrs["title"].endswith("sweep a/b") and other.sizes["season"] == 1
assert np.array_equal(other["intensity_w_sr"].sel(season="summer").values[:, 0], 2 * one["intensity_w_sr"].sel(season="summer").values[:, 0])
)",
                   path("two.nc")),
            0);
}

// Chosen by date: of one season by its dates, of several after the season.
TEST_F(Export, NetcdfIsChosenByDate) {
  FakeDatabase db = fake_database();
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("all.nc")).ok());
  ASSERT_TRUE(export_file(db, {.query = {.season = "summer"}}, "netcdf", path("summer.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
summer = xr.open_dataset(sys.argv[1])
assert summer["intensity_w_sr"].dims == ("viewpoint", "season", "time", "band")
assert "_FillValue" not in summer["time"].encoding, summer["time"].encoding
chosen = summer.sel(season="summer", band="lwir", time="2025-06-21T01:30")
assert chosen["intensity_w_sr"].dims == ("viewpoint",) or chosen.sizes["time"] == 1
assert summer["time_of_day"].values.tolist() == ["01:30:00Z"] and "time_of_day" in summer["intensity_w_sr"].coords
d = xr.open_dataset(sys.argv[1].replace("summer", "all"))
same = d.sel(season="summer", band="lwir").swap_dims(time_of_day="time").sel(time="2025-06-21T01:30")
assert np.array_equal(np.ravel(same["intensity_w_sr"]), np.ravel(chosen["intensity_w_sr"]))
)",
                   path("summer.nc")),
            0);
}

// Times of day that seasons share are an axis; a season with several dates has instants.
TEST_F(Export, NetcdfOfSeasonsWithSeveralDates) {
  FakeDatabase db = fake_database();
  for (auto& s : db.signatures)
    if (s.season == "spring") {
      s.season = "summer";
      s.time_utc = "2025-06-22T01:30:00Z";
    }
  ASSERT_TRUE(export_file(db, {}, "netcdf", path("dates.nc")).ok());
  EXPECT_EQ(python(R"(
import sys, numpy as np, xarray as xr
d = xr.open_dataset(sys.argv[1])
assert d.sizes["season"] == 2 and d.sizes["time"] == 3, d.sizes
assert str(d["time"].values[1])[:19] == "2025-06-22T01:30:00" and (np.diff(d["time"].values) > np.timedelta64(0)).all()
i = d["intensity_w_sr"].sel(band="lwir").isel(viewpoint=0)
assert np.isnan(i.values).sum() == 3
day = np.datetime64("2025-06-22T01:30:00")
assert not np.isnan(i.sel(season="summer", time=day))
assert np.isnan(i.sel(season="winter", time=day)) and np.isnan(d["sun_zenith_deg"].sel(season="winter", time=day))
assert i.sel(time="2025-06-22").sizes["time"] == 1
)",
                   path("dates.nc")),
            0);
}

TEST_F(Export, CsvHasTheCausesAndTheFilters) {
  FakeDatabase db = fake_database();
  ASSERT_TRUE(
      export_file(db, {.query = {.season = "winter", .band = "mwir"}}, "csv", path("w.csv")).ok());
  const std::string text = contents(path("w.csv"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 192);
  EXPECT_THAT(text, HasSubstr("sun_reflected_w_sr"));
}

TEST_F(Export, AnUnknownFormatNamesAllThatThereAre) {
  FakeDatabase db = fake_database();
  const absl::Status said = export_file(db, {}, "hdf", path("a.hdf"));
  EXPECT_TRUE(absl::IsInvalidArgument(said)) << said;
  EXPECT_THAT(std::string(said.message()), HasSubstr("unknown format \"hdf\""));
  ASSERT_FALSE(export_formats().empty());
  for (const ExportFormat& of : export_formats())
    EXPECT_THAT(std::string(said.message()), HasSubstr(std::string(of.name)));
  EXPECT_FALSE(std::filesystem::exists(path("a.hdf")));
}

TEST_F(Export, RefusalsLeaveNothingBehind) {
  FakeDatabase db = fake_database();
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

// A FIFO would block who looks into it, and a file in the place of a device is in everybody's way.
TEST_F(Export, ReplacesNoDeviceAndNoFifo) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", path("null"));
  for (const char* name : {"fifo", "null"}) {
    const absl::Status refused = replace_file(path(name), "new");
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_TRUE(absl::StrContains(refused.message(), "expected the name of a file")) << refused;
  }
  EXPECT_TRUE(std::filesystem::is_fifo(path("fifo")));
  EXPECT_TRUE(std::filesystem::is_symlink(path("null")));
  EXPECT_EQ(files(), 2U);
}

TEST_F(Export, RemovesWhatKilledWritersLeft) {
  for (const char* stays : {"a", "a.partial", "a..partial", "a.b7.partial", "ab.7.partial", "a.7"})
    std::ofstream(path(stays)) << "stays";
  const std::size_t all = files();
  std::ofstream(path("a.7.partial")) << "half";
  std::ofstream(path("a.10366.partial")) << "half";
  remove_left_beside(path("a"));
  EXPECT_EQ(files(), all);
  EXPECT_FALSE(std::filesystem::exists(path("a.7.partial")));
  remove_left_beside(path("no/such/a"));
}

}  // namespace
}  // namespace irsig

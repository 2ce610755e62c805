// Responses, detectors, weights, temperatures.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include "core/fields/temperature_field.h"
#include "jobs/files/detector_file.h"
#include "jobs/files/imager_file.h"
#include "jobs/files/response_file.h"
#include "tests/fuzz/readers.h"
#include "tests/unit/test_folder.h"
#include "view/query/row_weights.h"

namespace irsig::fuzz {
namespace {

// A file of this name, for readers that ask for one.
class OfFile {
 public:
  explicit OfFile(const std::string& name)
      : folder_(std::make_shared<TestFolder>()), path_(folder_->file(name)) {}
  const std::string& put(const std::string& text) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
    return path_;
  }
  std::string beside(const std::string& name) const {
    return std::filesystem::path(path_).parent_path() / name;
  }

 private:
  std::shared_ptr<TestFolder> folder_;
  std::string path_;
};

void expect_response(const std::vector<SpectralPoint>& response) {
  EXPECT_GE(response.size(), 2U);
  for (std::size_t i = 0; i < response.size(); ++i) {
    EXPECT_TRUE(std::isfinite(response[i].value) && response[i].value >= 0);
    EXPECT_TRUE(i == 0 || response[i].lambda_um > response[i - 1].lambda_um);
  }
}

bool accepts_field(const std::string& bytes, const std::string& name) {
  static const FieldMesh square{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 1};
  bool any = false;
  for (const FieldMatch match : {FieldMatch::kIndex, FieldMatch::kCentroid}) {
    const auto field =
        read_temperature_field(bytes, {name, TemperatureUnit::kKelvin, match, 0.3, 1.0}, square);
    if (!field.ok()) {
      refused(field.status(), name, Says::kFile);
      continue;
    }
    any = true;
    EXPECT_EQ(field->unix_s.size(), field->at.size());
    for (std::size_t t = 0; t < field->at.size(); ++t) {
      const FacetTemperatures& at = field->at[t];
      EXPECT_EQ(at.kelvin.size(), square.triangle.size());
      for (std::size_t f = 0; f < at.kelvin.size(); ++f) {
        EXPECT_EQ(std::isnan(at.kelvin[f]), std::isnan(at.error_k[f]));
        if (std::isnan(at.kelvin[f])) continue;
        EXPECT_GE(at.kelvin[f], kColdestFieldK * 0.999F);
        EXPECT_LE(at.kelvin[f], kHottestFieldK * 1.001F);
        EXPECT_GE(at.error_k[f], 0);
      }
      EXPECT_TRUE(at_time(*field, field->unix_s[t]).ok());
    }
  }
  return any;
}

std::vector<std::string> temperature_meshes() {
  const std::string header =
      " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float temperature\nelement face 2\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  std::string binary = "ply\nformat binary_little_endian" + header;
  const auto put = [&](auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float x :
       {0.F, 0.F, 0.F, 300.F, 1.F, 0.F, 0.F, 310.F, 1.F, 1.F, 0.F, 305.F, 0.F, 1.F, 0.F, 300.F})
    put(x);
  for (const int corner : {0, 0}) {
    put(static_cast<unsigned char>(3));
    for (const int c : {0, 1 + corner, 2 + corner}) put(c);
  }
  return {"ply\nformat ascii" + header +
              "0 0 0 300\n1 0 0 310\n1 1 0 305\n0 1 0 300\n3 0 1 2\n"
              "3 0 2 3\n",
          binary};
}

}  // namespace

std::vector<Reader> table_readers() {
  const std::vector<const char*> words = {"nan", "1e999", "-",    ",",    "= ",   "|",
                                          "\"",  "{",     "[",    "]\n[", "-inf", "#",
                                          "\r",  "\t",    "\n\n", "0,",   "1e",   "true"};
  const auto response = [file = OfFile("r.csv")](const std::string& text) {
    const auto read = read_response(file.put(text));
    if (!read.ok()) return refused(read.status(), "");
    expect_response(*read);
    return true;
  };
  const OfFile detector_file("d.toml");
  std::ofstream(detector_file.beside("q.csv"))
      << "wavelength_um,quantum_efficiency\n3,0.85\n4.8,0.85\n5,0.8\n";
  const auto detector = [file = detector_file](const std::string& text) {
    const auto read = read_detector(file.put(text));
    if (!read.ok()) return refused(read.status(), "");  // its response has a file of its own
    if (!read->detector.response.empty()) expect_response(read->detector.response);
    return true;
  };
  const auto imager = [file = OfFile("i.toml")](const std::string& text) {
    const auto read = read_imager(file.put(text));
    if (!read.ok()) return refused(read.status(), "");
    EXPECT_TRUE(read->imager.ifov_rad() > 0 && std::isfinite(read->imager.ifov_rad()));
    return true;
  };
  const auto weights = [file = OfFile("w.csv")](const std::string& text) {
    const auto read = read_row_weights(file.put(text));
    if (!read.ok()) return refused(read.status(), "");
    EXPECT_FALSE(read->line.empty());
    for (const RowWeights::Line& line : read->line)
      EXPECT_TRUE(std::isfinite(line.weight) && line.weight >= 0);
    return true;
  };
  const std::vector<const char*> field_words = {
      "nan",   "1e999",  "-1",  ",",       "4294967295", "\r\n",  "#",
      "inf",   "2\n",    "end", "element", "property",   "list",  "float",
      "uchar", "vertex", "x",   "time",    "error",      "1e-300"};
  const auto field = [](const char* name) {
    return [name](const std::string& bytes) { return accepts_field(bytes, name); };
  };
  return {
      {"response", {"wavelength_um,response\n3,0\n3.5,0.9\n4.8,1\n5,0\n"}, words, response},
      {"detector",
       {"name = \"InSb\"\nresponse_file = \"q.csv\"\n[noise]\nkind = \"background\"\n"
        "aperture_m = 0.05\nf_number = 2\ntransmittance = 0.8\npixel_m = 15e-6\n"
        "integration_s = 0.005\nwell_electrons = 7e6\nread_electrons = 300\n",
        "name = \"InSb\"\n[noise]\nkind = \"nei\"\nnei_w_m2 = 1e-9\n"},
       words,
       detector},
      {"imager",
       {"name = \"MWIR\"\n[optics]\naperture_m = 0.05\nf_number = 2\njitter_rad = 2e-5\n"
        "[detector]\npitch_m = 15e-6\nnetd_k = 0.025\nseed = 7\n"
        "[counts]\nbits = 14\nblack_k = 260\nwhite_k = 340\n"},
       words,
       imager},
      {"weights",
       {"aspect_azimuth_deg,aspect_elevation_deg,weight\n0,0,1\n90,0,0.5\n180,45,2\n270,-10,0\n",
        "season,time_utc,range_m,weight\nsummer,2025-06-21T12:00:00Z,5000,1\n"
        "winter,2025-12-21T12:00:00Z,5000,0.25\n"},
       words,
       weights},
      {"temperature_csv",
       {"# of a camera\nfacet,x,y,z,temperature,error,time\n"
        "0,0.67,0.33,0,300,0.5,2025-06-21T12:00:00Z\n1,0.33,0.67,0,301.5,1,2025-06-21T12:00:00Z\n"
        "0,0.67,0.33,0,302,0.5,2025-06-21T13:00:00Z\n"
        "1,0.33,0.67,0,303.5,1,2025-06-21T13:00:00Z\n"},
       field_words,
       field("t.csv"),
       2000,
       200},
      {"temperature_ply", temperature_meshes(), field_words, field("t.ply"), 4000, 200}};
}

}  // namespace irsig::fuzz

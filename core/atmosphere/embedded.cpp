#include "core/atmosphere/embedded.h"

#include <charconv>

#include "core/base/check.h"

namespace irsig {
namespace {
constexpr char kGasTable[] =
#include "atmosphere/gas_table.txt.inc"
    ;
constexpr char kAfglProfiles[] =
#include "atmosphere/afgl1986.csv.inc"
    ;
constexpr char kAerosolOptics[] =
#include "atmosphere/aerosol_optics.csv.inc"
    ;
constexpr char kAerosolHeights[] =
#include "atmosphere/aerosol_heights.csv.inc"
    ;
constexpr char kAerosolNavy[] =
#include "atmosphere/aerosol_navy.csv.inc"
    ;
constexpr char kCloudOptics[] =
#include "atmosphere/cloud_optics.csv.inc"
    ;
}  // namespace

std::string_view embedded_gas_table() { return {kGasTable, sizeof kGasTable - 1}; }
std::string_view embedded_afgl_profiles() { return {kAfglProfiles, sizeof kAfglProfiles - 1}; }
std::string_view embedded_aerosol_optics() { return {kAerosolOptics, sizeof kAerosolOptics - 1}; }
std::string_view embedded_aerosol_heights() {
  return {kAerosolHeights, sizeof kAerosolHeights - 1};
}
std::string_view embedded_aerosol_navy() { return {kAerosolNavy, sizeof kAerosolNavy - 1}; }
std::string_view embedded_cloud_optics() { return {kCloudOptics, sizeof kCloudOptics - 1}; }

double number(std::string_view field) {
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  IRSIG_CHECK(error == std::errc());
  IRSIG_CHECK(end == field.data() + field.size());
  return value;
}

std::vector<std::vector<std::string_view>> csv_rows(std::string_view text) {
  std::vector<std::vector<std::string_view>> rows;
  bool header = true;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    if (header) {
      header = false;
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
      comma = line.find(',');
      row.push_back(line.substr(0, comma));
      if (comma != std::string_view::npos) line.remove_prefix(comma + 1);
    }
  }
  return rows;
}

std::string_view take_word(std::string_view& text) {
  const std::size_t start = text.find_first_not_of(" \n");
  if (start == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(start);
  const std::string_view word = text.substr(0, text.find_first_of(" \n"));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace irsig

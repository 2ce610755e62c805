#include "view/base/quantity.h"

#include <algorithm>
#include <array>

namespace irsig {
namespace {

struct Suffix {
  std::string_view suffix, unit, cf_unit;
};

// The glossary's suffixes, each before any that it ends with.
constexpr std::array kSuffixes = std::to_array<Suffix>({
    {"_w_m2_sr_um", "W/(m2 sr um)", "W m-2 sr-1 um-1"},
    {"_w_m2_sr", "W/(m2 sr)", "W m-2 sr-1"},
    {"_w_m2_um", "W/(m2 um)", "W m-2 um-1"},
    {"_w_m2", "W/m2", "W m-2"},
    {"_w_m_k", "W/(m K)", "W m-1 K-1"},
    {"_j_kg_k", "J/(kg K)", "J kg-1 K-1"},
    {"_kg_m3", "kg/m3", "kg m-3"},
    {"_w_sr_um", "W/(sr um)", "W sr-1 um-1"},
    {"_w_sr", "W/sr", "W sr-1"},
    {"_bytes", "bytes", "byte"},
    {"_percent", "%", "percent"},
    {"_deg", "deg", "degree"},
    {"_rad", "rad", "radian"},
    {"_um", "um", "um"},
    {"_m2", "m2", "m2"},
    {"_m_s", "m/s", "m s-1"},
    {"_pa", "Pa", "Pa"},
    {"_px", "px", "1"},
    {"_k", "K", "K"},
    {"_m", "m", "m"},
    {"_s", "s", "s"},
});

}  // namespace

Quantity quantity_of(std::string_view identifier) {
  Quantity out{std::string(identifier), "", "1"};
  for (const Suffix& s : kSuffixes) {
    if (identifier.size() > s.suffix.size() && identifier.ends_with(s.suffix)) {
      out = {std::string(identifier.substr(0, identifier.size() - s.suffix.size())),
             std::string(s.unit), std::string(s.cf_unit)};
      break;
    }
  }
  std::replace(out.noun.begin(), out.noun.end(), '_', ' ');
  return out;
}

}  // namespace irsig

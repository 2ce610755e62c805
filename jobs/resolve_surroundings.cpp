#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "jobs/files/season_surroundings.h"
#include "jobs/resolve.h"

namespace irsig {
namespace {

using schema::Surroundings;

// Context that decides which keys of a table apply: its kind, and the air above it.
struct Role {
  std::string kind;
  bool atmosphere;
  bool grey_sea;  // with the atmosphere
  bool heat;
};

void check_keys_under_atmosphere(const SectionCheck& check, const Role& role) {
  const auto only = [&](SectionCheck::Names names, const char* why) {
    if (role.heat || check.has("solar_albedo")) names.push_back("solar_albedo");
    check.only(names, why);
  };
  if (role.kind == "ground") {
    only({"kind", "ground_temperature_k", "ground_emissivity"},
         "to kind \"ground\" with air.model \"atmosphere\"");
  } else if (role.kind == "sea" && role.grey_sea) {
    only({"kind", "sea_model", "sea_temperature_k", "sea_emissivity"},
         "to kind \"sea\" with air.model \"atmosphere\"");
  } else if (role.kind == "sea") {
    only({"kind", "sea_model", "sea_temperature_k"},
         "to kind \"sea\" with air.model \"atmosphere\" and no sea_model \"grey\"");
  }
  (void)check.one_of("sea_model", {"cox_munk", "flat", "grey"});
  if (check.has("solar_albedo") && !role.heat)
    check.error("solar_albedo", "does not apply without [heat]");
}

// One table as it is written.
void check_surroundings_table(const Surroundings& table, const Role& role, const std::string& path,
                              Findings& findings) {
  const SectionCheck check(table, path, findings);
  const SectionCheck::Names kinds =
      role.atmosphere ? SectionCheck::Names{"sea", "ground"} : SectionCheck::Names{"sea", "none"};
  if (!check.one_of("kind", kinds) && table.has_kind()) return;
  if (role.atmosphere) {
    check_keys_under_atmosphere(check, role);
  } else if (role.kind == "sea") {
    check.only({"kind", "sky_temperature_k", "sky_radiance_w_m2_sr_um", "sea_temperature_k",
                "sea_emissivity"},
               "to kind \"sea\"");
  } else if (role.kind == "none") {
    check.only(
        {"kind", "sky_temperature_k", "sky_radiance_w_m2_sr_um", "lower_radiance_w_m2_sr_um"},
        "to kind \"none\"");
  }
  if (!role.kind.empty() && !role.atmosphere)
    (void)check.at_most_one({"sky_temperature_k", "sky_radiance_w_m2_sr_um"});
}

using Missing = std::vector<std::pair<const char*, const char*>>;

Missing missing_under_atmosphere(const Surroundings& complete, bool heat) {
  Missing missing;
  if (!complete.has_kind()) missing.emplace_back("kind", "expected \"sea\" or \"ground\"");
  if (complete.kind() == "sea") {
    if (!complete.has_sea_temperature_k())
      missing.emplace_back("sea_temperature_k", "expected the sea's temperature");
    if (complete.sea_model() == "grey" && !complete.has_sea_emissivity())
      missing.emplace_back("sea_emissivity", "expected the grey sea's emissivity, 0 to 1");
  } else if (complete.kind() == "ground") {
    if (!complete.has_ground_temperature_k())
      missing.emplace_back("ground_temperature_k", "expected the ground's temperature");
    if (!complete.has_ground_emissivity())
      missing.emplace_back("ground_emissivity", "expected the ground's emissivity, 0 to 1");
    if (heat && !complete.has_solar_albedo())
      missing.emplace_back("solar_albedo",
                           "expected how much sunlight the ground reflects, 0 to 1: temperatures "
                           "are computed");
  }
  return missing;
}

// Returns the keys that the complete surroundings of one season lack, as "key, expected value".
Missing missing_from(const Surroundings& complete, bool atmosphere, bool heat) {
  if (atmosphere) return missing_under_atmosphere(complete, heat);
  Missing missing;
  if (!complete.has_kind()) {
    missing.emplace_back("kind", "expected \"sea\" or \"none\"");
  } else if (complete.kind() == "sea") {
    if (!states_sky(complete)) {
      missing.emplace_back("sky_temperature_k",
                           "expected sky_temperature_k or sky_radiance_w_m2_sr_um");
    }
    if (!complete.has_sea_temperature_k())
      missing.emplace_back("sea_temperature_k", "expected the sea's temperature");
    if (!complete.has_sea_emissivity())
      missing.emplace_back("sea_emissivity", "expected the sea's emissivity, 0 to 1");
  } else if (complete.kind() == "none") {
    if (!states_sky(complete)) {
      missing.emplace_back("sky_radiance_w_m2_sr_um",
                           "expected the radiance from above (0 if there is none), or "
                           "sky_temperature_k");
    }
    if (!complete.has_lower_radiance_w_m2_sr_um()) {
      missing.emplace_back("lower_radiance_w_m2_sr_um",
                           "expected the radiance from below (0 if there is none)");
    }
  }
  return missing;
}

}  // namespace

void check_complete_surroundings(const schema::Sweep& sweep, const Surroundings& complete,
                                 const std::string& path, Findings& findings) {
  const bool atmosphere = sweep.air().model() == "atmosphere";
  check_surroundings_table(complete,
                           {.kind = complete.kind(),
                            .atmosphere = atmosphere,
                            .grey_sea = complete.sea_model() == "grey",
                            .heat = sweep.has_heat()},
                           path, findings);
  for (const auto& [key, expected] : missing_from(complete, atmosphere, sweep.has_heat()))
    findings.add(absl::StrCat(path, ".", key),
                 absl::StrCat(path, ".", key, " is missing, ", expected));
}

std::vector<Surroundings> resolve_surroundings(const schema::Sweep& sweep, Findings& findings) {
  const Surroundings& base = sweep.surroundings();
  const bool atmosphere = sweep.air().model() == "atmosphere";
  std::vector<Surroundings> complete;
  for (int i = 0; i < sweep.season_size(); ++i) {
    const Surroundings& season = sweep.season(i).surroundings();
    complete.push_back(overridden(base, season));
    if (sweep.season(i).has_surroundings()) {
      check_surroundings_table(season,
                               {.kind = complete.back().kind(),
                                .atmosphere = atmosphere,
                                .grey_sea = complete.back().sea_model() == "grey",
                                .heat = sweep.has_heat()},
                               absl::StrCat("season[", i, "].surroundings"), findings);
    }
    if (atmosphere && complete.back().kind() == "sea" && !complete.back().has_sea_model())
      complete.back().set_sea_model("cox_munk");
    // Albedo of a sea under a high sun, the sky's light included [payne1972].
    if (atmosphere && sweep.has_heat() && complete.back().kind() == "sea" &&
        !complete.back().has_solar_albedo())
      complete.back().set_solar_albedo(0.06);
  }
  if (sweep.has_surroundings()) {
    const bool grey_sea = base.sea_model() == "grey" ||
                          std::any_of(complete.begin(), complete.end(), [](const Surroundings& s) {
                            return s.sea_model() == "grey";
                          });
    check_surroundings_table(base,
                             {.kind = base.kind(),
                              .atmosphere = atmosphere,
                              .grey_sea = grey_sea,
                              .heat = sweep.has_heat()},
                             "surroundings", findings);
  }

  // Paths are traced once for all seasons, and whether there is a sea decides where they end.
  for (std::size_t i = 1; i < complete.size(); ++i) {
    if (!complete[i].has_kind() || !complete[0].has_kind() ||
        complete[i].kind() == complete[0].kind())
      continue;
    findings.add(absl::StrCat("season[", i, "].surroundings.kind"),
                 absl::StrCat("season[", i, "].surroundings.kind = \"", complete[i].kind(),
                              "\" but season[0] has \"", complete[0].kind(),
                              "\", expected one kind in all seasons of a sweep"));
  }

  // A key that no season has is missing from the sweep's own table; the error is reported once.
  Surroundings any = base;
  for (const Surroundings& s : complete) any.MergeFrom(s);
  std::vector<std::string> said;
  if (!sweep.has_surroundings() && !any.has_kind()) {
    findings.add("surroundings",
                 absl::StrCat("[surroundings] is missing, expected kind = \"sea\"",
                              sweep.has_air() ? "" : ", \"ground\"", " or \"",
                              atmosphere ? "ground" : "none", "\" and what belongs to it"));
    return complete;
  }
  for (const auto& [key, expected] : missing_from(any, atmosphere, sweep.has_heat())) {
    const std::string path = absl::StrCat("surroundings.", key);
    findings.add(path, absl::StrCat(path, " is missing, ", expected));
    said.emplace_back(key);
  }
  for (std::size_t i = 0; i < complete.size(); ++i) {
    for (const auto& [key, expected] : missing_from(complete[i], atmosphere, sweep.has_heat())) {
      if (std::find(said.begin(), said.end(), key) != said.end()) continue;
      const std::string path = absl::StrCat("season[", i, "].surroundings.", key);
      findings.add(path,
                   absl::StrCat(path, " is missing (and surroundings.", key, " too), ", expected));
    }
  }
  return complete;
}

}  // namespace irsig

#include "schema/store/check/ingest_ledger.h"

#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

absl::Status wrong_ledger(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("result: ", path, " ", what));
}

absl::StatusOr<std::map<std::string, std::int64_t>> numbers_of_names(Database& database,
                                                                     const char* statement) {
  std::map<std::string, std::int64_t> out;
  ASSIGN_OR_RETURN(Rows row, database.query(statement));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    std::string name = row.text();
    out.emplace(std::move(name), row.integer());
  }
}

absl::Status check_entry(const schema::EffectEntry& entry, const LedgerNames& names,
                         const std::string& path) {
  if (!names.effect.contains(entry.effect()))
    return wrong_ledger(path, absl::StrCat("names an unknown effect: \"", entry.effect(), "\""));
  const std::string of = absl::StrCat(path, " (", entry.effect(), ")");
  if (!names.reason.contains(entry.reason()))
    return wrong_ledger(of, absl::StrCat("has an unknown reason: \"", entry.reason(), "\""));
  if (entry.state() < schema::EFFECT_STATE_ON || entry.state() > schema::EFFECT_STATE_ABSENT)
    return wrong_ledger(of, "has no state");
  const bool bounded =
      entry.has_bound_w_sr() && entry.has_apparent_bound_w_sr() && entry.has_contrast_bound_w_sr();
  if (entry.state() == schema::EFFECT_STATE_OFF && !bounded && entry.reason() != "forced" &&
      !names.bounded_with.contains(entry.effect()))
    return wrong_ledger(of, "is off without a bound");
  return absl::OkStatus();
}

std::optional<double> if_known(bool known, double value) {
  return known ? std::optional(value) : std::nullopt;
}

}  // namespace

absl::StatusOr<LedgerNames> ledger_names(Database& database) {
  ASSIGN_OR_RETURN(auto effect, numbers_of_names(database, sql::known_effects));
  ASSIGN_OR_RETURN(auto reason, numbers_of_names(database, sql::known_effect_reasons));
  ASSIGN_OR_RETURN(auto bounded_with, numbers_of_names(database, sql::effects_without_own_bound));
  ASSIGN_OR_RETURN(auto of_hot_gas, numbers_of_names(database, sql::effects_of_hot_gas));
  ASSIGN_OR_RETURN(auto of_cloud, numbers_of_names(database, sql::effects_of_cloud));
  return LedgerNames{std::move(effect), std::move(reason), std::move(bounded_with),
                     std::move(of_hot_gas), std::move(of_cloud)};
}

absl::Status check_ledger(const schema::SignatureRow& row, const LedgerNames& names,
                          const std::string& path) {
  std::set<std::string> seen;
  for (int i = 0; i < row.effect_size(); ++i) {
    const std::string at = absl::StrCat(path, ".effect[", i, "]");
    IRSIG_STORE_TRY(check_entry(row.effect(i), names, at));
    if (!seen.insert(row.effect(i).effect()).second)
      return wrong_ledger(at, absl::StrCat("is there twice: ", row.effect(i).effect()));
  }
  for (const auto& [name, number] : names.effect) {
    if (names.of_cloud.contains(name)) continue;
    const bool expected = row.has_plume_w_sr() || !names.of_hot_gas.contains(name);
    if (expected && !seen.contains(name))
      return wrong_ledger(path + ".effect", absl::StrCat("lacks ", name));
    if (!expected && seen.contains(name))
      return wrong_ledger(path + ".effect",
                          absl::StrCat("has ", name, ", but the row has no hot gas"));
  }
  if (!row.has_energy()) {
    if (row.projected_area_m2().value() == 0) return absl::OkStatus();
    return wrong_ledger(path + ".energy", "is missing");
  }
  const schema::EnergyLedger& energy = row.energy();
  if (!energy.has_absorbed() || !energy.has_escaped_to_sky() || !energy.has_escaped_to_surface() ||
      !energy.has_cut_off() || !energy.has_balance())
    return wrong_ledger(path + ".energy", "is incomplete");
  return absl::OkStatus();
}

absl::Status insert_ledger(Database& database, const LedgerNames& names, std::int64_t signature_id,
                           const schema::SignatureRow& row) {
  for (const schema::EffectEntry& e : row.effect()) {
    IRSIG_STORE_TRY(database.run(
        sql::insert_ledger_entry, signature_id, names.effect.at(e.effect()),
        static_cast<int>(e.state()), names.reason.at(e.reason()),
        if_known(e.has_bound_w_sr(), e.bound_w_sr()),
        if_known(e.has_apparent_bound_w_sr(), e.apparent_bound_w_sr()),
        if_known(e.has_contrast_bound_w_sr(), e.contrast_bound_w_sr()),
        if_known(e.has_fraction_w_sr(), e.fraction_w_sr()), if_known(e.has_time_s(), e.time_s())));
  }
  if (!row.has_energy()) return absl::OkStatus();
  const schema::EnergyLedger& e = row.energy();
  return database.run(sql::insert_energy, signature_id, e.absorbed().value(), e.absorbed().stderr(),
                      e.escaped_to_sky().value(), e.escaped_to_sky().stderr(),
                      e.escaped_to_surface().value(), e.escaped_to_surface().stderr(),
                      e.cut_off().value(), e.cut_off().stderr(), e.balance().value(),
                      e.balance().stderr());
}

}  // namespace irsig

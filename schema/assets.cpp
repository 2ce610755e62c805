#include "schema/assets.h"

namespace irsig {

std::set<std::string> needed_assets(const schema::ResolvedSweep& sweep) {
  std::set<std::string> out;
  if (!sweep.model_sha256().empty()) out.insert(sweep.model_sha256());
  for (const schema::Condition& condition : sweep.condition())
    if (condition.has_temperature_field() && !condition.temperature_field().has_heat())
      out.insert(condition.temperature_field().sha256());
  for (const schema::ConditionPlume& plume : sweep.plume())
    if (!plume.sha256().empty()) out.insert(plume.sha256());
  const schema::LandFiles& land = sweep.land();
  for (const std::string* sha256 : {&land.heights().sha256(), &land.inset().sha256()})
    if (!sha256->empty()) out.insert(*sha256);
  for (const schema::LandFile& file : land.fraction())
    if (!file.sha256().empty()) out.insert(file.sha256());
  for (const schema::LandObjectFiles& object : land.object())
    for (const std::string* sha256 : {&object.model().sha256(), &object.places().sha256()})
      if (!sha256->empty()) out.insert(*sha256);
  return out;
}

std::string_view asset(const Assets& assets, const std::string& sha256) {
  const auto at = assets.find(sha256);
  return at == assets.end() ? std::string_view() : std::string_view(at->second);
}

Assets model_alone(const schema::ResolvedSweep& sweep, std::string_view bytes) {
  if (sweep.model_sha256().empty()) return {};
  return {{sweep.model_sha256(), std::string(bytes)}};
}

std::size_t bytes_of(const Assets& assets) {
  std::size_t sum = 0;
  for (const auto& [sha256, bytes] : assets) sum += bytes.size();
  return sum;
}

}  // namespace irsig

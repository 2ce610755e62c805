#include "schema/heat_run.h"

#include <algorithm>

namespace irsig {
namespace {

bool any_zero(const google::protobuf::RepeatedField<double>& kelvin) {
  return std::find(kelvin.begin(), kelvin.end(), 0.0) != kelvin.end();
}

}  // namespace

bool computes_parts(const schema::HeatRun& run) { return any_zero(run.part_temperature_k()); }

bool computes_land(const schema::HeatRun& run) {
  return run.input_size() == 0 && any_zero(run.land_temperature_k());
}

bool changes_land(const schema::HeatRun& run) {
  return run.input_size() > 0 && any_zero(run.land_temperature_k());
}

}  // namespace irsig

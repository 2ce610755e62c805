#pragma once

#include "core/geo/sun.h"
#include "schema/job.pb.h"

namespace irsig {

// Has part 0 of a condition's temperatures computed, in the weather of one constant, clear day,
// above a ground, whatever the sweep's own air and surroundings are.
inline void compute_temperatures(schema::ResolvedSweep& sweep, int condition_index, double air_k) {
  schema::Sweep& of = *sweep.mutable_sweep();
  for (schema::Material& material : *of.mutable_material()) material.set_solar_absorptance(0.7);
  of.mutable_place()->set_latitude_deg(40);
  of.mutable_place()->set_longitude_deg(0);
  of.mutable_place()->set_heading_deg(0);
  of.mutable_heat()->set_step_minutes(60);
  of.mutable_heat()->set_tolerance_k(0.01);
  of.mutable_heat()->set_rays(64);
  if (of.build_up().empty()) {
    schema::BuildUp& wall = *of.add_build_up();
    wall.set_name("plate");
    wall.set_inside("adiabatic");
    schema::Layer& steel = *wall.add_layer();
    steel.set_thickness_m(0.01);
    steel.set_conductivity_w_m_k(50);
    steel.set_density_kg_m3(7800);
    steel.set_specific_heat_j_kg_k(450);
    of.mutable_part(0)->set_build_up("plate");
  }
  schema::Condition& condition = *sweep.mutable_condition(condition_index);
  condition.set_part_temperature_k(0, 0);
  schema::ConditionField& from = *condition.mutable_temperature_field();
  from.set_heat(static_cast<std::uint32_t>(sweep.heat_size()));
  from.add_part(0);
  schema::HeatRun& run = *sweep.add_heat();
  run.set_season(condition.season());
  run.add_time_utc(condition.time_utc());
  *run.mutable_part_temperature_k() = condition.part_temperature_k();
  run.mutable_weather()->set_profile("midlatitude_summer");
  run.mutable_weather()->set_aerosol("none");
  run.mutable_surroundings()->set_kind("ground");
  run.mutable_surroundings()->set_ground_temperature_k(air_k);
  run.mutable_surroundings()->set_ground_emissivity(0.95);
  run.mutable_surroundings()->set_solar_albedo(0.2);
  run.mutable_course()->set_periodic(true);
  for (const double hour : {-12.0, 12.0}) {
    schema::WeatherRecord& record = *run.mutable_course()->add_record();
    record.set_unix_s(unix_seconds(*parse_rfc3339(condition.time_utc())) + 3600 * hour);
    record.set_air_temperature_k(air_k);
    record.set_dew_point_k(air_k - 10);
    record.set_pressure_pa(101300);
    record.set_wind_speed_m_s(3);
  }
}

}  // namespace irsig

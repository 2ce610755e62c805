#include "messages/inputs/moved_sweep.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "absl/strings/match.h"
#include "core/base/hottest.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/sky_of_air.h"
#include "messages/environment/weather_from_message.h"
#include "messages/inputs/moves.h"

namespace irsig {
namespace {

// Limits of moved values.
constexpr double kColdestK = 1;
constexpr double kColdestAirK = 180, kHottestAirK = 340;  // outdoors
constexpr double kDriestK = 120;                          // dew point
constexpr double kColdestSurfaceK = 100, kHottestSurfaceK = 400;
constexpr double kMostWindMS = 20, kMostWindOfWallsMS = 100;  // sea and aerosol; walls
constexpr double kLeastVisibilityM = 100, kMostVisibilityM = 100e3;
constexpr double kMostConductivity = 1e12;
constexpr double kLeastStomatalSM = 10, kMostStomatalSM = 1e4;

// Humidity of air with a dew point, which cannot be above the air's own temperature.
double percent_of(double dew_point_k, double air_k) {
  return std::min(100.0, 100 * vapour_pressure_pa(dew_point_k) / vapour_pressure_pa(air_k));
}
double dew_point_of(const schema::Weather& w) {
  constexpr double kLeastPercent = 1e-3;  // dry air has none
  return dew_point_k(std::max(w.relative_humidity_percent(), kLeastPercent) / 100 *
                     vapour_pressure_pa(w.air_temperature_k()));
}

void move_air(Mover& mover, schema::Weather& w) {
  if (!w.surface_stated()) return;
  const double dew_k = dew_point_of(w),
               air_k = mover.moved(w.air_temperature_k(), kColdestAirK, kHottestAirK);
  w.set_air_temperature_k(air_k);
  w.set_relative_humidity_percent(percent_of(dew_k, air_k));
}
void move_air(Mover& mover, schema::WeatherRecord& r) {
  const double air_k = mover.moved(r.air_temperature_k(), kColdestAirK, kHottestAirK);
  if (r.has_sky_w_m2())
    r.set_sky_w_m2(sky_of_other_air_w_m2(r.sky_w_m2(), r.air_temperature_k(), air_k));
  r.set_air_temperature_k(air_k);
  r.set_dew_point_k(std::min(r.dew_point_k(), air_k));
}

void move_dew_point(Mover& mover, schema::Weather& w) {
  if (!w.surface_stated()) return;
  const double air_k = w.air_temperature_k();
  w.set_relative_humidity_percent(percent_of(mover.moved(dew_point_of(w), kDriestK, air_k), air_k));
}

bool asks_for_wind(const schema::Weather& w, const schema::Surroundings& s) {
  return is_rough_sea(s) || absl::StartsWith(w.aerosol(), "navy");
}

void move_visibility(Mover& mover, schema::Weather& w) {
  if (w.visibility_m() > 0)
    w.set_visibility_m(mover.moved(w.visibility_m(), kLeastVisibilityM, kMostVisibilityM));
}

// A model of the sky asks for it only where the weather does not state its radiation.
void move_cloud(Mover& mover, schema::WeatherRecord& r) {
  if (!r.has_direct_normal_w_m2() || !r.has_diffuse_horizontal_w_m2() || !r.has_sky_w_m2())
    r.set_cloud_cover(mover.moved(r.cloud_cover(), 0, 1));
}

// Conditions have a layer where they have a cover, or where their cover may be moved.
void move_cloud(Mover& mover, schema::Weather& w) {
  if (w.has_cloud()) w.set_cloud_cover(mover.moved(w.cloud_cover(), 0, 1));
}

bool states_sky(const schema::WeatherCourse& course) {
  return std::all_of(course.record().begin(), course.record().end(),
                     [](const schema::WeatherRecord& r) { return r.has_sky_w_m2(); });
}

constexpr double kHighestBaseM = 20e3, kMostWaterGM2 = 1e6;
void move_cloud_base(Mover& mover, schema::Weather& w) {
  if (!w.has_cloud()) return;
  schema::CloudLayer& layer = *w.mutable_cloud();
  const double base_m = mover.moved(layer.base_m(), 0, kHighestBaseM);
  layer.set_top_m(layer.top_m() + base_m - layer.base_m());
  layer.set_base_m(base_m);
  // Its temperature stays that of risen air, at another height.
  layer.set_base_of_risen_air(layer.base_from_weather() || layer.base_of_risen_air());
  layer.set_base_from_weather(false);
}

class SweepMover {
 public:
  SweepMover(const schema::ResolvedSweep& sweep, const UncertainInput& input, double move)
      : sweep_(sweep), mover_(input.sigma * move, absl::EndsWith(input.name, "_relative")) {}

  MovedSweep run(const std::string& input) {
    if (input == "air_temperature_k") {
      for (schema::Condition& c : *sweep_.mutable_condition()) {
        if (c.has_weather()) {
          move_air(mover_, *c.mutable_weather());
          c.set_air_temperature_k(c.weather().air_temperature_k());
        } else if (c.air_temperature_k() > 0) {
          c.set_air_temperature_k(mover_.moved(c.air_temperature_k(), kColdestK, kHottestK));
        }
      }
      of_runs([&](schema::HeatRun& run) { move_air(mover_, *run.mutable_weather()); },
              [&](schema::WeatherRecord& r) { move_air(mover_, r); });
    } else if (input == "dew_point_k") {
      of_weathers([&](schema::Weather& w) { move_dew_point(mover_, w); });
      of_runs({}, [&](schema::WeatherRecord& r) {
        r.set_dew_point_k(mover_.moved(r.dew_point_k(), kDriestK, r.air_temperature_k()));
      });
    } else if (absl::StartsWith(input, "wind_speed_")) {
      for (schema::Condition& c : *sweep_.mutable_condition())
        if (c.has_weather() && asks_for_wind(c.weather(), c.surroundings()))
          c.mutable_weather()->set_wind_speed_m_s(
              mover_.moved(c.weather().wind_speed_m_s(), 0, kMostWindMS));
      of_runs({}, [&](schema::WeatherRecord& r) {
        r.set_wind_speed_m_s(mover_.moved(r.wind_speed_m_s(), 0, kMostWindOfWallsMS));
      });
    } else if (input == "visibility_relative") {
      of_weathers([&](schema::Weather& w) { move_visibility(mover_, w); });
    } else if (input == "cloud_cover") {
      for (schema::Condition& c : *sweep_.mutable_condition())
        if (c.has_weather()) move_cloud(mover_, *c.mutable_weather());
      of_runs({}, [&](schema::WeatherRecord& r) { move_cloud(mover_, r); });
    } else if (input == "cloud_base_m") {
      of_weathers([&](schema::Weather& w) { move_cloud_base(mover_, w); });
    } else if (input == "cloud_water_path_relative") {
      of_weathers([&](schema::Weather& w) {
        if (w.has_cloud())
          w.mutable_cloud()->set_water_path_g_m2(
              mover_.moved(w.cloud().water_path_g_m2(), 0, kMostWaterGM2));
      });
    } else if (input == "part_temperature_k") {
      move_parts();
    } else if (input == "land_temperature_k") {
      for (schema::Condition& c : *sweep_.mutable_condition())
        for (double& k : *c.mutable_land_temperature_k())
          if (k > 0) k = mover_.moved(k, kColdestSurfaceK, kHottestK);
    } else if (absl::StartsWith(input, "land_")) {
      move_land(input.substr(5));
    } else if (input == "sea_temperature_k" || input == "ground_temperature_k" ||
               input == "sky_temperature_k") {
      of_surroundings([&](schema::Surroundings& s) { move_surface(input, s); });
    } else if (input == "convection_relative") {
      of_runs([&](schema::HeatRun& run) { run.set_convection_factor(mover_.moved(1, 0, 10)); }, {});
    } else if (input == "sky_emissivity_relative") {
      of_runs(
          [&](schema::HeatRun& run) {
            if (!states_sky(run.course())) run.set_sky_factor(mover_.moved(1, 0, 10));
          },
          {});
    } else if (input == "conductivity_relative" || input == "inside_temperature_k" ||
               input == "surface_moisture" || input == "stomatal_resistance_relative") {
      move_build_ups(input, input == "conductivity_relative" ? of_parts() : of_parts_and_land());
    } else {
      move_materials(input, of_parts());
    }
    return {std::move(sweep_), mover_.values(), mover_.share(), std::move(without_)};
  }

 private:
  void of_runs(const std::function<void(schema::HeatRun&)>& run,
               const std::function<void(schema::WeatherRecord&)>& record) {
    for (schema::HeatRun& r : *sweep_.mutable_heat()) {
      if (run) run(r);
      if (!record) continue;
      for (schema::WeatherRecord& w : *r.mutable_course()->mutable_record()) record(w);
    }
  }
  void of_weathers(const std::function<void(schema::Weather&)>& weather) {
    for (schema::Condition& c : *sweep_.mutable_condition())
      if (c.has_weather()) weather(*c.mutable_weather());
    for (schema::HeatRun& run : *sweep_.mutable_heat()) weather(*run.mutable_weather());
  }
  void of_surroundings(const std::function<void(schema::Surroundings&)>& of) {
    for (schema::Condition& c : *sweep_.mutable_condition()) of(*c.mutable_surroundings());
    for (schema::HeatRun& run : *sweep_.mutable_heat()) of(*run.mutable_surroundings());
  }

  void move_surface(const std::string& input, schema::Surroundings& s) {
    const auto moved = [&](double k) {
      return mover_.moved(k, kColdestSurfaceK, kHottestSurfaceK);
    };
    if (input == "sea_temperature_k" && s.kind() == "sea" && s.has_sea_temperature_k())
      s.set_sea_temperature_k(moved(s.sea_temperature_k()));
    if (input == "ground_temperature_k" && s.kind() == "ground" && s.has_ground_temperature_k())
      s.set_ground_temperature_k(moved(s.ground_temperature_k()));
    if (input == "sky_temperature_k" && s.has_sky_temperature_k())
      s.set_sky_temperature_k(mover_.moved(s.sky_temperature_k(), 0, kHottestK));
  }

  void move_parts() {
    const auto move = [&](google::protobuf::RepeatedField<double>& kelvin) {
      for (double& k : kelvin)
        if (k > 0) k = mover_.moved(k, kColdestK, kHottestK);
    };
    for (schema::Condition& c : *sweep_.mutable_condition()) {
      move(*c.mutable_part_temperature_k());
      if (!c.has_temperature_field() || c.temperature_field().has_heat()) continue;
      schema::ConditionField& field = *c.mutable_temperature_field();
      field.set_shift_k(mover_.moved(0, -kHottestK, kHottestK));
    }
    for (schema::HeatRun& run : *sweep_.mutable_heat()) move(*run.mutable_part_temperature_k());
  }

  // Names of materials and build-ups.
  struct Used {
    std::set<std::string> material, build_up;
  };
  [[nodiscard]] Used of_parts() const {
    Used out;
    for (const schema::Part& part : sweep_.sweep().part()) {
      out.material.insert(part.material());
      out.build_up.insert(part.build_up());
    }
    return out;
  }
  [[nodiscard]] Used of_land() const {
    Used out;
    for (const schema::LandMaterial& material : sweep_.sweep().land().material()) {
      out.material.insert(material.material());
      if (material.has_build_up()) out.build_up.insert(material.build_up());
    }
    return out;
  }
  [[nodiscard]] Used of_parts_and_land() const {
    Used out = of_parts(), land = of_land();
    out.material.merge(land.material);
    out.build_up.merge(land.build_up);
    return out;
  }

  // One that a part has, too, is moved as that of the part.
  void move_land(const std::string& input) {
    Used used = of_land();
    const Used parts = of_parts();
    for (const std::string& name : parts.material) used.material.erase(name);
    for (const std::string& name : parts.build_up) used.build_up.erase(name);
    if (input == "conductivity_relative")
      move_build_ups(input, used);
    else
      move_materials(input, used);
    without_.clear();
  }

  void move_build_ups(const std::string& input, const Used& used) {
    if (sweep_.heat_size() == 0) return;
    for (schema::BuildUp& b : *sweep_.mutable_sweep()->mutable_build_up()) {
      if (!used.build_up.contains(b.name())) continue;
      if (input == "inside_temperature_k") {
        if (b.has_inside_temperature_k())
          b.set_inside_temperature_k(mover_.moved(b.inside_temperature_k(), kColdestK, kHottestK));
        for (schema::InsideAt& at : *b.mutable_inside_schedule())
          if (at.has_temperature_k())
            at.set_temperature_k(mover_.moved(at.temperature_k(), kColdestK, kHottestK));
      }
      if (input == "surface_moisture" && b.has_surface_moisture())
        b.set_surface_moisture(mover_.moved(b.surface_moisture(), 0, 1));
      if (input == "stomatal_resistance_relative" && b.has_canopy())
        b.mutable_canopy()->set_stomatal_resistance_s_m(
            mover_.moved(b.canopy().stomatal_resistance_s_m(), kLeastStomatalSM, kMostStomatalSM));
      if (input == "conductivity_relative")
        for (schema::Layer& l : *b.mutable_layer())
          l.set_conductivity_w_m_k(mover_.moved(l.conductivity_w_m_k(), 0, kMostConductivity));
    }
  }

  void move_materials(const std::string& input, const Used& used) {
    for (schema::Material& m : *sweep_.mutable_sweep()->mutable_material()) {
      if (!used.material.contains(m.name())) continue;
      if (input == "emissivity") {
        if (!move_emissivity(mover_, m)) without_.push_back(m.name());
      } else if (input == "solar_absorptance" && sweep_.heat_size() > 0 &&
                 m.has_solar_absorptance()) {
        m.set_solar_absorptance(mover_.moved(m.solar_absorptance(), 0, 1));
      }
    }
  }

  schema::ResolvedSweep sweep_;
  Mover mover_;
  std::vector<std::string> without_;
};

bool same(const google::protobuf::Message& a, const google::protobuf::Message& b) {
  return a.SerializeAsString() == b.SerializeAsString();
}

// Returns true if the element of a name has been moved.
template <typename T>
bool differs(const google::protobuf::RepeatedPtrField<T>& a,
             const google::protobuf::RepeatedPtrField<T>& b, const std::string& name) {
  for (int i = 0; i < a.size(); ++i)
    if (a[i].name() == name && !same(a[i], b[i])) return true;
  return false;
}

}  // namespace

std::vector<UncertainInput> uncertain_inputs(const schema::Uncertainty& uncertainty) {
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  uncertainty.GetReflection()->ListFields(uncertainty, &fields);  // by field number
  std::vector<UncertainInput> out;
  for (const google::protobuf::FieldDescriptor* field : fields)
    if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE)
      out.push_back({field->name(), uncertainty.GetReflection()->GetDouble(uncertainty, field)});
  return out;
}

MovedSweep moved_sweep(const schema::ResolvedSweep& sweep, const UncertainInput& input,
                       double move) {
  return SweepMover(sweep, input, move).run(input.name);
}

std::vector<double> moves_of(const schema::ResolvedSweep& sweep, const UncertainInput& input) {
  if (sweep.sweep().uncertainty().sides() == "both") return {1, -1};
  const double up = moved_sweep(sweep, input, 1).share;
  // A change of the size of rounding does not count as a limit.
  constexpr double kRounding = 1e-9;
  if (up >= 1 - kRounding) return {1};
  return {moved_sweep(sweep, input, -1).share > up ? -1.0 : 1.0};
}

bool moves_parts(const schema::ResolvedSweep& sweep, const schema::ResolvedSweep& moved, int run) {
  const schema::Sweep &a = sweep.sweep(), &b = moved.sweep();
  for (const schema::Part& part : a.part())
    if (differs(a.material(), b.material(), part.material()) ||
        differs(a.build_up(), b.build_up(), part.build_up()))
      return true;
  return !same(sweep.heat(run), moved.heat(run));
}

bool moves_land(const schema::ResolvedSweep& sweep, const schema::ResolvedSweep& moved, int run) {
  const schema::Sweep &a = sweep.sweep(), &b = moved.sweep();
  for (const schema::LandMaterial& material : a.land().material())
    if (material.has_build_up() && (differs(a.material(), b.material(), material.material()) ||
                                    differs(a.build_up(), b.build_up(), material.build_up())))
      return true;
  schema::HeatRun before = sweep.heat(run), after = moved.heat(run);
  for (schema::HeatRun* of : {&before, &after}) {  // land does not depend on these
    of->clear_part_temperature_k();
    of->clear_surroundings();
  }
  return !same(before, after);
}

int changes_of_run(const schema::ResolvedSweep& sweep, int run) {
  for (int i = 0; i < sweep.heat_size(); ++i)
    if (sweep.heat(i).input_size() > 0 && static_cast<int>(sweep.heat(i).base()) == run) return i;
  return -1;
}

}  // namespace irsig

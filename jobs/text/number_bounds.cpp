#include "jobs/text/number_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <unordered_map>

#include "absl/strings/str_cat.h"
#include "core/base/hottest.h"
#include "jobs/text/limits.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Reasons that several rows share. Results at the limits of ranges and sizes are compared with
// closed forms in tests/physics/far_view_test.cpp.
constexpr std::string_view kTemperature = "Planck's law is verified there";
constexpr std::string_view kWavelength =
    "where optical constants, the sun and Planck's law are known";
constexpr std::string_view kRange =
    "nearer is inside any target; farther, double precision no longer tells its sides apart";
constexpr std::string_view kFarField = "farther is the far field: leave the key out";
constexpr std::string_view kPlacement = "the size of the largest model";
constexpr std::string_view kSize = "what rays in single precision are tested for";
constexpr std::string_view kFraction = "a part of a whole";
constexpr std::string_view kAzimuth = "one turn to either side";
constexpr std::string_view kElevation = "nadir to zenith";
constexpr std::string_view kRadiance = "far above any surface of 20000 K";
constexpr std::string_view kRoughness = "smoother is a mirror, rougher no surface of facets";
constexpr std::string_view kIndex = "far beyond any measured";
constexpr std::string_view kReplicates = "fewer tell no error, more only cost memory";
constexpr std::string_view kSamples = "numbered in single precision; for more, raise replicates";
constexpr std::string_view kReflections = "deeper paths than that carry nothing";
constexpr std::string_view kZenith = "a grazing direction sees no surface";
constexpr std::string_view kWind =
    "no storm blows harder for ten minutes; the Navy's aerosol ends at 20";
constexpr std::string_view kVisibility = "dense fog to air without particles";
constexpr std::string_view kCloud = "clouds from the ground to the stratosphere";
constexpr std::string_view kHumidity = "dry to saturated, over water";
constexpr std::string_view kStep = "the finest that 64 bits resolve, to the longest wavelength";
constexpr std::string_view kShape = "far beyond any that fits a measured surface";
constexpr std::string_view kWeight = "only the ratios of these numbers count";
constexpr std::string_view kSpectralValue =
    "emissivities and reflectances end at 1; of a response only the ratios count";
constexpr std::string_view kAirOutdoors = "what air outdoors has";
constexpr std::string_view kSigma =
    "smaller is known exactly; of larger ones one step says nothing";
constexpr std::string_view kIndexOfList = "the longest list";
constexpr std::string_view kGasTables = "the tables of hot gas end there";
constexpr std::string_view kAbove = "on sea or ground to the end of the air";
constexpr std::string_view kAboveHere = "lower it stands on sea or ground; the end of the air";
constexpr std::string_view kInstrument = "far beyond any instrument";
constexpr std::string_view kScene = "colder scenes have no light in a band of short waves";
constexpr std::string_view kEpsg = "WGS 84 in degrees or a UTM zone";
constexpr std::string_view kLandTemperature = "snow to hot lava";
constexpr std::string_view kScale = "a model to the mountain that it shows";
constexpr std::string_view kLandRadius = "the corner of a map that ends 400 km from the target";
constexpr std::string_view kLandPlace = "a map ends 400 km from the target";
constexpr std::string_view kSeed = "every whole number of 64 bits";

// The limits of a row stand as they are printed.
constexpr auto kBounds = std::to_array<NumberBounds>({
    {"Sweep.seed", 0, 18446744073709551615.0, kSeed},
    {"Model.triangles", 1, 1e8, "more do not fit into a worker's memory"},
    {"Model.unit_m", 1e-9, 1e6, "nanometres to thousands of kilometres"},
    {"Model.radius_m", 1e-3, 1e5, kSize},
    {"Model.length_m", 1e-3, 1e5, kSize},
    {"Model.width_m", 1e-3, 1e5, kSize},
    {"Model.height_m", 1e-3, 1e5, kSize},
    {"Model.draft_m", 0, 1e6, "a target above the water is raised by offset_m"},
    {"Model.offset_m", -1e6, 1e6, kPlacement},
    {"Model.accepted_backface_fraction", 0, 1, "a share of the silhouette"},
    {"Place.latitude_deg", -90, 90, "pole to pole"},
    {"Place.longitude_deg", -180, 180, "half a turn to either side"},
    {"Place.height_m", -500, 100e3, "the shore of the Dead Sea to the end of the air"},
    {"Place.heading_deg", -360, 360, kAzimuth},
    {"Place.speed_m_s", 0, 50, "faster than any ship"},
    {"Place.above_surface_m", 0, 100e3, kAbove},

    {"Material.emissivity", 0, 1, kFraction},
    {"Material.n", 1e-6, 1e6, kIndex},
    {"Material.k", 0, 1e6, kIndex},
    {"Material.roughness", 1e-4, 1, kRoughness},
    {"Material.normal_emissivity", 0, 0.999999, "at 1 nothing is left to reflect"},
    {"Material.reflectance", 0, 1, kFraction},
    {"Material.diffuse_reflectance", 0, 1, kFraction},
    {"Material.specular_reflectance", 0, 1, kFraction},
    {"Material.volume_reflectance", 0, 1, kFraction},
    {"Material.grazing", 0, 0.999999, "at 1 nothing is emitted towards grazing"},
    {"Material.lobe_width", 1e-4, 1, kRoughness},
    {"Material.bias", 1e-6, 1e6, kShape},
    {"Material.width", 1e-4, 1, kRoughness},
    {"Material.tau_deg", 1e-6, 1e6, kShape},
    {"Material.omega_deg", 1e-6, 1e6, kShape},
    {"Material.gamma_um", 1e-6, 1e6, kShape},
    {"Material.lambda0_um", 1e-6, 1e6, kShape},
    {"Material.solar_absorptance", 0, 1, kFraction},
    {"Material.thermal_emissivity", 0, 1, kFraction},
    {"BrdfTable.lambda_um", 1e-6, 1e9, "tables may reach beyond the bands"},
    {"BrdfTable.theta_i_deg", 0, 89.9999, kZenith},
    {"BrdfTable.theta_r_deg", 0, 89.9999, kZenith},
    {"BrdfTable.phi_deg", 0, 180, "the side of incidence to the mirror's"},
    {"BrdfTable.brdf_per_sr", 0, 1e12, "sharper than any lobe that is measured"},
    {"SpectralPoint.lambda_um", 1e-6, 1e9, "tables may reach beyond the bands"},
    {"SpectralPoint.value", 0, 1e12, kSpectralValue},
    {"OpticalConstant.lambda_um", 1e-6, 1e9, "tables may reach beyond the bands"},
    {"OpticalConstant.n", 1e-6, 1e6, kIndex},
    {"OpticalConstant.k", 0, 1e6, kIndex},

    {"Part.temperature_k", 0, kHottestK, kTemperature},
    {"Season.part_temperature_k", 0, kHottestK, kTemperature},
    {"Season.land_temperature_k", 150, 1500, kLandTemperature},
    {"BuildUp.inside_temperature_k", 100, 5000, "rooms, tanks and machines"},
    {"BuildUp.inside_h_w_m2_k", 0, 1e6, "boiling water"},
    {"BuildUp.inside_heat_flux_w_m2", -1e7, 1e7, "a flame's"},
    {"BuildUp.surface_moisture", 0, 1, "dry to as wet as water"},
    {"Canopy.leaf_area_index", 0.01, 20, "single plants to a closed forest"},
    {"Canopy.stomatal_resistance_s_m", 10, 1e4, "more than any leaf opens to closed stomata"},
    {"InsideAt.temperature_k", 100, 5000, "rooms, tanks and machines"},
    {"InsideAt.heat_flux_w_m2", -1e7, 1e7, "a flame's"},
    {"Layer.thickness_m", 1e-9, 100,
     "a layer without thickness is left out; soil as deep as heat goes in a lifetime"},
    {"Layer.conductivity_w_m_k", 0, 1e12, "0 is insulation"},
    {"Layer.density_kg_m3", 0, 1e9, "0 stores no heat"},
    {"Layer.specific_heat_j_kg_k", 0, 1e9, "0 stores no heat"},
    {"TemperatureField.max_distance_m", 1e-9, 1e6, "the size of targets"},
    {"TemperatureField.error_k", 0, 1000, "nothing is known of a temperature"},
    {"Season.sun_irradiance_w_m2", 0, 1e9, "beyond the sun's surface"},
    {"Season.above_surface_m", 1, 100e3, kAboveHere},
    {"Season.air_temperature_k", 0, kHottestK, kTemperature},
    {"Season.relative_humidity_percent", 0, 1000,
     "above 100 refused with the dew point that it means"},
    {"Season.pressure_pa", 5e4, 1.1e5, "at the surface, mountains included"},
    {"Season.wind_speed_m_s", 0, 100, kWind},
    {"Season.wind_speed_24h_m_s", 0, 20, "the Navy's aerosol ends there"},
    {"Season.visibility_m", 100, 100e3, kVisibility},
    {"Season.cloud_cover", 0, 1, kFraction},
    {"Season.cloud_base_m", 0, 25e3, kCloud},
    {"Season.cloud_water_path_g_m2", 0, 1e6, kCloud},
    {"Cloud.cover", 0, 1, kFraction},
    {"Cloud.cover_oktas", 0, 8, "eighths of the sky"},
    {"Cloud.base_m", 0, 25e3, kCloud},
    {"Cloud.top_m", 1, 25e3, kCloud},
    {"Cloud.water_path_g_m2", 0, 1e6, kCloud},
    {"Cloud.effective_radius_um", 1.5, 153.3, "droplets to 50 um, ice crystals from 6.4 um"},
    {"Season.wind_from_deg", -360, 360, kAzimuth},
    {"Day.air_temperature_min_k", 180, 340, kAirOutdoors},
    {"Day.air_temperature_max_k", 180, 340, kAirOutdoors},
    {"Day.warmest_hour", 0, 24, "hours of a day"},
    {"Day.dew_point_k", 120, 340, kAirOutdoors},
    {"Vary.wind_speed_m_s", 0, 100, kWind},
    {"Vary.visibility_m", 100, 100e3, kVisibility},
    {"Vary.relative_humidity_percent", 0, 100, kHumidity},
    {"Vary.air_temperature_k", 0, kHottestK, kTemperature},
    {"Vary.sea_temperature_k", 0, kHottestK, kTemperature},
    {"Vary.above_surface_m", 1, 100e3, kAboveHere},
    {"Vary.cloud_cover", 0, 1, kFraction},
    {"Vary.cloud_base_m", 0, 25e3, kCloud},
    {"Vary.cloud_water_path_g_m2", 0, 1e6, kCloud},

    {"Uncertainty.air_temperature_k", 1e-3, 50, kSigma},
    {"Uncertainty.dew_point_k", 1e-3, 50, kSigma},
    {"Uncertainty.wind_speed_m_s", 1e-3, 10, kSigma},
    {"Uncertainty.wind_speed_relative", 1e-4, 1, kSigma},
    {"Uncertainty.visibility_relative", 1e-4, 1, kSigma},
    {"Uncertainty.cloud_cover", 1e-4, 1, kSigma},
    {"Uncertainty.cloud_base_m", 1, 5000, kSigma},
    {"Uncertainty.cloud_water_path_relative", 1e-4, 1, kSigma},
    {"Uncertainty.convection_relative", 1e-4, 1, kSigma},
    {"Uncertainty.sky_emissivity_relative", 1e-4, 0.5, kSigma},
    {"Uncertainty.surface_moisture", 1e-4, 1, kSigma},
    {"Uncertainty.stomatal_resistance_relative", 1e-4, 1, kSigma},
    {"Uncertainty.solar_absorptance", 1e-4, 0.5, kSigma},
    {"Uncertainty.emissivity", 1e-4, 0.5, kSigma},
    {"Uncertainty.conductivity_relative", 1e-4, 1, kSigma},
    {"Uncertainty.inside_temperature_k", 1e-3, 500, kSigma},
    {"Uncertainty.part_temperature_k", 1e-3, 500, kSigma},
    {"Uncertainty.sea_temperature_k", 1e-3, 50, kSigma},
    {"Uncertainty.ground_temperature_k", 1e-3, 50, kSigma},
    {"Uncertainty.sky_temperature_k", 1e-3, 100, kSigma},
    {"Uncertainty.land_temperature_k", 1e-3, 50, kSigma},
    {"Uncertainty.land_emissivity", 1e-4, 0.5, kSigma},
    {"Uncertainty.land_solar_absorptance", 1e-4, 0.5, kSigma},
    {"Uncertainty.land_conductivity_relative", 1e-4, 1, kSigma},

    {"Band.lambda_min_um", kShortestUm, kLongestUm, kWavelength},
    {"Band.lambda_max_um", kShortestUm, kLongestUm, kWavelength},
    {"Band.step_um", 1e-9, kLongestUm, kStep},

    {"Viewpoints.range_m", 1e-3, 1e9, kRange},
    {"Viewpoints.ranges_m", 1e-3, 1e9, kRange},
    {"Viewpoints.count", 1, kMostViewpoints, "more do not fit into memory: split the sweep"},
    {"Viewpoints.elevation_min_deg", -90, 90, kElevation},
    {"Viewpoints.elevation_max_deg", -90, 90, kElevation},
    {"Viewpoints.azimuth_deg", -360, 360, kAzimuth},
    {"Viewpoints.elevation_deg", -90, 90, kElevation},
    {"Aspect.azimuth_deg", -360, 360, kAzimuth},
    {"Aspect.elevation_deg", -90, 90, kElevation},
    {"Aspect.range_m", 1e-3, 1e9, kRange},

    {"Surroundings.sky_temperature_k", 0, kHottestK, kTemperature},
    {"Surroundings.sky_radiance_w_m2_sr_um", 0, 1e12, kRadiance},
    {"Surroundings.sea_temperature_k", 0, kHottestK, kTemperature},
    {"Surroundings.sea_emissivity", 0, 1, kFraction},
    {"Surroundings.lower_radiance_w_m2_sr_um", 0, 1e12, kRadiance},
    {"Surroundings.ground_temperature_k", 0, kHottestK, kTemperature},
    {"Surroundings.ground_emissivity", 0, 1, kFraction},
    {"Surroundings.solar_albedo", 0, 1, kFraction},

    {"Air.absorption_m2_kg", 0, 1e6, "opaque within a millimetre"},
    {"Air.pressure_pa", 0, 1e9, "denser is no gas"},
    {"Air.gas_constant_j_kg_k", 1, 1e5, "the heaviest to the lightest gas"},
    {"Air.visibility_m", 100, 100e3, kVisibility},
    {"Air.air_mass", 1, 10, "open ocean to continent"},
    {"Air.co2_ppmv", 0, 10000, "the absorption tables' volume mixing ratios"},

    {"Heat.history_days", 1, 60, "less has no night, longer no wall remembers"},
    {"Heat.element_size_m", 0.01, 1e5, "finer than a hand nothing differs; the size of targets"},
    {"Heat.step_minutes", 0.5, 60, "the sun's own width to 15 degrees"},
    {"Heat.tolerance_k", 1e-4, 10, "below, rounding is larger; above, there is no number"},
    {"Heat.rays", 16, 65536, "fewer see nothing, more only cost time"},

    {"Plume.position_m", -1e6, 1e6, kPlacement},
    {"Plume.temperature_k", 200, 3000, kGasTables},
    {"Plume.pressure_pa", 10132.5, 202650, kGasTables},
    {"Plume.diameter_m", 1e-3, 100, "a candle to a volcano"},
    {"Plume.velocity_m_s", 0.1, 500,
     "slower gas does not fill its opening, faster is compressible"},
    {"Plume.excess_air", 0, 20, "just enough to mostly air"},
    {"Plume.hydrogen_per_carbon", 0, 4, "coal to methane"},
    {"Plume.carbon_as_co", 0, 1, kFraction},
    {"Plume.soot_g_per_kg", 0, 100, "the smokiest of fires"},
    {"Plume.length_m", 1e-3, 1e5, kSize},
    {"Plume.width_m", 1e-3, 1e5, kSize},
    {"Plume.height_m", 1e-3, 1e5, kSize},
    {"Plume.radius_m", 1e-3, 1e5, kSize},
    {"Plume.area_optical_depth", 1e-6, 20, "hardly anything to all that numbers tell apart"},
    {"Plume.voxel_m", 1e-4, 1e4, "a share of the size of the gas"},
    {"Plume.unit_m", 1e-9, 1e6, "nanometres to thousands of kilometres"},
    {"GasQuantity.constant", -300, 1e7, "any of its units; what the gas's tables have is less"},

    {"Land.epsg", 4326, 32760, kEpsg},
    {"Land.inset_epsg", 4326, 32760, kEpsg},
    {"Land.spacing_m", 0.1, 1e4, "stones to mountains"},
    {"Land.width_m", 1, 8e5, "a map ends 400 km from the target"},
    {"Land.geoid_m", -200, 200, "the geoid of the Earth"},
    {"Land.fill_m", -1e4, 1e4, "the deepest sea to the highest mountain"},
    {"Land.edge_fade_m", 0, 4e5, "a map ends 400 km from the target"},
    {"LandMaterial.fraction_epsg", 4326, 32760, kEpsg},
    {"LandMaterial.temperature_k", 150, 1500, kLandTemperature},
    {"LandObject.unit_m", 1e-9, 1e6, "nanometres to thousands of kilometres"},
    {"LandObject.scale", 1e-3, 1e3, kScale},
    {"LandObject.sink_m", 0, 1000, "an object does not hang above the land"},
    {"LandObject.count", 1, 1e6, "objects of a land, all tables together"},
    {"LandObject.seed", 0, 18446744073709551615.0, kSeed},
    {"LandObject.inner_radius_m", 0, 5.7e5, kLandRadius},
    {"LandObject.radius_m", 1, 5.7e5, kLandRadius},
    {"LandObjectPlace.east_m", -4e5, 4e5, kLandPlace},
    {"LandObjectPlace.north_m", -4e5, 4e5, kLandPlace},
    {"LandObjectPlace.heading_deg", -360, 360, kAzimuth},
    {"LandObjectPlace.scale", 1e-3, 1e3, kScale},

    {"Transport.max_reflections", 0, 1000, kReflections},
    {"Transport.job_size_vertices", 1, 1e18, "one path to more than a machine's lifetime"},
    {"Accuracy.relative_error", 1e-6, 1, "below, rounding is larger; above, there is no number"},
    {"Accuracy.target_paths", 1, 1e15, "more than a machine's lifetime"},
    {"Accuracy.samples_per_replicate", 1, 8388608, kSamples},
    {"Accuracy.time_budget_s", 1e-3, 1e9, "less than any pilot takes to 30 years"},
    {"Accuracy.replicates", 32, 4096, kReplicates},
    {"Accuracy.max_samples_per_replicate", 1, 8388608, kSamples},
    {"Accuracy.absolute_error_k", 0, 1000, "a larger error is no result"},
    {"Output.thumbnail_px", 0, 4096, "an image for every row"},
    {"Image.pixels", 1, 4096, "an image for every row"},
    {"Image.margin", 0, 100, "from the target's own rectangle to one in which it is a speck"},
    {"Image.field_of_view_deg", 1e-6, 120, "a point of the target to more than lenses show flat"},
    {"Image.look_at_m", -1e6, 1e6, "on or near the target"},
    {"Image.samples", 4, 32768, "each pixel's error needs two halves; counts are of 16 bits"},
    {"Image.max_samples", 8, 32768, "each pixel's error needs two halves; counts are of 16 bits"},
    {"Image.pixel_error_percent", 1e-3, 100,
     "below, rounding is larger; above, there is no number"},
    {"Image.pixel_error_k", 1e-4, 1000, "below, rounding is larger; above, there is no number"},

    {"Profile.from_m", -1e6, 1e6, "on or near the target"},
    {"Profile.to_m", -1e6, 1e6, "on or near the target"},
    {"Profile.at_m", -1e6, 1e6, "on or near the target"},
    {"Profile.points", 2, 100000, "a line has two ends; more points fill the memory"},
    {"Profile.footprint_width_m", 1e-9, 1e6, "a point to more than a target"},
    {"Profile.footprint_height_m", 1e-9, 1e6, "a point to more than a target"},
    {"Profile.reflections", 0, 1000, kReflections},
    {"Profile.source_radiance_temperature_stderr_k", 1e-4, 100, "below, rounding is larger"},
    {"Profile.samples", 1, 1e12, "more than a machine's lifetime"},
    {"Published.point_index", 0, 99999, "the points of a profile, counted from 0"},
    {"Published.reflections", 0, 1000, kReflections},
    {"Published.source_radiance_temperature_k", 0, kHottestK, kTemperature},

    {"Precompute.hot_area_m2", 0, 1e12, "larger than any target"},
    {"Precompute.hot_temperature_k", 0, kHottestK, kTemperature},
    {"Precompute.ambient_area_m2", 0, 1e12, "larger than any target"},
    {"Precompute.ambient_temperature_k", 0, kHottestK, kTemperature},
    {"Precompute.air_temperature_k", 1, kHottestK, "the air's density depends on it"},
    {"Precompute.emissivity", 0, 1, kFraction},
    {"Precompute.reflected_exitance_w_m2_um", 0, 1e12, kRadiance},
    {"Precompute.absorption_m2_kg", 0, 1e6, "opaque within a millimetre"},
    {"Precompute.pressure_pa", 0, 1e9, "denser is no gas"},
    {"Precompute.gas_constant_j_kg_k", 1, 1e5, "the heaviest to the lightest gas"},
    {"Precompute.range_m", 1e-3, 1e9, kRange},
    {"Precompute.lambda_min_um", kShortestUm, kLongestUm, kWavelength},
    {"Precompute.lambda_max_um", kShortestUm, kLongestUm, kWavelength},
    {"Precompute.step_um", 1e-9, kLongestUm, kStep},

    {"Viewpoint.aspect_azimuth_deg", -360, 360, kAzimuth},
    {"Viewpoint.aspect_elevation_deg", -90, 90, kElevation},
    {"Viewpoint.range_m", 1e-3, 1e9, kRange},
    {"Condition.season_index", 0, kMostConditions, kIndexOfList},
    {"Condition.time_index", 0, kMostConditions, kIndexOfList},
    {"Condition.part_temperature_k", 0, kHottestK, kTemperature},
    {"Condition.land_temperature_k", 0, 1500, kLandTemperature},
    {"Condition.land_heat", 0, kMostConditions, kIndexOfList},
    {"Condition.sun_irradiance_w_m2", 0, 1e9, "beyond the sun's surface"},
    {"Condition.air_temperature_k", 0, kHottestK, kTemperature},
    {"Condition.plume", 0, kMostConditions, kIndexOfList},
    {"ConditionPlume.wind_speed_m_s", 0, 150, "more than any storm"},
    {"ConditionPlume.wind_from_deg", -360, 360, kAzimuth},
    {"ConditionPlume.ship_speed_m_s", 0, 50, "faster than any ship"},
    {"ConditionPlume.air_temperature_k", 0, 340, kAirOutdoors},
    {"ConditionPlume.air_pressure_pa", 0, 1.2e5, "at the surface, mountains included"},
    {"ConditionField.part", 0, 1e6, kIndexOfList},
    {"ConditionField.heat", 0, kMostConditions, kIndexOfList},
    {"ConditionField.shift_k", -kHottestK, kHottestK, kTemperature},
    {"WeatherCourse.radiation_interval_s", 0, 86400, "the means of a day"},
    {"WeatherRecord.unix_s", -1e10, 1e10, "some centuries to either side"},
    {"WeatherRecord.air_temperature_k", 100, 400, kAirOutdoors},
    {"WeatherRecord.dew_point_k", 50, 400, kAirOutdoors},
    {"WeatherRecord.pressure_pa", 1e4, 1.2e5, "at the surface, mountains included"},
    {"WeatherRecord.wind_speed_m_s", 0, 150, "more than any storm"},
    {"WeatherRecord.wind_from_deg", -360, 360, kAzimuth},
    {"WeatherRecord.cloud_cover", 0, 1, kFraction},
    {"WeatherRecord.direct_normal_w_m2", 0, 2000, "more than the sun's outside the air"},
    {"WeatherRecord.diffuse_horizontal_w_m2", 0, 2000, "more than the sun's outside the air"},
    {"WeatherRecord.sky_w_m2", 0, 2000, "more than that of any sky"},
    {"HeatRun.convection_factor", 0, 10, "moved by as many sigmas as make sense"},
    {"HeatRun.sky_factor", 0, 10, "moved by as many sigmas as make sense"},
    {"HeatRun.part_temperature_k", 0, kHottestK, kTemperature},
    {"HeatRun.land_temperature_k", 0, 1500, kLandTemperature},
    {"HeatRun.base", 0, kMostConditions, kIndexOfList},
    {"InputMove.sigma", 1e-4, 500, kSigma},
    {"InputMove.move", -1, 1, "one sigma to either side"},
    {"Slice.source_rows", 0, 1e12, "rows of a database"},
    {"Slice.rows", 0, 1e12, "rows of a database"},
    {"Shard.number", 1, kMostViewpoints, "no more than viewpoints"},
    {"Shard.of", 2, kMostViewpoints, "no more than viewpoints"},
    {"Weather.air_temperature_k", 0, kHottestK, kTemperature},
    {"Weather.relative_humidity_percent", 0, 1000, kHumidity},
    {"Weather.pressure_pa", 0, 1.2e5, "at the surface; 0: the profile's"},
    {"Weather.visibility_m", 0, 100e3, "0: the aerosol's own, or none"},
    {"Weather.air_mass", 0, 10, "open ocean to continent; 0: not the Navy's aerosol"},
    {"Weather.wind_speed_m_s", 0, 150, "more than any storm"},
    {"Weather.wind_speed_24h_m_s", 0, 150, "more than any storm"},
    {"Weather.above_surface_m", 0, 100e3, kAbove},
    {"Weather.place_height_m", 0, 100.2e3, "the sea to the end of the air, and the geoid"},
    {"Weather.cloud_cover", 0, 1, kFraction},
    {"CloudLayer.base_m", 0, 25e3, kCloud},
    {"CloudLayer.top_m", 0, 28e3, kCloud},
    {"CloudLayer.water_path_g_m2", 0, 1e6, kCloud},
    {"CloudLayer.effective_radius_um", 0, 153.3, kCloud},
    {"Weather.co2_ppmv", 0, 10000, "the absorption tables' volume mixing ratios"},

    {"Goniometer.seed", 0, 18446744073709551615.0, kSeed},
    {"Particles.width_m", 1e-6, 1000, "a grain to a field"},
    {"Particles.tiles", 1, 100, "a copy is a triangle's memory again"},
    {"Particles.coverage", 0, 0.99, "denser, no more grains find a place"},
    {"Particles.layers", 1e-6, 50, "deeper layers are not seen"},
    {"Particles.irregularity", 0, 0.4, "beyond, grains intersect themselves"},
    {"Particles.subdivisions", 0, 3, "80, 320, 1280 or 5120 facets of each grain"},
    {"GrainSize.diameter_m", 1e-7, 10, "below, light is no ray"},
    {"GrainSize.fraction", 0, 1e12, kWeight},
    {"GoniometerBand.center_um", kShortestUm, kLongestUm, kWavelength},
    {"GoniometerBand.fwhm_um", 1e-9, kLongestUm, kStep},
    {"GoniometerBand.lambda_min_um", kShortestUm, kLongestUm, kWavelength},
    {"GoniometerBand.lambda_max_um", kShortestUm, kLongestUm, kWavelength},
    {"GoniometerBand.step_um", 1e-9, kLongestUm, kStep},
    {"GoniometerSource.zenith_deg", 0, 89, kZenith},
    {"GoniometerSource.distance_m", 1e-3, 1e4, kFarField},
    {"GoniometerSource.angular_radius_deg", 0, 10, "larger is no source but a sky"},
    {"GoniometerSensor.range_m", 1e-3, 1e4, kFarField},
    {"GoniometerSensor.field_width_m", 1e-6, 1000, "a grain to a field"},
    {"GoniometerSensor.field_height_m", 1e-6, 1000, "a grain to a field"},
    {"GoniometerSensor.reference_height_m", -1000, 1000, "on or near the plate"},
    {"GoniometerView.zenith_max_deg", 0, 89, kZenith},
    {"GoniometerView.zenith_step_deg", 0.01, 90, "finer views cannot be told apart"},
    {"GoniometerView.azimuth_step_deg", 0.01, 180, "finer views cannot be told apart"},
    {"GoniometerView.zenith_deg", 0, 89, kZenith},
    {"GoniometerView.azimuth_deg", 0, 360, "one turn"},
    {"GoniometerAccuracy.samples_per_replicate", 1, 8388608, kSamples},
    {"GoniometerAccuracy.replicates", 32, 4096, kReplicates},
    {"GoniometerAccuracy.max_reflections", 0, 1000, kReflections},

    {"DetectorNoise.nei_w_m2", 1e-30, 1e6, kInstrument},
    {"DetectorNoise.netd_k", 1e-9, 1e3, kInstrument},
    {"DetectorNoise.scene_temperature_k", 2.7, 20000, kTemperature},
    {"DetectorNoise.stated_f_number", 0.1, 1e3, kInstrument},
    {"DetectorNoise.f_number", 0.1, 1e3, kInstrument},
    {"DetectorNoise.ifov_rad", 1e-9, 1, kInstrument},
    {"DetectorNoise.detector_area_m2", 1e-15, 1, kInstrument},
    {"DetectorNoise.bandwidth_hz", 1e-6, 1e12, kInstrument},
    {"DetectorNoise.aperture_m", 1e-5, 100, kInstrument},
    {"DetectorNoise.transmittance", 1e-9, 1, kFraction},
    {"DetectorNoise.pixel_m", 1e-7, 1, kInstrument},
    {"DetectorNoise.integration_s", 1e-9, 1e6, kInstrument},
    {"DetectorNoise.well_electrons", 1, 1e15, kInstrument},
    {"DetectorNoise.read_electrons", 0, 1e9, kInstrument},

    {"ImagerOptics.aperture_m", 1e-5, 100, kInstrument},
    {"ImagerOptics.f_number", 0.1, 1e3, kInstrument},
    {"ImagerOptics.jitter_rad", 0, 0.1, kInstrument},
    {"ImagerDetector.pitch_m", 1e-7, 1, kInstrument},
    {"ImagerDetector.fill_factor", 0.01, 1, "a smaller active area records hardly any light"},
    {"ImagerDetector.netd_k", 0, 1e3, kInstrument},
    {"ImagerDetector.scene_temperature_k", 100, 20000, kScene},
    {"ImagerDetector.fixed_pattern_k", 0, 1e3, kInstrument},
    {"ImagerDetector.margin_px", 0, 256, "the point spread does not reach farther"},
    {"ImagerDetector.seed", 0, 18446744073709551615.0, kSeed},
    {"ImagerCounts.bits", 8, 16, "the depth of a grey PNG"},
    {"ImagerCounts.black_k", 0, 20000, kTemperature},
    {"ImagerCounts.white_k", 0, 20000, kTemperature},
    {"ImagerCounts.counts_per_w_m2_sr", 1e-12, 1e18, kInstrument},
    {"ImagerCounts.offset_counts", -1e12, 1e12, kInstrument},
});

std::string key_of(const FieldDescriptor& field) {
  return absl::StrCat(field.containing_type()->name(), ".", field.name());
}

bool is_number(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_UINT32:
    case FieldDescriptor::CPPTYPE_UINT64:
      return true;
    default:
      return false;
  }
}

// The numbers of a field: of each element, if it is a list.
double number_in(const Message& message, const FieldDescriptor& field, int i) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  const bool list = field.is_repeated();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return list ? r.GetRepeatedDouble(message, &field, i) : r.GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return list ? r.GetRepeatedUInt32(message, &field, i) : r.GetUInt32(message, &field);
    default:
      return static_cast<double>(list ? r.GetRepeatedUInt64(message, &field, i)
                                      : r.GetUInt64(message, &field));
  }
}

bool inside(const NumberBounds& bounds, double value) {
  return value >= bounds.least && value <= bounds.most;
}

// Numbers that are right in another unit.
std::string other_unit(std::string_view key, double value, const NumberBounds& bounds) {
  const auto if_inside = [&](double converted, const char* unit, const char* of_key) {
    return inside(bounds, converted)
               ? absl::StrCat("; is it in ", unit, "? ", number_text(value), " ", unit, " are ",
                              absl::SixDigits(converted), " ", of_key)
               : "";
  };
  // Below a coldest temperature outdoors degrees Celsius are meant; a sigma may be small.
  constexpr double kColdestK = 100;
  const bool temperature =
      key.ends_with("temperature_k") || key.ends_with("black_k") || key.ends_with("white_k");
  if (temperature && value > -100 && value < (bounds.least >= kColdestK ? bounds.least : 0))
    return if_inside(value + 273.15, "C", "K");
  if (key.ends_with("_um") && value > bounds.most) return if_inside(1e-3 * value, "nm", "um");
  if (key.ends_with("pressure_pa") && value < bounds.least)
    return if_inside(100 * value, "hPa", "Pa");
  if (key.ends_with("visibility_m") && value < bounds.least)
    return if_inside(1000 * value, "km", "m");
  if ((key.ends_with("thickness_m") || key.ends_with("aperture_m")) && value > bounds.most)
    return if_inside(1e-3 * value, "mm", "m");
  if (key.ends_with("pitch_m") && value > bounds.most) return if_inside(1e-6 * value, "um", "m");
  // 1.2 may as well be a fraction that is wrong.
  const bool fraction = bounds.least == 0 && bounds.most == 1 && value >= 2 && value <= 100;
  if ((key.ends_with("relative_error") || fraction) && value > bounds.most)
    return absl::StrCat("; is it in percent? ", number_text(value), " % are ",
                        number_text(0.01 * value));
  return "";
}

std::string refusal(std::string_view name, double value, const NumberBounds& bounds) {
  return absl::StrCat(std::string(name), " = ", number_text(value), ", expected a number ",
                      text_of(bounds), other_unit(bounds.key, value, bounds));
}

void check_map(const Message& message, const FieldDescriptor& field, const std::string& path,
               Findings& findings) {
  const FieldDescriptor& number = *field.message_type()->map_value();
  if (!is_number(number)) return;
  const NumberBounds& bounds = bounds_of(key_of(field));
  const google::protobuf::Reflection& r = *message.GetReflection();
  for (int i = 0; i < r.FieldSize(message, &field); ++i) {
    const Message& entry = r.GetRepeatedMessage(message, &field, i);
    const double value = number_in(entry, number, 0);
    if (inside(bounds, value)) continue;
    const std::string at = absl::StrCat(
        path, ".", entry.GetReflection()->GetString(entry, field.message_type()->map_key()));
    findings.add(at, refusal(at, value, bounds));
  }
}

}  // namespace

std::span<const NumberBounds> number_bounds() { return kBounds; }

std::string number_text(double value) {
  for (const int digits : {6, 15}) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value || std::isnan(value)) return text;
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

const NumberBounds& bounds_of(std::string_view key) {
  static const auto& rows = *[] {
    auto* made = new std::unordered_map<std::string_view, const NumberBounds*>();
    for (const NumberBounds& row : kBounds) made->emplace(row.key, &row);
    return made;
  }();
  const auto found = rows.find(key);
  if (found == rows.end()) std::abort();  // a field without a row: number_bounds_test
  return *found->second;
}

std::string text_of(const NumberBounds& bounds) {
  return absl::StrCat("from ", number_text(bounds.least), " to ", number_text(bounds.most), " (",
                      std::string(bounds.reason), ")");
}

absl::Status check_number(std::string_view key, std::string_view name, double value) {
  const NumberBounds& bounds = bounds_of(key);
  return inside(bounds, value) ? absl::OkStatus()
                               : absl::InvalidArgumentError(refusal(name, value, bounds));
}

void check_numbers(const Message& message, const std::string& path, Findings& findings) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  std::vector<const FieldDescriptor*> present;
  r.ListFields(message, &present);
  // A number that a resolved sweep always has is one when it is 0, too.
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i)
    if (const FieldDescriptor* field = type.field(i); !field->is_repeated() &&
                                                      !field->has_presence() && is_number(*field) &&
                                                      !r.HasField(message, field))
      present.push_back(field);
  for (const FieldDescriptor* field : present) {
    const std::string at = path.empty() ? field->name() : absl::StrCat(path, ".", field->name());
    const auto element = [&](int i) {
      return field->is_repeated() ? absl::StrCat(at, "[", i, "]") : at;
    };
    const int count = field->is_repeated() ? r.FieldSize(message, field) : 1;
    if (field->is_map()) {
      check_map(message, *field, at, findings);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      for (int i = 0; i < count; ++i)
        check_numbers(field->is_repeated() ? r.GetRepeatedMessage(message, field, i)
                                           : r.GetMessage(message, field),
                      element(i), findings);
    } else if (is_number(*field)) {
      const NumberBounds& bounds = bounds_of(key_of(*field));
      for (int i = 0; i < count; ++i) {
        const double value = number_in(message, *field, i);
        if (!inside(bounds, value)) findings.add(element(i), refusal(element(i), value, bounds));
      }
    }
  }
}

}  // namespace irsig

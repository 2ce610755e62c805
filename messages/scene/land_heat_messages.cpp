#include "messages/scene/land_heat_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/hottest.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

static_assert(std::endian::native == std::endian::little);

// More than any map of heights: memory is taken for what is really there.
constexpr std::uint32_t kMostCells = 1U << 14U;
// An index of a horizon is a byte.
constexpr std::size_t kMostHorizons = 256, kMostSquares = 64;
constexpr float kUpright = std::numbers::pi_v<float> / 2 + 1e-6F;

absl::Status wrong(const std::string& what) {
  return absl::InvalidArgumentError(
      absl::StrCat("computed temperatures of land: ", what,
                   " (damaged, or of another irsig: run the sweep again)"));
}

void append(const std::vector<float>& row, std::string& out) {
  out.append(reinterpret_cast<const char*>(row.data()), sizeof(float) * row.size());
}

std::string bytes_of(const std::vector<std::vector<float>>& rows) {
  std::string out;
  for (const std::vector<float>& row : rows) append(row, out);
  return out;
}

// [row][column]; each number is checked.
template <typename Valid>
absl::StatusOr<std::vector<std::vector<float>>> rows_of(const std::string& bytes, std::size_t rows,
                                                        std::size_t columns, const char* name,
                                                        Valid valid) {
  if (bytes.size() != sizeof(float) * rows * columns)
    return wrong(absl::StrCat(name, " has ", bytes.size(), " bytes for ", rows, " times and ",
                              columns, " columns"));
  std::vector<std::vector<float>> out(rows, std::vector<float>(columns));
  for (std::size_t r = 0; r < rows; ++r) {
    std::memcpy(out[r].data(), bytes.data() + r * columns * sizeof(float), columns * sizeof(float));
    for (const float value : out[r])
      if (!valid(value)) return wrong(absl::StrCat(name, " has the value ", value));
  }
  return out;
}

absl::StatusOr<std::vector<LandHorizon>> horizons_from(const std::string& bytes) {
  constexpr std::size_t kArray = sizeof(float) * kHorizonAzimuths, kBytes = 3 * kArray;
  if (bytes.empty() || bytes.size() % kBytes != 0 || bytes.size() / kBytes > kMostHorizons)
    return wrong(absl::StrCat("horizons have ", bytes.size(), " bytes"));
  std::vector<LandHorizon> out(bytes.size() / kBytes);
  for (std::size_t h = 0; h < out.size(); ++h) {
    const char* from = bytes.data() + h * kBytes;
    for (auto* array : {&out[h].elevation_rad, &out[h].lid_low_rad, &out[h].lid_high_rad}) {
      std::memcpy(array->data(), from, kArray);
      from += kArray;
      for (const float rad : *array)
        if (!(std::abs(rad) <= kUpright))
          return wrong(absl::StrCat("a horizon is at ", rad, " rad"));
    }
  }
  return out;
}

absl::StatusOr<LandKinds::Square> square_from(const schema::LandSquare& message,
                                              std::size_t horizons) {
  const std::uint64_t cells = message.cells();
  if (!(message.cell_m() > 0) || !std::isfinite(message.cell_m()) || cells == 0 ||
      cells > kMostCells || message.horizon().size() != cells * cells)
    return wrong(absl::StrCat("a square of ", cells, " cells of ", message.cell_m(), " m has ",
                              message.horizon().size(), " bytes"));
  LandKinds::Square out{message.cell_m(), message.cells(), {}};
  out.horizon.assign(message.horizon().begin(), message.horizon().end());
  if (*std::max_element(out.horizon.begin(), out.horizon.end()) >= horizons)
    return wrong(absl::StrCat("a cell has a horizon of more than ", horizons));
  return out;
}

}  // namespace

std::vector<bool> land_computed(const schema::Sweep& sweep) {
  std::vector<bool> out;
  for (const schema::LandMaterial& material : sweep.land().material())
    out.push_back(material.has_build_up());
  return out;
}

std::vector<bool> land_on_objects(const schema::Sweep& sweep) {
  std::vector<bool> out;
  for (const schema::LandMaterial& material : sweep.land().material())
    out.push_back(std::any_of(sweep.land().object().begin(), sweep.land().object().end(),
                              [&](const schema::LandObject& object) {
                                return object.material() == material.material() ||
                                       std::any_of(object.part().begin(), object.part().end(),
                                                   [&](const auto& part) {
                                                     return part.material() == material.material();
                                                   });
                              }));
  return out;
}

schema::LandHeat land_heat_to_message(const LandKinds& kinds, const LandHeatResult& by_time) {
  schema::LandHeat out;
  schema::LandKinds& to = *out.mutable_kinds();
  to.set_materials(kinds.materials);
  for (const bool computed : kinds.computed) to.add_computed(computed);
  for (const bool on_objects : kinds.on_objects) to.add_on_objects(on_objects);
  for (const LandHorizon& horizon : kinds.horizon)
    for (const auto* array : {&horizon.elevation_rad, &horizon.lid_low_rad, &horizon.lid_high_rad})
      append({array->begin(), array->end()}, *to.mutable_horizon_rad());
  to.mutable_stand_in()->assign(kinds.stand_in.begin(), kinds.stand_in.end());
  for (const LandKinds::Square& square : kinds.square) {
    schema::LandSquare& of = *to.add_square();
    of.set_cell_m(square.cell_m);
    of.set_cells(square.cells);
    of.mutable_horizon()->assign(square.horizon.begin(), square.horizon.end());
  }
  out.set_kelvin(bytes_of(by_time.kelvin));
  out.set_error_k(bytes_of(by_time.error_k));
  out.set_interpolation_k(bytes_of(by_time.interpolation_k));
  return out;
}

absl::StatusOr<LandKinds> land_kinds_from_message(const schema::LandKinds& message,
                                                  const schema::Sweep& sweep) {
  LandKinds out;
  out.materials = message.materials();
  out.computed.assign(message.computed().begin(), message.computed().end());
  out.on_objects.assign(message.on_objects().begin(), message.on_objects().end());
  if (out.materials != static_cast<std::uint32_t>(sweep.land().material_size()) ||
      out.computed != land_computed(sweep) || out.on_objects != land_on_objects(sweep))
    return wrong("their kinds are of other materials than the sweep's");
  ASSIGN_OR_RETURN(out.horizon, horizons_from(message.horizon_rad()));
  if (static_cast<std::size_t>(message.square_size()) > kMostSquares)
    return wrong(absl::StrCat("there are ", message.square_size(), " squares of horizons"));
  for (const schema::LandSquare& square : message.square()) {
    ASSIGN_OR_RETURN(auto of, square_from(square, out.horizon.size()));
    out.square.push_back(std::move(of));
  }
  out.stand_in.assign(message.stand_in().begin(), message.stand_in().end());
  const std::size_t horizons = out.horizon.size();
  if (out.stand_in.size() != out.materials * horizons)
    return wrong(absl::StrCat("stand-ins have ", out.stand_in.size(), " bytes"));
  for (std::size_t i = 0; i < out.stand_in.size(); ++i) {
    const std::uint8_t other = out.stand_in[i];
    // A stand-in has kinds of its own.
    if (other >= horizons || out.stand_in[i / horizons * horizons + other] != other)
      return wrong("a horizon's stand-in has no kinds");
  }
  out.index_kinds();
  return out;
}

absl::StatusOr<LandHeat> land_heat_from_message(const schema::LandHeat& message,
                                                const schema::Sweep& sweep, std::size_t times) {
  LandHeat out;
  ASSIGN_OR_RETURN(out.kinds, land_kinds_from_message(message.kinds(), sweep));
  const std::size_t kinds = out.kinds.kind.size();
  const auto most = static_cast<float>(kHottestK);
  const auto warm = [&](float k) { return k > 0 && k <= most; };
  const auto difference = [&](float k) { return k >= 0 && k <= most; };
  LandHeatResult& to = out.by_time;
  ASSIGN_OR_RETURN(to.kelvin, rows_of(message.kelvin(), times, kinds, "kelvin", warm));
  ASSIGN_OR_RETURN(to.error_k, rows_of(message.error_k(), times, kinds, "error_k", difference));
  ASSIGN_OR_RETURN(to.interpolation_k,
                   rows_of(message.interpolation_k(), times, out.kinds.materials, "interpolation_k",
                           [&](float k) { return std::isnan(k) || difference(k); }));
  return out;
}

}  // namespace irsig

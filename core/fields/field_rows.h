#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/import/import_text.h"

namespace irsig {

// The values of a file of temperatures, as it has them.
struct FieldRows {
  enum class Of : std::uint8_t { kFacet, kVertex, kPlace } of = Of::kFacet;
  struct Row {
    std::size_t line = 0;               // 0: the file has no lines
    std::int64_t index = 0;             // of kFacet, kVertex
    std::array<double, 3> place{};      // in the file's coordinates
    double temperature = 0, error = 0;  // in the file's unit; error NaN: none is stated
    double unix_s = 0;                  // NaN: no time is
  };
  std::vector<Row> row;
  bool has_index = false, has_place = false;
};

[[nodiscard]] absl::StatusOr<FieldRows> read_field_csv(std::string_view text,
                                                       const std::string& file_name);
[[nodiscard]] absl::StatusOr<FieldRows> read_field_ply(std::string_view bytes,
                                                       const std::string& file_name);

}  // namespace irsig

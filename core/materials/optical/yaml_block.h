#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string_view>
#include <vector>

#include "core/materials/optical/text_table.h"

namespace irsig {

// The document, or nothing if it is no YAML (reported).
[[nodiscard]] std::optional<YAML::Node> load_yaml(std::string_view text, TableErrors& errors);

// The rows of a literal block ("data: |") of `columns` numbers a line; `parent` is where errors
// stand if there is no such block. Never without a row: that is reported to `errors`.
[[nodiscard]] std::vector<std::vector<PlacedNumber>> block_rows(const YAML::Node& block,
                                                                const YAML::Mark& parent,
                                                                std::string_view text,
                                                                std::size_t columns,
                                                                TableErrors& errors);

}  // namespace irsig

#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string_view>
#include <vector>

#include "core/materials/optical/text_table.h"

namespace irsig {

// Parses the document; nothing if it is not YAML (reported).
[[nodiscard]] std::optional<YAML::Node> load_yaml(std::string_view text, TableErrors& errors);

// Returns the rows of a literal block ("data: |") of `columns` numbers a line. Reports a block
// without a row to `errors`. `parent` is the place of errors if there is no such block.
[[nodiscard]] std::vector<std::vector<PlacedNumber>> block_rows(const YAML::Node& block,
                                                                const YAML::Mark& parent,
                                                                std::string_view text,
                                                                std::size_t columns,
                                                                TableErrors& errors);

}  // namespace irsig

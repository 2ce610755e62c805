#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/atmosphere/imported/imported_samples.h"

namespace irsig {

// The input cards that a tape7 echoes before a table (docs/explanation/methods/atmosphere.md,
// "Imported paths"); private to this folder.
struct Tape7Cards {
  ImportedPath path;
  char axis_flag;  // card 4's M (micrometres), N (nanometres) or something else
};

// Reads the cards before the labels of a table. Returns nullopt after adding an error.
//   lines       all before the labels
//   first_line  number of the first of them in the file, from 1
[[nodiscard]] std::optional<Tape7Cards> read_tape7_cards(std::vector<std::string_view> lines,
                                                         std::size_t first_line,
                                                         FileErrors& errors);

}  // namespace irsig

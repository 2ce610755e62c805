#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/study/effects_matrix.h"

namespace irsig {

// Output of `irsig verify-effects`.

// One line a view, and one of its head.
[[nodiscard]] std::string effects_view_header();
[[nodiscard]] std::string effects_view_line(const CheckedView& view);

// One line a cell of the matrix, and one of its head.
[[nodiscard]] std::string effects_cell_header();
[[nodiscard]] std::string effects_cell_line(const MatrixCell& cell, const CheckedCell& checked);

// Every value that is out of bound, or further from its reference than five numerical errors, in a
// line of its own; empty: none. `where` says which cell it is.
[[nodiscard]] std::string effects_failures(const std::string& where, const CheckedView& view);

// Returns the effects that were left out, with the number of rows.
[[nodiscard]] std::string effects_off(const EffectsSummary& summary);

// The matrix as a whole: medians over cells, by the factors' levels too. Markdown.
[[nodiscard]] std::string effects_matrix_summary(std::span<const MatrixCell> cells,
                                                 std::span<const CheckedCell> checked);

// One effect left out alone, over all cells: in how many rows it can be, and how its bounds stand
// to what leaving it out changed. Markdown: a line, and the head.
[[nodiscard]] std::string effect_bounds_header();
[[nodiscard]] std::string effect_bounds_line(Effect effect, std::span<const CheckedCell> checked);

// One line for each cell, viewpoint and quantity.
[[nodiscard]] std::string effects_csv(std::span<const MatrixCell> cells,
                                      std::span<const CheckedCell> checked);

}  // namespace irsig

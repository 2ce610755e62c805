#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/study/effects_matrix.h"

namespace irsig {

// Output of `irsig verify-effects`.

// Returns one line per view; effects_view_header() returns the header.
[[nodiscard]] std::string effects_view_header();
[[nodiscard]] std::string effects_view_line(const CheckedView& view);

// Returns one line per cell of the matrix; effects_cell_header() returns the header.
[[nodiscard]] std::string effects_cell_header();
[[nodiscard]] std::string effects_cell_line(const MatrixCell& cell, const CheckedCell& checked);

// Returns one line for each value that is out of bound, or that differs from its reference by more
// than five numerical errors; empty: there is none. where: names the cell.
[[nodiscard]] std::string effects_failures(const std::string& where, const CheckedView& view);

// Returns the effects that were left out, with the number of rows.
[[nodiscard]] std::string effects_off(const EffectsSummary& summary);

// Returns a summary of the matrix in Markdown: medians over cells, also by the levels of the
// factors.
[[nodiscard]] std::string effects_matrix_summary(std::span<const MatrixCell> cells,
                                                 std::span<const CheckedCell> checked);

// Returns a Markdown line about omitting one effect alone, over all cells: the number of rows in
// which the effect can be omitted, and the ratio of the change to its bounds.
// effect_bounds_header() returns the header.
[[nodiscard]] std::string effect_bounds_header();
[[nodiscard]] std::string effect_bounds_line(Effect effect, std::span<const CheckedCell> checked);

// Returns one line for each cell, viewpoint and quantity.
[[nodiscard]] std::string effects_csv(std::span<const MatrixCell> cells,
                                      std::span<const CheckedCell> checked);

}  // namespace irsig

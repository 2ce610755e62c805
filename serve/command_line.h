#pragma once

#include <string>
#include <string_view>

#include "serve/question.h"

namespace irsig {

// Commands that print the content of the page, for a POSIX shell. database: the name with which the
// page was started.

// Returns the `irsig query` command for every viewpoint of one condition and band.
[[nodiscard]] std::string selection_command(const std::string& database, const Selection& selection,
                                            SignatureQuantity quantity);
// Returns the `irsig plot --kind polar` command, as CSV.
[[nodiscard]] std::string cut_command(const std::string& database, const Question& question,
                                      double elevation_deg);
// Returns the `irsig plan --refine` command for every condition and band of the selection's sweep
// and range.
[[nodiscard]] std::string left_out_command(const std::string& database, const Question& question);
// Returns the `irsig bands` command. detector: the detector's file; empty: the question's noise
// (NEI) is used.
[[nodiscard]] std::string bands_command(const std::string& database, const Question& question,
                                        const std::string& detector);
// Returns the `irsig query --row` command; spectrum: for the row's spectrum.
[[nodiscard]] std::string row_command(const std::string& database, const Question& question,
                                      bool spectrum);
// Returns the `irsig query --thumbnail` command for the row's stored image.
[[nodiscard]] std::string image_command(const std::string& database, const Question& question);
// Returns the `irsig plot --kind picture` command for the camera's counts; layer_command() adds
// --layer, for a layer of that image.
[[nodiscard]] std::string counts_command(const std::string& database, const Question& question);
[[nodiscard]] std::string layer_command(const std::string& database, const Question& question,
                                        std::string_view layer);
// Returns the `irsig explain` command.
[[nodiscard]] std::string explain_command(const std::string& database, const Question& question);

// Returns one word of a shell command, quoted where necessary.
[[nodiscard]] std::string shell_word(std::string_view text);

}  // namespace irsig

#pragma once

#include <string>
#include <string_view>

#include "serve/question.h"

namespace irsig {

// The commands that print what the page shows, for a POSIX shell. database: as it was named when
// the page was started.

// `irsig query` of one condition and band: every viewpoint.
[[nodiscard]] std::string selection_command(const std::string& database, const Selection& selection,
                                            SignatureQuantity quantity);
// `irsig plot --kind polar`, as CSV.
[[nodiscard]] std::string cut_command(const std::string& database, const Question& question,
                                      double elevation_deg);
// `irsig plan --refine`: every condition and band of the selection's sweep and range.
[[nodiscard]] std::string left_out_command(const std::string& database, const Question& question);
// detector: its file; empty: that of the question's noise.
[[nodiscard]] std::string bands_command(const std::string& database, const Question& question,
                                        const std::string& detector);
// `irsig query --row`; spectrum: of its spectrum.
[[nodiscard]] std::string row_command(const std::string& database, const Question& question,
                                      bool spectrum);
// `irsig query --thumbnail`: its stored image.
[[nodiscard]] std::string image_command(const std::string& database, const Question& question);
// `irsig plot --kind picture --layer`: a layer of that image.
[[nodiscard]] std::string counts_command(const std::string& database, const Question& question);
[[nodiscard]] std::string layer_command(const std::string& database, const Question& question,
                                        std::string_view layer);
// `irsig explain`.
[[nodiscard]] std::string explain_command(const std::string& database, const Question& question);

// One word of a shell's command, quoted where it must be.
[[nodiscard]] std::string shell_word(std::string_view text);

}  // namespace irsig

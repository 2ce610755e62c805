#pragma once

#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "view/bands.h"

namespace irsig {

// "mean SNR", "share with SNR >= 5": of axes and titles.
[[nodiscard]] std::string merit_name(const MeritOf& merit);

// The windows that were compared, one line each, in a format of table.h.
[[nodiscard]] absl::Status write_choice(const BandChoice& choice, std::string_view format,
                                        std::ostream& out);

// Every window: lambda_min_um,lambda_max_um,merit and, of the mean, its samples' standard error.
[[nodiscard]] absl::Status write_map(const BandSearch& search, const MeritOf& merit,
                                     const BandSearch::Map& map, std::string_view format,
                                     std::ostream& out);
// The same as colours over both limits, the best marked; a complete SVG document.
[[nodiscard]] std::string plot_map_of_windows(const BandSearch& search, const MeritOf& merit,
                                              const BandSearch::Map& map, const std::string& title);

// The detector's response within a window, as `irsig query --response` takes it.
[[nodiscard]] std::string response_csv(const ResponseTable& response, double lambda_min_um,
                                       double lambda_max_um);

// For people: which windows cannot be told apart, and what would tell them: the line of the sweep
// file that asks for so many more samples.
[[nodiscard]] std::vector<std::string> notes_on(const BandChoice& choice,
                                                const BandPopulation& population,
                                                const schema::Accuracy& accuracy);

}  // namespace irsig

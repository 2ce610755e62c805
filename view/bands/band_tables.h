#pragma once

#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "view/bands/bands.h"

namespace irsig {

// Returns the name of a merit for axes and titles: "mean SNR", "share with SNR >= 5".
[[nodiscard]] std::string merit_name(const MeritOf& merit);

// Writes the compared windows, one line each, in a format of table.h.
[[nodiscard]] absl::Status write_choice(const BandSearch& search, const WindowChoice& choice,
                                        std::string_view format, std::ostream& out);

// Writes one line for each window: lambda_min_um, lambda_max_um and merit; for the mean also its
// standard error from samples. With a pairing, the merit is that of the window's best pair, and the
// line has the limits of the other window.
[[nodiscard]] absl::Status write_map(const BandSearch& search, const MeritOf& merit,
                                     const BandSearch::Found& found, std::string_view format,
                                     std::ostream& out);
// Returns the map as colours over both limits, the best marked; a complete SVG document.
[[nodiscard]] std::string plot_map_of_windows(const BandSearch& search, const MeritOf& merit,
                                              const BandSearch::Found& found,
                                              const std::string& title);

// Writes the merit of each compared candidate at each range of the population.
[[nodiscard]] absl::Status write_ranges(const BandSearch& search, const MeritOf& merit,
                                        const WindowChoice& choice, std::string_view format,
                                        std::ostream& out);
// Plots the ranges as curves of the first few candidates.
[[nodiscard]] std::string plot_ranges(const BandSearch& search, const MeritOf& merit,
                                      const WindowChoice& choice, const std::string& title);

// Writes the detection range of each row and each compared candidate: season, time_utc, aspect,
// weight and detection_range_m. The range is empty below the nearest and beyond the farthest range;
// the column `reach` states which.
[[nodiscard]] absl::Status write_detection(const BandSearch& search, const WindowChoice& choice,
                                           double threshold, std::string_view format,
                                           std::ostream& out);
// Returns a note for people: the detection ranges that the best candidate reaches for 10 %, half
// and 90 % of the population.
[[nodiscard]] std::string note_on_detection(const BandSearch& search, const WindowChoice& choice,
                                            double threshold);

// Returns the title of a candidate: "3.9 to 4.1 um", "3.9 to 4.1 and 4.5 to 4.8 um", or the name of
// a filter.
[[nodiscard]] std::string title_of(const BandSearch& search, const Candidate& candidate);

// Returns a response in the CSV format that `irsig query --response` reads.
[[nodiscard]] std::string response_csv(const ResponseTable& response);

// Returns notes for people: the windows that cannot be distinguished, and the line of the sweep
// file that requests enough samples to distinguish them.
[[nodiscard]] std::vector<std::string> notes_on(const WindowChoice& choice,
                                                const BandPopulation& population,
                                                const schema::Accuracy& accuracy);

}  // namespace irsig

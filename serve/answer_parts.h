#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "serve/page_reply.h"
#include "serve/page_sources.h"
#include "serve/question.h"
#include "view/report/compare.h"

namespace irsig {

// The answers behind answers.h: each opens the database that it needs. The bodies are described in
// serve/README.md.

[[nodiscard]] absl::StatusOr<PageReply> answer_contents(const PageSources& sources);
[[nodiscard]] absl::StatusOr<PageReply> answer_progress(const PageSources& sources);

// Answers about all aspects.
[[nodiscard]] absl::StatusOr<PageReply> answer_map(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_cut(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_compare(const PageSources& sources,
                                                       const Question& q);

// Answers about all windows of a band, from as many rows as a page can wait for.
[[nodiscard]] absl::StatusOr<PageReply> answer_bands(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<std::string> bands_csv(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<std::string> bands_svg(const PageSources& sources, const Question& q);

// Returns every viewpoint as interpolated from the others. FAILED_PRECONDITION: too many for a
// page.
[[nodiscard]] absl::StatusOr<PageReply> answer_left_out(const PageSources& sources,
                                                        const Question& q);
[[nodiscard]] absl::StatusOr<std::string> left_out_csv(const PageSources& sources,
                                                       const Question& q);

// Answers about one row.
[[nodiscard]] absl::StatusOr<PageReply> answer_row(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_spectrum(const PageSources& sources,
                                                        const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_thumbnail(const PageSources& sources,
                                                         const Question& q);

// Answers about the image of a row: its size and layers; the stored bytes of one of them; where it
// shows which part.
[[nodiscard]] absl::StatusOr<PageReply> answer_image(const PageSources& sources, const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_image_exr(const PageSources& sources,
                                                         const Question& q);
[[nodiscard]] absl::StatusOr<PageReply> answer_silhouette(const PageSources& sources,
                                                          const Question& q);

// Answers with a file to be saved; path without "/file/". NOT_FOUND: there is no such file.
[[nodiscard]] absl::StatusOr<PageReply> answer_file(const PageSources& sources,
                                                    const std::string& file,
                                                    const Parameters& parameters);

// Opens a database of the page. UNAVAILABLE with the reason: it cannot be opened (any more).
[[nodiscard]] absl::StatusOr<std::unique_ptr<StoreReader>> open_database(const PageSources& sources,
                                                                         std::size_t database);

// Returns the values of a selection. NOT_FOUND in words: there are none.
[[nodiscard]] absl::StatusOr<std::vector<StoredValue>> values_of_selection(
    StoreReader& reader, const Selection& selection, SignatureQuantity quantity);

// Computes b - a. NOT_FOUND: they have no aspect in common.
[[nodiscard]] absl::StatusOr<Comparison> compare_selections(const PageSources& sources,
                                                            const Question& question);

// Returns the one row of a question. NOT_FOUND.
[[nodiscard]] absl::StatusOr<std::vector<QueryRow>> one_row(const PageSources& sources,
                                                            StoreReader& reader,
                                                            const Question& question);

}  // namespace irsig

#pragma once

#include <string>

#include "serve/page_reply.h"
#include "serve/page_sources.h"
#include "serve/question.h"

namespace irsig {

// Answers a GET of a path. Any number of threads may ask: each answer opens its database and closes
// it. An error is a reply, too: JSON {"error": words}, with 400 for a malformed question, 404 for
// something that does not exist, 409 for a question that the stored data cannot answer and 503
// where the database cannot be read.
[[nodiscard]] PageReply answer(const PageSources& sources, const std::string& path,
                               const Parameters& parameters);

}  // namespace irsig

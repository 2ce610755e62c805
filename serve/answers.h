#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "serve/question.h"
#include "serve/serve.h"
#include "view/query/query.h"

namespace irsig {

// The databases of a page and what else it shows: the same as in ServeOptions.
struct PageSources {
  std::vector<std::string> database;  // paths, as they were named
  std::vector<PageDetector> detector;
  ExtentOf extent_of;
  FarmOf farm = {};
  std::string accuracy_page = {};
};

struct PageReply {
  int status = 200;  // of HTTP
  std::string type;  // of the body
  std::string body;
  std::string file_name = {};      // not empty: to be saved under this name
  bool is_self_contained = false;  // HTML with styles and pictures of its own, and nothing else
  bool keep_alive = false;         // HttpReply::keep_alive
  std::uint32_t pause_ms = 0;      // HttpReply::pause_ms
};

// Answers a GET of a path. Any number of threads may ask: each answer opens its database and closes
// it. An error is a reply, too: JSON {"error": words}, with 400 for a malformed question, 404 for
// something that does not exist, 409 for a question that the stored data cannot answer and 503
// where the database cannot be read.
[[nodiscard]] PageReply answer(const PageSources& sources, const std::string& path,
                               const Parameters& parameters);

[[nodiscard]] PageReply error_reply(int status, std::string_view words);

}  // namespace irsig

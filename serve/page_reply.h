#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace irsig {

struct PageReply {
  int status = 200;  // of HTTP
  std::string type;  // of the body
  std::string body;
  std::string file_name = {};      // not empty: to be saved under this name
  bool is_self_contained = false;  // HTML with styles and pictures of its own, and nothing else
  bool keep_alive = false;         // HttpReply::keep_alive
  std::uint32_t pause_ms = 0;      // HttpReply::pause_ms
};

// Returns JSON {"error": words}.
[[nodiscard]] PageReply error_reply(int status, std::string_view words);
[[nodiscard]] PageReply json_reply(std::string body);

}  // namespace irsig

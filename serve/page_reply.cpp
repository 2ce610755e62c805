#include "serve/page_reply.h"

#include <utility>

#include "serve/json_text.h"

namespace irsig {
namespace {

constexpr const char* kJson = "application/json; charset=utf-8";

}  // namespace

PageReply error_reply(int status, std::string_view words) {
  JsonObject body;
  body.text("error", words);
  return {status, kJson, body.finish(), ""};
}

PageReply json_reply(std::string body) { return {200, kJson, std::move(body), ""}; }

}  // namespace irsig

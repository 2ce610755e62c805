#include "serve/answers.h"

#include <fmt/format.h>

#include <utility>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "serve/json_text.h"
#include "serve/www_files.h"

namespace irsig {
namespace {

int http_status(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
      return 400;
    case absl::StatusCode::kNotFound:
      return 404;
    case absl::StatusCode::kFailedPrecondition:
      return 409;
    case absl::StatusCode::kUnavailable:
      return 503;
    default:
      return 500;
  }
}

std::string type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return "text/javascript; charset=utf-8";
}

absl::StatusOr<PageReply> answer_page_file(std::string_view name) {
  for (const WwwFile& file : www_files())
    if (file.name == name) return PageReply{200, type_of(name), std::string(file.bytes), ""};
  return absl::NotFoundError("there is no such page here");
}

struct Route {
  std::string_view path;
  Needs needs;
  absl::StatusOr<PageReply> (*answer)(const PageSources&, const Question&);
};

constexpr Route kRoutes[] = {
    {"/api/contents", Needs::kNothing,
     [](const PageSources& s, const Question&) { return answer_contents(s); }},
    {"/api/progress", Needs::kNothing,
     [](const PageSources& s, const Question&) { return answer_progress(s); }},
    {"/api/map", Needs::kSelection, answer_map},
    {"/api/cut", Needs::kSelection, answer_cut},
    {"/api/compare", Needs::kBoth, answer_compare},
    {"/api/left_out", Needs::kSelection, answer_left_out},
    {"/api/bands", Needs::kBands, answer_bands},
    {"/api/row", Needs::kRow, answer_row},
    {"/api/spectrum", Needs::kRow, answer_spectrum},
    {"/api/thumbnail.png", Needs::kRow, answer_thumbnail},
    {"/api/image.json", Needs::kRow, answer_image},
    {"/api/image.exr", Needs::kImage, answer_image_exr},
    {"/api/silhouette.json", Needs::kImage, answer_silhouette},
};

absl::StatusOr<PageReply> find_answer(const PageSources& sources, const std::string& path,
                                      const Parameters& parameters) {
  for (const Route& route : kRoutes) {
    if (route.path != path) continue;
    ASSIGN_OR_RETURN(const auto question,
                     parse_question(parameters, route.needs, sources.database.size()));
    return route.answer(sources, question);
  }
  const std::string_view name = path;
  const auto below = [&](std::string_view folder) {
    return name.starts_with(folder) ? name.substr(folder.size()) : std::string_view();
  };
  if (!below("/file/").empty())
    return answer_file(sources, std::string(below("/file/")), parameters);
  if (path == "/accuracy") {
    if (sources.accuracy_page.empty())
      return absl::NotFoundError("there is no accuracy page: irsig serve DB --accuracy FILE");
    return PageReply{200, type_of(".html"), sources.accuracy_page, "", true};
  }
  // The page reads its own parameters: they are its state.
  if (path == "/") return answer_page_file("index.html");
  if (!below("/www/").empty()) return answer_page_file(below("/www/"));
  return absl::NotFoundError("there is no such page here");
}

}  // namespace

absl::StatusOr<std::unique_ptr<StoreReader>> open_database(const PageSources& sources,
                                                           std::size_t database) {
  auto reader = StoreReader::open(sources.database[database]);
  if (!reader.ok()) return absl::UnavailableError(reader.status().message());
  return reader;
}

PageReply answer(const PageSources& sources, const std::string& path,
                 const Parameters& parameters) {
  auto reply = find_answer(sources, path, parameters);
  if (!reply.ok())
    return error_reply(http_status(reply.status()), std::string(reply.status().message()));
  return *std::move(reply);
}

}  // namespace irsig

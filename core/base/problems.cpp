#include "core/base/problems.h"

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

constexpr const char* kPayload = "irsig/problems";

// Each field as its length, a colon and its bytes.
void write_field(const std::string& field, std::string& out) {
  absl::StrAppend(&out, field.size(), ":", field);
}

std::optional<std::string> read_field(std::string_view& in) {
  std::size_t length = 0;
  const auto [end, error] = std::from_chars(in.data(), in.data() + in.size(), length);
  const auto digits = static_cast<std::size_t>(end - in.data());
  if (error != std::errc() || digits >= in.size() || in[digits] != ':') return std::nullopt;
  in.remove_prefix(digits + 1);
  if (length > in.size()) return std::nullopt;
  std::string field(in.substr(0, length));
  in.remove_prefix(length);
  return field;
}

std::string line_of(const Problem& problem) {
  return problem.place.empty() ? problem.text : absl::StrCat(problem.place, ": ", problem.text);
}

absl::Status status_of(absl::StatusCode code, const std::vector<Problem>& problems) {
  std::string message, fields;
  for (const Problem& problem : problems) {
    absl::StrAppend(&message, message.empty() ? "" : "\n", line_of(problem));
    for (const std::string* field : {&problem.place, &problem.key, &problem.text})
      write_field(*field, fields);
  }
  absl::Status status(code, message);
  status.SetPayload(kPayload, absl::Cord(fields));
  return status;
}

}  // namespace

absl::Status problem_status(const std::vector<Problem>& problems) {
  return problems.empty() ? absl::OkStatus()
                          : status_of(absl::StatusCode::kInvalidArgument, problems);
}

absl::Status placed_problem(const std::string& place, absl::string_view text) {
  return problem_status({{place, "", std::string(text)}});
}

absl::Status keyed_problem(const std::string& key, absl::string_view what) {
  return problem_status({{"", key, absl::StrCat(key, ": ", what)}});
}

std::vector<Problem> problems_of(const absl::Status& status) {
  if (status.ok()) return {};
  std::vector<Problem> out;
  if (const auto payload = status.GetPayload(kPayload)) {
    const std::string fields(*payload);
    std::string_view in = fields;
    while (!in.empty()) {
      auto place = read_field(in), key = read_field(in), text = read_field(in);
      if (!place || !key || !text) break;
      out.push_back({*std::move(place), *std::move(key), *std::move(text)});
    }
  }
  if (out.empty()) out.push_back({"", "", std::string(status.message())});
  return out;
}

absl::Status at_key(const std::string& key, const absl::Status& status) {
  if (status.ok()) return status;
  std::vector<Problem> problems = problems_of(status);
  for (Problem& problem : problems)
    problem = {"", key, absl::StrCat(key, ": ", line_of(problem))};
  return status_of(status.code(), problems);
}

bool begins_with_place(const absl::Status& status) {
  const std::vector<Problem> problems = problems_of(status);
  return !problems.empty() && !problems.front().place.empty();
}

void Problems::add(const absl::Status& status) {
  for (Problem& problem : problems_of(status)) add(std::move(problem));
}

}  // namespace irsig

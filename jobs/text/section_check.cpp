#include "jobs/text/section_check.h"

#include <algorithm>
#include <cstdlib>
#include <set>

#include "absl/strings/str_cat.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;

// The errors that are kept of a sweep that has no file.
constexpr std::size_t kMostOfAMessage = 20;

// The line and column at the end of "file:line:column".
std::pair<long, long> place_of(const std::string& location) {
  const std::size_t column = location.rfind(':');
  const std::size_t line = column == std::string::npos ? column : location.rfind(':', column - 1);
  if (line == std::string::npos) return {0, 0};
  return {std::atol(location.c_str() + line + 1), std::atol(location.c_str() + column + 1)};
}

const FieldDescriptor& field_of(const google::protobuf::Message& section, const char* name) {
  const FieldDescriptor* field = section.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr) std::abort();  // a name mistyped in this folder, not in a sweep file
  return *field;
}

bool is_present(const google::protobuf::Message& section, const FieldDescriptor& field) {
  return field.is_repeated() ? section.GetReflection()->FieldSize(section, &field) > 0
                             : section.GetReflection()->HasField(section, &field);
}

std::string list(const SectionCheck::Names& names) {
  return quoted_list(std::vector<std::string>(names.begin(), names.end()));
}

}  // namespace

void Findings::add(const std::string& path, const std::string& what) {
  add({file_.location(path), path, what});
  at_.insert(path);
}

void Findings::add_at(const std::string& place, const std::string& what) { add({place, "", what}); }

void Findings::add(Problem problem) {
  // A sweep without a file has come from somebody else, who may have made any number of errors.
  if (file_.file_name.empty() && found_.size() >= kMostOfAMessage) {
    ++more_;
    return;
  }
  problem.text = one_line(file_.as_written(problem.text));
  if (file_.file_name.empty()) problem.place.clear();
  found_.push_back(std::move(problem));
}

std::string Findings::odd(const std::string& key, const std::string& what) {
  std::string line = one_line(what);
  odd_.emplace(line, key);
  return line;
}

std::string Findings::key_of_odd(const std::string& warning) const {
  const auto found = odd_.find(warning);
  return found == odd_.end() ? "" : found->second;
}

bool Findings::any_at(const std::string& path) const {
  const auto below = [&](char separator) {
    const std::string start = path + separator;
    const auto first = at_.lower_bound(start);
    return first != at_.end() && first->compare(0, start.size(), start) == 0;
  };
  return at_.contains(path) || below('.') || below('[');
}

absl::Status Findings::status() const {
  if (found_.empty()) return absl::OkStatus();
  std::vector<Problem> sorted = found_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    return place_of(a.place) < place_of(b.place);
  });
  Problems out;
  std::set<std::pair<std::string, std::string>> said;
  for (const Problem& problem : sorted)
    if (said.emplace(problem.place, problem.text).second) out.add(problem);
  if (more_ > 0) out.add({"", "", absl::StrCat("and ", more_, " more")});
  return out.status();
}

std::string SectionCheck::path(const std::string& name) const {
  return path_.empty() ? name : absl::StrCat(path_, ".", name);
}

void SectionCheck::error(const char* name, const std::string& what) const { error_at(name, what); }

void SectionCheck::error_at(const std::string& key, const std::string& what) const {
  findings_.add(path(key), absl::StrCat(path(key), " ", what));
}

bool SectionCheck::has(const char* name) const {
  return is_present(section_, field_of(section_, name));
}

double SectionCheck::number(const char* name) const {
  const FieldDescriptor& field = field_of(section_, name);
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return section_.GetReflection()->GetDouble(section_, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return section_.GetReflection()->GetUInt32(section_, &field);
    case FieldDescriptor::CPPTYPE_UINT64:
      return static_cast<double>(section_.GetReflection()->GetUInt64(section_, &field));
    default:
      std::abort();
  }
}

void SectionCheck::require(const Names& names, const std::string& why) const {
  for (const char* name : names) {
    if (!has(name)) error(name, absl::StrCat("is missing, ", why));
  }
}

void SectionCheck::only(const Names& names, const std::string& why) const {
  std::vector<const FieldDescriptor*> present;
  section_.GetReflection()->ListFields(section_, &present);
  for (const FieldDescriptor* field : present) {
    const auto applies = [&](const char* name) { return field->name() == name; };
    if (std::none_of(names.begin(), names.end(), applies)) {
      error(field->name().c_str(),
            absl::StrCat("does not apply ", why, ", expected only ", list(names)));
    }
  }
}

int SectionCheck::at_most_one(const Names& names) const {
  int count = 0;
  const char* first = nullptr;
  for (const char* name : names) {
    if (!has(name)) continue;
    if (++count > 1)
      error(name, absl::StrCat("is stated beside ", first, ", expected only one of ", list(names)));
    else
      first = name;
  }
  return count;
}

void SectionCheck::within(const char* name, double least, double most) const {
  if (has(name) && !(number(name) >= least && number(name) <= most) &&
      !findings_.any_at(path(name))) {
    const double value = number(name), celsius = value + 273.15;
    const bool perhaps_celsius =
        std::string_view(name).ends_with("temperature_k") && celsius >= least && celsius <= most;
    error(name, absl::StrCat("= ", value, ", expected a number from ", least, " to ", most,
                             perhaps_celsius
                                 ? absl::StrCat("; is it in C? ", value, " C are ", celsius, " K")
                                 : ""));
  }
}

bool SectionCheck::one_of(const char* name, const Names& choices) const {
  if (!has(name)) return false;
  const std::string chosen =
      section_.GetReflection()->GetString(section_, &field_of(section_, name));
  for (const char* choice : choices) {
    if (chosen == choice) return true;
  }
  error(name,
        absl::StrCat("= \"", chosen, "\": ",
                     suggestion(chosen, std::vector<std::string>(choices.begin(), choices.end()))));
  return false;
}

}  // namespace irsig

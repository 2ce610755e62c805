#include "core/materials/optical/yaml_block.h"

#include <yaml-cpp/depthguard.h>

#include <algorithm>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace irsig {

std::optional<YAML::Node> load_yaml(std::string_view text, TableErrors& errors) {
  // A list of short numbers takes 240 times its bytes in memory (measured); a table of 100 000 rows
  // of n and k has 3 MB.
  constexpr std::size_t kMostBytes = 4'000'000;
  if (text.size() > kMostBytes) {
    errors.add(1, 1,
               absl::StrCat("the file has ", text.size(), " bytes, expected at most ", kMostBytes));
    return std::nullopt;
  }
  try {
    return YAML::Load(std::string(text));
  } catch (const YAML::DeepRecursion& error) {  // "bad file", says the library
    errors.add(std::max(error.mark.line, 0) + 1, std::max(error.mark.column, 0) + 1,
               absl::StrCat("more than ", error.depth(), " lists or tables in each other"));
    return std::nullopt;
  } catch (const YAML::Exception& error) {  // the library's way to say it; goes no further
    errors.add(std::max(error.mark.line, 0) + 1, std::max(error.mark.column, 0) + 1,
               absl::StrReplaceAll(error.msg, {{"\n", " "}}));
    return std::nullopt;
  }
}

std::vector<std::vector<PlacedNumber>> block_rows(const YAML::Node& block, const YAML::Mark& parent,
                                                  std::string_view text, std::size_t columns,
                                                  TableErrors& errors) {
  std::vector<std::vector<PlacedNumber>> rows;
  if (!block.IsDefined() || !block.IsScalar()) {
    errors.add(parent.line + 1, parent.column + 1, "no table, expected \"data: |\" and its rows");
    return rows;
  }
  const int begin = block.Mark().line;  // of the "|"; the rows stand in the lines below it
  const std::vector<std::string_view> lines = lines_of(text);
  const std::vector<std::string> content = absl::StrSplit(block.Scalar(), '\n');
  bool literal = true;
  for (std::size_t i = 0; i < content.size(); ++i) {
    if (content[i].empty()) continue;
    const std::size_t line = static_cast<std::size_t>(begin) + 1 + i;
    literal = literal && line < lines.size() &&
              lines[line].ends_with(std::string(absl::StripSuffix(content[i], "\r")));
  }
  if (!literal) {
    errors.add(begin + 1, block.Mark().column + 1,
               "a table that is no literal block, expected \"|\" and one row a line");
    return rows;
  }
  for (std::size_t i = 0; i < content.size(); ++i) {
    if (absl::StripAsciiWhitespace(content[i]).empty()) continue;
    const std::size_t line = static_cast<std::size_t>(begin) + 1 + i;
    auto row = number_row(lines[line], static_cast<int>(line) + 1, ' ', columns, errors);
    if (!row.empty()) rows.push_back(std::move(row));
  }
  if (rows.empty() && errors.empty())
    errors.add(begin + 1, block.Mark().column + 1, "an empty table, expected one row a line");
  return rows;
}

}  // namespace irsig

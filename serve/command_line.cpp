#include "serve/command_line.h"

#include <fmt/format.h>

#include <algorithm>

namespace irsig {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_./:=@%+,-").find(c) != std::string_view::npos;
}

// With "=", a value that begins with a hyphen is no option.
std::string option(std::string_view name, const std::string& value) {
  return fmt::format(" --{}{}{}", name, value.starts_with('-') ? "=" : " ", shell_word(value));
}

std::string option(std::string_view name, double value) {
  return option(name, fmt::format("{}", value));
}

std::string quantity_option(SignatureQuantity quantity) {
  return quantity == SignatureQuantity::kIntensity ? ""
                                                   : option("quantity", columns_of(quantity).name);
}

std::string database_word(const std::string& database) {
  return shell_word(database.starts_with('-') ? "./" + database : database);
}

std::string selection_options(const Selection& s) {
  return option("sweep", s.sweep) + option("season", s.season) + option("time", s.time) +
         option("band", s.band) + option("at-range-m", s.at_range_m);
}

}  // namespace

std::string shell_word(std::string_view text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return std::string(text);
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string selection_command(const std::string& database, const Selection& selection,
                              SignatureQuantity quantity) {
  return "irsig query " + database_word(database) + selection_options(selection) +
         quantity_option(quantity) + " --format csv";
}

std::string cut_command(const std::string& database, const Question& question,
                        double elevation_deg) {
  return "irsig plot " + database_word(database) + " --kind polar" +
         option("elevation", elevation_deg) + selection_options(question.a) +
         quantity_option(question.quantity) + " --format csv --out -";
}

std::string left_out_command(const std::string& database, const Question& question) {
  return "irsig plan --refine " + database_word(database) + option("sweep", question.a.sweep) +
         option("at-range-m", question.a.at_range_m) + quantity_option(question.quantity) +
         " --left-out left_out.csv";
}

std::string bands_command(const std::string& database, const Question& question,
                          const std::string& detector) {
  const BandQuestion& b = question.bands;
  const Selection& s = question.a;
  std::string out = "irsig bands " + database_word(database) + option("sweep", s.sweep);
  if (!b.all_conditions) out += option("season", s.season) + option("time", s.time);
  out += option("band", s.band) + option("at-range-m", s.at_range_m);
  if (question.range_m) out += option("range-m", *question.range_m);
  out += detector.empty() ? option("nei", b.nei_w_m2) : option("detector", detector);
  out += option("merit", std::string(name_of(b.merit.merit)));
  if (b.merit.merit == Merit::kPercentile) out += option("percentile", b.merit.percentile);
  if (b.merit.merit == Merit::kAbove) out += option("threshold", b.merit.threshold);
  if (b.clutter) out += " --clutter";
  return out + " --format csv";
}

std::string row_command(const std::string& database, const Question& question, bool spectrum) {
  std::string out = "irsig query " + database_word(database) + option("sweep", question.a.sweep) +
                    fmt::format(" --row {}", question.row.value_or(0));
  if (question.range_m) out += option("range-m", *question.range_m);
  out += quantity_option(question.quantity) + " --causes";
  return out + (spectrum ? " --spectrum --format csv" : " --format json");
}

std::string image_command(const std::string& database, const Question& question) {
  const std::uint64_t row = question.row.value_or(0);
  return "irsig query " + database_word(database) + option("sweep", question.a.sweep) +
         fmt::format(" --row {} --thumbnail row-{}.png", row, row);
}

std::string layer_command(const std::string& database, const Question& question,
                          std::string_view layer) {
  const std::uint64_t row = question.row.value_or(0);
  return "irsig plot " + database_word(database) + " --kind picture" +
         option("sweep", question.a.sweep) +
         fmt::format(" --row {} --layer {} --out row-{}-{}.svg", row, layer, row, layer);
}

std::string counts_command(const std::string& database, const Question& question) {
  const std::uint64_t row = question.row.value_or(0);
  return "irsig plot " + database_word(database) + " --kind picture" +
         option("sweep", question.a.sweep) +
         fmt::format(" --row {} --out row-{}-counts.svg", row, row);
}

std::string explain_command(const std::string& database, const Question& question) {
  return "irsig explain " + database_word(database) + option("sweep", question.a.sweep) +
         fmt::format(" --row {} --format json", question.row.value_or(0));
}

}  // namespace irsig

#include "serve/question.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "absl/strings/numbers.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Takes parameters one by one and remembers the first that is wrong.
class Taker {
 public:
  explicit Taker(const Parameters& parameters) : parameters_(parameters) {
    for (const auto& [name, value] : parameters)
      if (parameters.count(name) > 1) fail(name, value, "it is given twice");
  }

  std::optional<std::string> text(const std::string& name, bool required) {
    known_.insert(name);
    const auto at = parameters_.find(name);
    if (at == parameters_.end() || at->second.empty()) {
      if (required) fail(name, "", "it is missing");
      return std::nullopt;
    }
    return at->second;
  }

  std::optional<double> number(const std::string& name, bool required) {
    const auto given = text(name, required);
    double value = 0;
    if (!given) return std::nullopt;
    if (!absl::SimpleAtod(*given, &value) || !std::isfinite(value)) {
      fail(name, *given, "expected a number");
      return std::nullopt;
    }
    return value;
  }

  std::optional<double> range(const std::string& name, bool required) {
    const auto value = number(name, required);
    if (value && !(*value > 0)) fail(name, fmt::format("{}", *value), "expected more than 0 m");
    return value;
  }

  std::optional<std::uint64_t> count(const std::string& name, bool required) {
    const auto given = text(name, required);
    std::uint64_t value = 0;
    if (!given) return std::nullopt;
    const char* end = given->data() + given->size();
    if (const auto [at, error] = std::from_chars(given->data(), end, value);
        error != std::errc() || at != end || value > (std::uint64_t{1} << 53)) {
      fail(name, *given, "expected a whole number");
      return std::nullopt;
    }
    return value;
  }

  void fail(const std::string& name, const std::string& value, std::string_view why) {
    if (status_.ok())
      status_ = absl::InvalidArgumentError(
          value.empty() ? fmt::format("parameter {}: {}", printable(name), why)
                        : fmt::format("parameter {} = \"{}\": {}", printable(name),
                                      printable(value.substr(0, 200)), why));
  }

  absl::Status finish() {
    for (const auto& [name, value] : parameters_)
      if (!known_.contains(name)) fail(name.substr(0, 200), "", "there is no such parameter here");
    return status_;
  }

 private:
  const Parameters& parameters_;
  std::set<std::string> known_;
  absl::Status status_;
};

std::size_t take_database(Taker& take, const std::string& prefix, std::size_t databases) {
  const std::uint64_t index = take.count(prefix + "db", false).value_or(0);
  if (index >= databases)
    take.fail(prefix + "db", fmt::format("{}", index),
              fmt::format("databases are numbered 0 to {}", databases - 1));
  return index;
}

Selection take_selection(Taker& take, const std::string& prefix, std::size_t databases) {
  Selection out;
  out.database = take_database(take, prefix, databases);
  out.sweep = take.text(prefix + "sweep", true).value_or("");
  out.season = take.text(prefix + "season", true).value_or("");
  out.time = take.text(prefix + "time", true).value_or("");
  out.band = take.text(prefix + "band", true).value_or("");
  out.at_range_m = take.range(prefix + "at_range_m", true).value_or(1);
  return out;
}

BandQuestion take_bands(Taker& take) {
  BandQuestion out;
  out.detector = take.count("detector", false);
  const auto positive = [&](const char* name, double most, double otherwise) {
    const double value = take.number(name, false).value_or(otherwise);
    if (!(value > 0 && value <= most))
      take.fail(name, fmt::format("{}", value),
                fmt::format("expected more than 0, at most {:g}", most));
    return value;
  };
  out.nei_w_m2 = positive("nei_w_m2", 1e6, out.nei_w_m2);
  out.merit.percentile = positive("percentile", 100, out.merit.percentile);
  out.merit.threshold = positive("threshold", 1e30, out.merit.threshold);
  if (const auto name = take.text("merit", false)) {
    // A page shows one range.
    if (const auto merit = merit_named(*name); merit && *merit != Merit::kRange)
      out.merit.merit = *merit;
    else
      take.fail("merit", *name, "expected mean, percentile, worst or above");
  }
  if (const auto asked = take.text("clutter", false)) {
    out.clutter = *asked == "1";
    if (*asked != "0" && *asked != "1") take.fail("clutter", *asked, "expected 0 or 1");
    if (out.clutter) out.merit.ratio = kRatioInClutter;
  }
  if (const auto over = take.text("over", false)) {
    out.all_conditions = *over == "conditions";
    if (*over != "conditions" && *over != "aspects")
      take.fail("over", *over, "expected aspects or conditions");
  }
  return out;
}

void take_image(Taker& take, Question& out) {
  if (const auto name = take.text("layer", false)) {
    out.layer = image_layer_of(*name);
    out.counts = *name == "counts";
    std::string names = "counts";
    for (const ImageLayerInfo& layer : kImageLayers) names += fmt::format(", {}", layer.name);
    if (!out.layer && !out.counts) take.fail("layer", *name, "expected one of " + names);
  }
  if (const auto asked = take.text("stderr", false)) {
    out.stderr_of_image = *asked == "1";
    if (*asked != "0" && *asked != "1") take.fail("stderr", *asked, "expected 0 or 1");
  }
}

}  // namespace

absl::StatusOr<Question> parse_question(const Parameters& parameters, Needs needs,
                                        std::size_t databases) {
  Taker take(parameters);
  Question out;
  if (needs != Needs::kNothing) {
    if (const auto name = take.text("quantity", false)) {
      const auto quantity = quantity_named(*name);
      if (quantity.ok())
        out.quantity = *quantity;
      else
        take.fail("quantity", *name, std::string(quantity.status().message()));
    }
  }
  if (needs == Needs::kSelection || needs == Needs::kBoth || needs == Needs::kBands)
    out.a = take_selection(take, "", databases);
  if (needs == Needs::kSelection) out.elevation_deg = take.number("elevation_deg", false);
  if (needs == Needs::kBands) out.bands = take_bands(take);
  const bool of_row = needs == Needs::kRow || needs == Needs::kImage;
  if (needs == Needs::kBands || of_row) out.range_m = take.range("range_m", false);
  if (needs == Needs::kBoth) out.b = take_selection(take, "b_", databases);
  if (needs == Needs::kImage) take_image(take, out);
  if (of_row) {
    out.a.database = take_database(take, "", databases);
    out.a.sweep = take.text("sweep", true).value_or("");
    out.row = take.count("row", true);
  }
  RETURN_IF_ERROR(take.finish());
  return out;
}

ValueFilter value_filter(const Selection& selection, SignatureQuantity quantity) {
  return {selection.sweep, selection.season,     selection.time,
          selection.band,  selection.at_range_m, quantity};
}

Query selection_query(const Selection& selection, SignatureQuantity quantity) {
  Query out;
  out.sweep = selection.sweep;
  out.season = selection.season;
  out.time = selection.time;
  out.band = selection.band;
  out.at_range_m = selection.at_range_m;
  out.quantity = quantity;
  return out;
}

Query row_query(const Question& question) {
  Query out;
  out.sweep = question.a.sweep;
  out.row = question.row;
  if (question.range_m) out.range_m = {*question.range_m};
  out.quantity = question.quantity;
  return out;
}

}  // namespace irsig

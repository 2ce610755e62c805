#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/bands/band_tables.h"

namespace irsig {
namespace {

// A page waits for an answer: a second for a thousand, or for a hundred that are moved.
constexpr std::size_t kMostRows = 5000, kMostMoved = 400;
constexpr std::size_t kCompared = 10;

struct Answer {
  BandSearch search;
  BandSearch::Found found;
  schema::Accuracy accuracy;  // of the sweep
  std::size_t matching;       // rows, of which those of the search are some
};

std::string detector_file(const PageSources& sources, const Question& q) {
  return q.bands.detector ? sources.detector[*q.bands.detector].path : "";
}

absl::StatusOr<Answer> search_of(const PageSources& sources, const Question& q) {
  if (q.bands.detector && *q.bands.detector >= sources.detector.size())
    return absl::InvalidArgumentError(
        fmt::format("parameter detector = \"{}\": this page has {} (irsig serve --detector FILE)",
                    *q.bands.detector, sources.detector.size()));
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  Query query = selection_query(q.a, q.quantity);
  if (q.bands.all_conditions) query.season = query.time = {};
  if (q.range_m) query.range_m = {*q.range_m};
  ASSIGN_OR_RETURN(
      const auto some,
      run_query_of_some(*reader, query, q.range_m ? kMostMoved : kMostRows, sources.extent_of));
  if (some.rows.empty()) return absl::NotFoundError("nothing is stored (yet) of this band");
  ASSIGN_OR_RETURN(auto population,
                   band_population(*reader, some.rows, nullptr, {}, AspectWeight::kSolidAngle, {},
                                   q.bands.clutter));
  const Detector detector = q.bands.detector ? sources.detector[*q.bands.detector].detector
                                             : Detector{{}, ConstantNoise{q.bands.nei_w_m2}};
  ASSIGN_OR_RETURN(auto search, BandSearch::make(std::move(population), detector));
  ASSIGN_OR_RETURN(const auto sweep, reader->sweep(q.a.sweep, SweepFiles::kNone));
  auto found = search.search(q.bands.merit, search.step_um(), kCompared);
  return Answer{std::move(search), std::move(found), sweep.resolved.sweep().accuracy(),
                some.matching};
}

std::string windows(const BandSearch& search, const std::vector<Candidate>& map) {
  std::vector<std::uint64_t> first, last;
  std::vector<double> merit;
  for (const Candidate& c : map) {
    first.push_back(c.one.first);
    last.push_back(c.one.last);
    merit.push_back(c.merit);
  }
  JsonObject out;
  out.numbers("edge_um", {search.edges_um().begin(), search.edges_um().end()});
  out.counts("first", first);
  out.counts("last", last);
  out.numbers("merit", merit);
  return out.finish();
}

std::string best(const BandSearch& search, const WindowChoice& choice) {
  std::vector<double> low, high, merit, error, probability, as_good;
  for (const CandidateMerit& m : choice.candidate) {
    low.push_back(search.lambda_min_um(m.of.one));
    high.push_back(search.lambda_max_um(m.of.one));
    merit.push_back(m.of.merit);
    error.push_back(m.total_error);
    probability.push_back(m.best);
    as_good.push_back(m.as_good);
  }
  JsonObject out;
  out.numbers("lambda_min_um", low);
  out.numbers("lambda_max_um", high);
  out.numbers("merit", merit);
  out.numbers("total_error", error);
  out.numbers("best", probability);
  out.numbers("as_good", as_good);
  return out.finish();
}

}  // namespace

absl::StatusOr<PageReply> answer_bands(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto made, search_of(sources, q));
  const WindowChoice choice = made.search.compare(q.bands.merit, made.found.best);
  JsonObject out;
  out.text("title", merit_name(q.bands.merit));
  out.text("detector", q.bands.detector ? sources.detector[*q.bands.detector].name
                                        : fmt::format("NEI {:g} W/m2", q.bands.nei_w_m2));
  out.count("rows", made.search.population().row.size());
  if (q.range_m) out.number("range_m", *q.range_m);
  out.json("window", windows(made.search, made.found.map));
  out.json("best", best(made.search, choice));
  const BandPopulation& population = made.search.population();
  std::vector<std::string> notes = notes_on(choice, population, made.accuracy);
  if (population.row.size() < made.matching)
    notes.push_back(
        fmt::format("{} of {} rows, drawn at random, which is not in the margins: the "
                    "command takes all",
                    population.row.size(), made.matching));
  out.texts("notes", notes);
  out.text("command", bands_command(sources.database[q.a.database], q, detector_file(sources, q)));
  return json_reply(out.finish());
}

absl::StatusOr<std::string> bands_csv(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto made, search_of(sources, q));
  std::ostringstream out;
  RETURN_IF_ERROR(write_map(made.search, q.bands.merit, made.found, "csv", out));
  return out.str();
}

absl::StatusOr<std::string> bands_svg(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto made, search_of(sources, q));
  return plot_map_of_windows(made.search, q.bands.merit, made.found,
                             fmt::format("Windows of {}", q.a.band));
}

}  // namespace irsig

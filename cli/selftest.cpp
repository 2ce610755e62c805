#include "verify/cases/selftest.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "runner/job_runner.h"
#include "verify/search/honesty_search.h"

namespace irsig {
namespace {

struct SelftestOptions {
  bool hard = false, search = false, full = false, csv = false, no_shrink = false;
  std::string filter = "*", seeds, failures = "search-failures", record;
  int invariances = -1;
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
};

// Scenes of the short search, which each change has to pass, and of the full search, which is run
// now and then.
constexpr std::uint64_t kShortSearch = 60, kFullSearch = 2000;

// Reads seeds in the form "7" or "1..60".
bool read_seeds(const std::string& text, SearchOptions& out) {
  const char* end = text.data() + text.size();
  auto [after, error] = std::from_chars(text.data(), end, out.first);
  if (error != std::errc()) return false;
  out.last = out.first;
  if (after == end) return true;
  if (end - after < 3 || after[0] != '.' || after[1] != '.') return false;
  const auto last = std::from_chars(after + 2, end, out.last);
  return last.ec == std::errc() && last.ptr == end && out.first <= out.last &&
         out.last - out.first < 1'000'000;
}

absl::Status append_record(const std::string& path, const std::string& line) {
  std::error_code unknown;  // then opening says why
  const bool is_new = !std::filesystem::exists(path, unknown);
  std::ofstream file(path, std::ios::app);
  if (is_new) file << record_header();
  file << line;
  file.close();
  if (!file)
    return absl::UnavailableError(
        absl::StrCat("--record ", path, ": cannot be written: ", std::strerror(errno)));
  return absl::OkStatus();
}

int search_scenes(const SelftestOptions& given) {
  SearchOptions options;
  options.last = given.full ? kFullSearch : kShortSearch;
  if (!given.seeds.empty() && !read_seeds(given.seeds, options))
    return report(absl::InvalidArgumentError(absl::StrCat(
        "selftest: --seeds \"", given.seeds, "\", expected a number or a range as 1..60")));
  if (given.full) {
    options.grammar.best_relative_error = 0.001;
    options.grammar.max_samples_per_replicate = 65536;
    options.most_reference_rays = 10'000'000;
    options.invariances = kInvariances;
  }
  if (given.invariances >= 0) options.invariances = std::min(given.invariances, kInvariances);
  options.threads = given.threads;
  options.family = given.filter;
  options.failures = given.failures;
  if (given.no_shrink) options.shrink_trials = 0;
  const std::size_t scenes = seeds_of(options).size();
  if (scenes == 0)
    return report(absl::InvalidArgumentError(absl::StrCat("selftest: --cases \"", given.filter,
                                                          "\" matches no family of these scenes")));
  std::printf("determinism class: %s\nseeds %llu..%llu, bound %.2f errors\n",
              determinism_class().c_str(), static_cast<unsigned long long>(options.first),
              static_cast<unsigned long long>(options.last), failure_bound(options));
  const auto start = std::chrono::steady_clock::now();
  std::size_t count = 0;  // of scenes done
  const SearchSummary summary = search(options, [&](const SceneVerdict& verdict, double bound) {
    ++count;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const JudgedValue* worst = verdict.worst();
    if (!verdict.status.ok() || verdict.undecided ||
        (worst != nullptr && !(std::abs(worst->deviation()) <= 5)) || given.csv)
      std::printf("%s\n", verdict_line(verdict, bound).c_str());
    std::fflush(stdout);
    std::fprintf(stderr, "%llu of %llu scenes, %.0f s, %.0f s left\n",
                 static_cast<unsigned long long>(count), static_cast<unsigned long long>(scenes),
                 seconds,
                 seconds / static_cast<double>(count) * static_cast<double>(scenes - count));
  });
  std::printf("%s", summary_text(summary).c_str());
  if (!given.record.empty())
    if (const absl::Status status = append_record(given.record, record_line(summary, options));
        !status.ok())
      return report(status);
  return summary.failed().empty() && summary.spread().holds() &&
                 20 * summary.undecided() <= summary.scene.size()
             ? 0
             : 1;
}

int selftest(const SelftestOptions& given) {
  if (given.hard == given.search)
    return report(absl::InvalidArgumentError("selftest: expected --hard or --search"));
  if (given.search) return search_scenes(given);
  const std::vector<HardCase> cases = matching(hard_cases(), given.filter);
  if (cases.empty())
    return report(absl::InvalidArgumentError(absl::StrCat(
        "selftest: --cases \"", given.filter,
        "\" matches no case (groups: planck, geometry, "
        "materials, transport, sun_and_frames, atmosphere, honesty, sums, determinism)")));
  if (!given.csv) std::printf("determinism class: %s\n", determinism_class().c_str());
  std::printf("%s\n", (given.csv ? csv_header() : table_header()).c_str());
  std::size_t failed = 0;
  double seconds = 0;
  for (const HardCase& c : cases) {
    std::fflush(stdout);  // before a case starts child processes
    const auto start = std::chrono::steady_clock::now();
    CaseResult result{c, c.run(given.full ? Effort::kFull : Effort::kShort)};
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%s\n", (given.csv ? csv_row(result) : table_row(result)).c_str());
    failed += result.passed() ? 0 : 1;
    seconds += result.seconds;
  }
  if (!given.csv) std::printf("%zu cases, %zu failed, %.0f s\n", cases.size(), failed, seconds);
  return failed == 0 ? 0 : 1;
}

}  // namespace

void add_selftest(CLI::App& app, int& exit_code) {
  const auto given = std::make_shared<SelftestOptions>();
  CLI::App* command = app.add_subcommand(
      "selftest",
      "Run the cases on which radiometric codes break, on this machine, or look for new ones");
  command->add_flag("--hard", given->hard, "The stability suite");
  command->add_flag("--search", given->search,
                    "Random scenes, judged by another integrator: is any error bar broken?");
  command->add_flag("--full", given->full,
                    "--hard: 1e8 rays, 1e9 terms; --search: 2000 scenes, errors down to 0.1 %");
  command->add_option("--seeds", given->seeds, "--search: which scenes, 7 or 1..60");
  command->add_option("--invariances", given->invariances,
                      "--search: of each scene, so many of 8 changes that must change nothing");
  command->add_option("--failures", given->failures,
                      "--search: folder for scenes that fail, made smaller; empty: none");
  command->add_option("--record", given->record,
                      "--search: a CSV file to which the counts are added");
  command->add_flag("--no-shrink", given->no_shrink, "--search: they are written as they are");
  command->add_option("--threads", given->threads, "--search: at most so many threads")
      ->check(CLI::Range(1, 256));
  command->add_option(
      "--cases", given->filter,
      "Only cases that match: planck, transport/*, *vertex*; --search: families, *mirror*");
  command->add_flag("--csv", given->csv, "The same as --format csv");
  command->callback([given, &exit_code] { exit_code = selftest(*given); });
}

}  // namespace irsig

#include "core/stability/selftest.h"

#include <chrono>
#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "bridge/job_runner.h"
#include "cli/commands.h"

namespace irsig {
namespace {

struct SelftestOptions {
  bool hard = false, full = false, csv = false;
  std::string filter = "*";
};

int selftest(const SelftestOptions& given) {
  const std::vector<HardCase> cases = matching(hard_cases(), given.filter);
  if (cases.empty())
    return report(absl::InvalidArgumentError(
        absl::StrCat("selftest: --filter \"", given.filter,
                     "\" matches no case (groups: planck, geometry, "
                     "materials, transport, sun_and_frames, atmosphere, sums, determinism)")));
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
      "selftest", "Run the cases on which radiometric codes break, on this machine");
  command->add_flag("--hard", given->hard, "The stability suite")->required();
  command->add_flag("--full", given->full, "The long counts: 1e8 rays, 1e9 terms");
  command->add_option("--filter", given->filter,
                      "Only cases that match: planck, transport/*, *vertex*");
  command->add_flag("--csv", given->csv, "Comma-separated values instead of a table");
  command->callback([given, &exit_code] { exit_code = selftest(*given); });
}

}  // namespace irsig

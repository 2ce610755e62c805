#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/commands.h"
#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "planning/accuracy_check.h"
#include "planning/accuracy_source.h"
#include "planning/accuracy_study.h"
#include "planning/mesh_study.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"

namespace irsig {
namespace {

struct AccuracyOptions {
  std::string source, sweep, out, aspect;
  AccuracyRows rows;
  bool check_errors = false;
  ErrorCheckAsked check;
  MeshStudyAsked mesh;
  std::optional<std::string> meshes;
  std::optional<std::uint64_t> views;
};

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

absl::Status make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return absl::InvalidArgumentError(absl::StrCat("--out ", path, ": ", error.message()));
  return absl::OkStatus();
}

std::string title(const std::string& sweep, const StudiedRow& r) {
  return fmt::format("{}, {} ({}), {}, aspect {:.4g}, {:.4g} deg, {:.4g} km", sweep, r.season,
                     r.time_utc, r.band, r.aspect_azimuth_deg, r.aspect_elevation_deg,
                     r.range_m / 1000);
}

const std::vector<std::string>& legend() {
  static const std::vector<std::string> lines = {
      "Every point: root mean square of the relative error over independent seeds, against CPU "
      "time of "
      "this process, tracing and shading of one row alone (set-up stands in the tables). The "
      "reference is "
      "ours with many more samples and other seeds; its own error is the grey band, below which "
      "nothing "
      "is known.",
      "Plain Monte Carlo: every stored wavelength is traced by itself with pseudo-random numbers; "
      "rays are "
      "aimed at the bounding rectangle of the target; no strata and no aiming at hot parts; one "
      "path for "
      "each ray, which survives a reflection with a probability of its reflectance. Kept to its "
      "advantage: "
      "directions drawn from the lobe with the right density, a ray aimed at the sun's disk at "
      "each "
      "reflection, the same ray tracer and quadrature.",
      "Ours: one set of paths for all wavelengths, 32 replicates; rays aimed at the cells that the "
      "target "
      "covers, strata for hot parts, which are aimed at too; the first reflection splits in two.",
      "Whole runs: what a sweep of this row alone would do for an asked relative error, with the "
      "effects that the error calls for or with all; in the others every effect is on.",
      "Precomputation model: two flat areas behind homogeneous air, against our apparent "
      "intensity. It has no "
      "aspect, sky, sea or sun: its distance is a bias, not an error that time would mend."};
  return lines;
}

absl::Status write_study(const AccuracyOptions& given) {
  ASSIGN_OR_RETURN(auto source, load_accuracy_source(given.source, given.sweep));
  RETURN_IF_ERROR(have_temperatures(source.loaded));
  const LoadedSweep* loaded = &source.loaded;
  ASSIGN_OR_RETURN(const auto studied, study_accuracy(*loaded, given.rows));
  RETURN_IF_ERROR(make_folder(given.out));
  const std::filesystem::path out = given.out;
  const std::string& name = loaded->resolved.sweep().name();
  std::string csv = accuracy_csv_header(), markdown;
  std::vector<PageSection> sections{{"What is shown", legend(), "", {}}};
  for (const StudiedRow& row : studied) {
    const std::string heading = title(name, row);
    PageSection section{heading, row.paragraph,
                        plot_work_precision(heading, row.paragraph.front(), row.panel, 2),
                        row.table};
    const std::filesystem::path svg = out / fmt::format("accuracy-{}-{}.svg", name, row.band);
    RETURN_IF_ERROR(replace_file(svg.string(), section.svg));
    csv += row.csv;
    absl::StrAppend(&markdown, "### ", heading, "\n\n", row.paragraph.front(), "\n\n",
                    markdown_tables(row.table));
    print_text("{}\n\n{}\n\n{}", heading, row.paragraph.front(), markdown_tables(row.table));
    sections.push_back(std::move(section));
  }
  for (const auto& [file, bytes] :
       {std::pair{"accuracy.csv", csv}, std::pair{"accuracy.md", markdown},
        std::pair{"accuracy.html", html_page("What accuracy costs: " + name, sections)}})
    RETURN_IF_ERROR(replace_file((out / file).string(), bytes));
  return absl::OkStatus();
}

absl::Status check_errors(const AccuracyOptions& given, bool& within) {
  ASSIGN_OR_RETURN(auto source, load_accuracy_source(given.source, given.sweep));
  if (source.database == nullptr)
    return absl::InvalidArgumentError(absl::StrCat("--check-errors: ", given.source,
                                                   " is no database, expected the rows of one"));
  print_text("{}\n", kNotSeenByLongerRun);
  const auto checked = check_database_errors(source, given.check, [](const CheckedViewpoint& view) {
    print_note("{} of {}: viewpoint {}, {:.3g} primary rays, {} rows, largest {:.2f}\n", view.done,
               view.of, view.viewpoint, view.samples, view.intensity.values,
               view.intensity.largest);
  });
  if (!checked.ok()) return checked.status();
  print_text(
      "{}: {} rows of {} viewpoints against a run {:.4g} times as long with other random numbers\n"
      "\n{}",
      source.loaded.resolved.sweep().name(), checked->rows.size(), checked->views, checked->times,
      stated_errors_table(checked->rows));
  within = true;
  for (std::size_t q = 0; q < kStated; ++q)
    within &= summary_of(checked->rows, static_cast<Stated>(q)).beyond_5 == 0;
  return absl::OkStatus();
}

absl::Status study_meshes(const AccuracyOptions& given) {
  ASSIGN_OR_RETURN(const auto source, load_accuracy_source(given.source, given.sweep));
  MeshStudyAsked asked = given.mesh;
  asked.meshes = *given.meshes;
  asked.rows = given.rows;
  asked.views = given.views.value_or(asked.views);
  const auto compared =
      compare_meshes(source.loaded, asked, process_cpu_s, [](const MeasuredMesh& mesh) {
        print_note("{}: {} facets, {} views\n", mesh.name, mesh.facets, mesh.view.size());
      });
  if (!compared.ok()) return compared.status();
  const std::string tables = mesh_tables(*compared);
  print_text("{}", tables);
  if (given.out.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto csv, mesh_csv(*compared));
  RETURN_IF_ERROR(make_folder(given.out));
  const std::filesystem::path out = given.out;
  for (const auto& [file, bytes] : {std::pair{"meshes.csv", csv}, std::pair{"meshes.md", tables}})
    RETURN_IF_ERROR(replace_file((out / file).string(), bytes));
  return absl::OkStatus();
}

absl::Status write_page(AccuracyOptions given) {
  if (given.out.empty())
    return absl::InvalidArgumentError(
        "accuracy: expected --out DIR, --check-errors or --meshes LIST");
  if (!given.aspect.empty()) {
    const std::vector<std::string> numbers = absl::StrSplit(given.aspect, ',');
    std::array<double, 2> aspect{};
    if (numbers.size() != 2 || !absl::SimpleAtod(numbers[0], &aspect[0]) ||
        !absl::SimpleAtod(numbers[1], &aspect[1]) || !(aspect[0] >= 0 && aspect[0] < 360) ||
        !(aspect[1] >= -90 && aspect[1] <= 90))
      return absl::InvalidArgumentError(
          absl::StrCat("--aspect ", given.aspect,
                       ": expected AZ,EL in degrees, 0 <= AZ < 360, -90 <= EL <= 90, e.g. 45,10"));
    given.rows.aspect_deg = aspect;
  }
  return write_study(given);
}

int run(AccuracyOptions given) {
  if (given.views && !given.check_errors && !given.meshes)
    return report(
        absl::InvalidArgumentError("accuracy: --views needs --check-errors or --meshes LIST"));
  if (given.meshes) return report(study_meshes(given));
  if (!given.check_errors) return report(write_page(given));
  given.check.views = given.views.value_or(0);
  bool within = false;
  const absl::Status status = check_errors(given, within);
  return status.ok() ? (within ? 0 : 1) : report(status);
}

}  // namespace

void add_accuracy(CLI::App& app, int& exit_code) {
  const auto given = std::make_shared<AccuracyOptions>();
  CLI::App* command = app.add_subcommand(
      "accuracy",
      "Measure what accuracy costs in time: errors of all methods against CPU time, and "
      "what a mesh is worth. With --check-errors, hold the stated errors of a database "
      "against runs 100 times as long.");
  command->add_option("SWEEP|DB", given->source, "Sweep file, or a database with its sweep")
      ->required();
  command->add_option("--sweep", given->sweep, "Name of the sweep, where a database holds several")
      ->type_name("NAME");
  CLI::Option* out =
      command->add_option("-o,--out", given->out, "Folder for the page, pictures and numbers")
          ->type_name("FOLDER");
  command->add_option("--season", given->rows.season, "Name of the season (default: the first)")
      ->type_name("NAME");
  command
      ->add_option("--time", given->rows.time,
                   "Time, RFC 3339 with any offset (default: the first)")
      ->type_name("TIME");
  command->add_option("--band", given->rows.band, "Name of the band (default: each)")
      ->type_name("NAME");
  CLI::Option* aspect =
      command
          ->add_option("--aspect", given->aspect,
                       "Direction from the target to the sensor (default: the middle viewpoint)")
          ->type_name("AZ,EL");
  CLI::Option* seconds =
      command->add_option("--seconds", given->rows.seconds, "CPU time to spend on tracing")
          ->check(CLI::Range(1.0, 36000.0))
          ->capture_default_str();
  CLI::Option* rays =
      command
          ->add_option("--primary-rays", given->rows.primary_rays,
                       "Primary rays to spend on it instead: the same points on any machine")
          ->check(CLI::Range(1e3, 1e12))
          ->excludes(seconds);
  CLI::Option* check =
      command
          ->add_flag(
              "--check-errors", given->check_errors,
              "Instead of the page: are the errors that a database states true? Its values "
              "against a longer run. Exit code 1: one is off by more than 5 numerical errors")
          ->excludes(out);
  CLI::Option* meshes =
      command
          ->add_option("--meshes", given->meshes,
                       "Instead of the page: the same views on meshes of other densities, and how "
                       "far they deviate. Factors on the triangles of a generated model (0.5,1,2), "
                       "or files instead of the model's")
          ->type_name("LIST")
          ->excludes(check)
          ->excludes(aspect)
          ->excludes(seconds)
          ->excludes(rays);
  command
      ->add_option("--relative-error", given->mesh.relative_error,
                   "With it: wanted of every in-band intensity, instead of the sweep's [accuracy]")
      ->check(CLI::Range(1e-6, 1.0))
      ->needs(meshes);
  command
      ->add_option("--views", given->views,
                   "With --meshes or --check-errors: viewpoints, spread (default: 8; all)")
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--times", given->check.times,
                   "With --check-errors: samples of the longer run, over those "
                   "of the rows' own")
      ->check(CLI::Range(4.0, 10000.0))
      ->capture_default_str()
      ->needs(check);
  command
      ->add_option("--workers", given->check.workers,
                   "With --check-errors: worker threads (default: one for each core)")
      ->check(CLI::Range(1, 4096))
      ->needs(check);
  command->callback([given, &exit_code] { exit_code = run(*given); });
}

}  // namespace irsig

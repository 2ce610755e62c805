#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "verify/search/random_scene.h"

namespace irsig {

// `irsig selftest --search`: random scenes (random_scene.h). Each is computed by this program as
// any sweep is (parsed, resolved, run as a job), and judged by an independent integrator
// (verify/reference/reference_view.h) and by changes that must not alter it.

// A scene as a sweep, and its files.
struct SceneSweep {
  schema::ResolvedSweep sweep;
  Assets assets;
};
[[nodiscard]] absl::StatusOr<SceneSweep> sweep_of(const RandomScene& scene);

// Changes that must change no number by more than its error.
enum class Invariance {
  kTurned,      // the world, about the vertical
  kRaised,      // the sensor, by 1 mm
  kSplitBand,   // the sum of two halves
  kSubdivided,  // every facet into four
  kSplitParts,  // every part into two, of other names
  kMirrored,    // left for right
  kAllEffects,  // instead of automatic ones
  kOtherSeed
};
inline constexpr int kInvariances = 8;
[[nodiscard]] const char* name_of(Invariance invariance);
[[nodiscard]] RandomScene changed(const RandomScene& scene, Invariance by);

// One stored in-band value and its expected value.
struct JudgedValue {
  std::string what;  // "total", "apparent", "contrast"; of which band; "turned: total" ...
  double value = 0, error = 0;        // numerical error, stated
  double truth = 0, truth_error = 0;  // one sigma
  bool by_reference = true;           // else by an invariance
  bool statistical = false;           // its error is mostly standard error, bounds below a tenth
  bool accuracy_reached = false;
  // Returns (value - truth) / (root sum of squares of both errors).
  [[nodiscard]] double deviation() const;
};

struct SceneVerdict {
  std::uint64_t seed = 0;
  SceneFamily family = SceneFamily::kBodies;
  absl::Status status;  // not OK: the scene could not be computed, which counts as a failure
  std::vector<JudgedValue> value;
  // True if the reference did not reach a fifth of the stated errors within its budget of rays, and
  // nothing failed.
  bool undecided = false;
  std::uint64_t program_rays = 0, reference_rays = 0;
  [[nodiscard]] const JudgedValue* worst() const;  // null: none
};

struct SearchOptions {
  std::uint64_t first = 1, last = 60;  // seeds
  std::string family = "*";            // only scenes whose family matches
  SceneGrammar grammar;
  std::uint64_t most_reference_rays = 6'000'000;  // of a scene
  int invariances = 2;                            // of each scene, in rotation; kInvariances: all
  std::size_t threads = 1;
  // Folder for failing scenes, made smaller; empty: none. The field below limits the trials for
  // smaller scenes.
  std::string failures;
  int shrink_trials = 40;
};

// Returns the seeds of the search's scenes.
[[nodiscard]] std::vector<std::uint64_t> seeds_of(const SearchOptions& options);

// Judges one scene.
[[nodiscard]] SceneVerdict judge(const RandomScene& scene, const SearchOptions& options);

// Returns the bound on |deviation| for a search: student_t_bound(1 - 0.0005 / values) with 31
// degrees of freedom. values: number of values that the reference judges in the search's scenes.
[[nodiscard]] double failure_bound(const SearchOptions& options);

// Returns a simpler scene that still fails: fewer bodies, simpler materials, one band ... Stops
// after at most most_trials judgements.
[[nodiscard]] RandomScene shrunk(const RandomScene& scene,
                                 const std::function<bool(const RandomScene&)>& fails,
                                 int most_trials);

struct SearchSummary {
  std::vector<SceneVerdict> scene;   // by seed
  std::vector<std::string> written;  // files of failing scenes
  double bound = 0;
  [[nodiscard]] std::vector<const SceneVerdict*> failed() const;
  [[nodiscard]] std::size_t undecided() const;
  // Root mean square of the deviations whose error is mostly statistical: 1.03 for Student's t of
  // 31 degrees of freedom. Above `most` (3.5 standard deviations of the rms, scenes as units)
  // standard errors are too small, even if no deviation exceeds the bound.
  struct Spread {
    std::size_t scenes = 0, values = 0, beyond_2 = 0;
    double rms = 0, most = 0;
    [[nodiscard]] bool holds() const { return scenes == 0 || rms <= most; }
  };
  [[nodiscard]] Spread spread() const;
};

// Judges all scenes of a search. done: called after each scene, from one thread at a time.
[[nodiscard]] SearchSummary search(
    const SearchOptions& options,
    const std::function<void(const SceneVerdict&, double bound)>& done);

// Returns a verdict in one line. summary_text() returns the summary of a search: failures, values
// beyond 5, histogram, counts.
[[nodiscard]] std::string verdict_line(const SceneVerdict& verdict, double bound);
[[nodiscard]] std::string summary_text(const SearchSummary& summary);
// Returns a line of the file that collects the counts of all searches
// (docs/evidence/stability-search.csv).
[[nodiscard]] std::string record_header();
[[nodiscard]] std::string record_line(const SearchSummary& summary, const SearchOptions& options);

}  // namespace irsig

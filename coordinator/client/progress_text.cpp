#include "coordinator/client/progress_text.h"

#include <cmath>

#include "fmt/format.h"

namespace irsig {

std::string_view state_name(schema::WorkerStatus::State state) {
  switch (state) {
    case schema::WorkerStatus::STATE_IDLE:
      return "idle";
    case schema::WorkerStatus::STATE_COMPUTING:
      return "computing";
    case schema::WorkerStatus::STATE_SET_ASIDE:
      return "set aside";
    default:
      return "";
  }
}

std::string duration_text(double seconds) {
  const auto total = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  const long long hours = total / 3600, minutes = total / 60 % 60, rest = total % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, rest);
  return fmt::format("{}:{:02}", minutes, rest);
}

std::string count_text(double count, std::string_view noun) {
  for (const auto& [scale, prefix] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}}) {
    if (count >= scale) return fmt::format("{:.3g} {}{}", count / scale, prefix, noun);
  }
  return fmt::format("{:.3g} {}", count, noun);
}

std::uint64_t settled_jobs(const schema::SweepStatus& sweep) {
  return sweep.done() + sweep.quarantined() + sweep.cancelled();
}

std::string SweepWatch::text(const schema::SweepStatus& sweep, std::uint32_t workers,
                             double seconds) {
  if (!rated_) {
    view_.done_before = sweep.done();
    view_.rays_before = sweep.rays();
    start_s_ = seconds;
    rated_ = sweep.heat_done() >= sweep.heat_jobs();
  }
  view_.elapsed_s = seconds - start_s_;
  view_.workers = workers;
  return progress_text(sweep, view_);
}

std::string progress_text(const schema::SweepStatus& sweep, const ProgressView& view) {
  const std::uint64_t settled = settled_jobs(sweep);
  const std::uint64_t left = sweep.jobs() > settled ? sweep.jobs() - settled : 0;
  std::string text;
  if (sweep.heat_done() < sweep.heat_jobs()) {
    // No time is predicted here: the time of heat jobs does not tell the time of views.
    text = fmt::format("temperatures {} of {}, then {} views", sweep.heat_done(), sweep.heat_jobs(),
                       sweep.jobs() - sweep.heat_jobs());
  } else {
    text = fmt::format("jobs {}/{}", sweep.done(), sweep.jobs());
    if (sweep.done() > view.done_before && view.elapsed_s > 0) {
      const auto here = static_cast<double>(sweep.done() - view.done_before);
      const auto rays = sweep.rays() > view.rays_before
                            ? static_cast<double>(sweep.rays() - view.rays_before)
                            : 0;
      text += fmt::format("  {}/s", count_text(rays / view.elapsed_s, "rays"));
      text += fmt::format("  {} left",
                          duration_text(view.elapsed_s / here * static_cast<double>(left)));
    }
    if (sweep.done() > sweep.heat_done())
      text += fmt::format("  worst error {:.2g} %", 100 * sweep.worst_relative_error());
  }
  if (sweep.quarantined() > 0) text += fmt::format("  {} failed", sweep.quarantined());
  text += fmt::format("  {} worker{}", view.workers, view.workers == 1 ? "" : "s");
  return text;
}

}  // namespace irsig

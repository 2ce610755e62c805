#include "core/signature/aim_at_bright.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/accuracy/pilot_samples.h"
#include "core/accuracy/replicates.h"
#include "core/signature/row_bounds/row_bounds.h"
#include "core/signature/view_seed.h"

namespace irsig {
namespace {

constexpr double kWorth = 4;         // times fewer samples
constexpr double kMaskExcess = 1.5;  // what a group's mask covers / what is seen of its facets
constexpr double kBounded = 0.1;     // of the error

// A group's facets with the rectangle of their middles on the image plane.
struct Group {
  std::vector<std::uint32_t> facet;
  double x_min = 1e300, x_max = -1e300, y_min = 1e300, y_max = -1e300;
  double covered_m2 = 0, mask_m2 = 0;  // of facets; of the cells that they touch, about
  [[nodiscard]] double longest() const { return std::max(x_max - x_min, y_max - y_min); }
};

class Grouping {
 public:
  Grouping(const Target& target, const ViewFrame& frame) : target_(target), frame_(frame) {}

  [[nodiscard]] Group make(std::vector<std::uint32_t> facets) const {
    Group out;
    out.facet = std::move(facets);
    double around_m = 0, area_m2 = 0;
    for (const std::uint32_t f : out.facet) {
      Place corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = place(f, k);
        out.x_min = std::min(out.x_min, corner[k].x);
        out.x_max = std::max(out.x_max, corner[k].x);
        out.y_min = std::min(out.y_min, corner[k].y);
        out.y_max = std::max(out.y_max, corner[k].y);
      }
      for (std::size_t k = 0; k < 3; ++k)
        around_m +=
            std::hypot(corner[(k + 1) % 3].x - corner[k].x, corner[(k + 1) % 3].y - corner[k].y);
      area_m2 += 0.5 * std::abs((corner[1].x - corner[0].x) * (corner[2].y - corner[0].y) -
                                (corner[1].y - corner[0].y) * (corner[2].x - corner[0].x));
    }
    const double cell_m = out.longest() / 128;
    out.covered_m2 = area_m2;
    out.mask_m2 = std::min(
        area_m2 + around_m * cell_m + static_cast<double>(out.facet.size()) * cell_m * cell_m,
        (out.x_max - out.x_min) * (out.y_max - out.y_min));
    return out;
  }

  // Halved across its longer side; false: all middles lie on one side.
  [[nodiscard]] bool halve(const Group& group, Group& low, Group& high) const {
    const bool along_x = group.x_max - group.x_min >= group.y_max - group.y_min;
    const double middle =
        along_x ? 0.5 * (group.x_min + group.x_max) : 0.5 * (group.y_min + group.y_max);
    std::vector<std::uint32_t> below, above;
    for (const std::uint32_t f : group.facet) {
      double at = 0;
      for (std::size_t k = 0; k < 3; ++k) at += (along_x ? place(f, k).x : place(f, k).y) / 3;
      (at < middle ? below : above).push_back(f);
    }
    if (below.empty() || above.empty()) return false;
    low = make(std::move(below));
    high = make(std::move(above));
    return true;
  }

 private:
  struct Place {
    double x, y;
  };
  [[nodiscard]] Place place(std::uint32_t facet, std::size_t k) const {
    const float* v =
        target_.vertex.data() +
        3 * static_cast<std::size_t>(target_.triangle[3 * static_cast<std::size_t>(facet) + k]);
    const Vec<Body> q = Vec<Body>{v[0], v[1], v[2]} - frame_.sensor;
    const double scale = frame_.plane_m / dot(q, frame_.forward);
    return {scale * dot(q, frame_.right), scale * dot(q, frame_.up)};
  }

  const Target& target_;
  const ViewFrame& frame_;
};

}  // namespace

BrightFacets choose_bright(const Target& target, const AimedView& view,
                           std::vector<FacetBrightness> facets) {
  BrightFacets out;
  // Hot parts have strata already; past what hides them they may be much smaller.
  for (const PartSpec& part : target.part) out.past_others |= part.hot;

  std::erase_if(facets, [](const FacetBrightness& b) { return !(b.per_m2 > 0); });
  std::sort(facets.begin(), facets.end(), [](const FacetBrightness& a, const FacetBrightness& b) {
    return a.per_m2 != b.per_m2 ? a.per_m2 > b.per_m2 : a.facet < b.facet;
  });
  std::size_t first = 0;
  for (double sent = 0; first < facets.size(); ++first) {
    sent += facets[first].per_m2 * facets[first].seen_m2;
    if (sent > kBounded) break;
  }
  if (first == facets.size()) return out;
  const double mask_m2 = view.stratum[0].area_m2() * std::pow(view.range_m / view.frame.plane_m, 2);
  const double brightest = facets[first].per_m2, together = mask_m2 * brightest;
  double least = together, seen_m2 = 0;
  std::size_t count = 0;
  for (std::size_t k = first; k < facets.size(); ++k) {
    seen_m2 += facets[k].seen_m2;
    const double next = k + 1 < facets.size() ? facets[k + 1].per_m2 : 0;
    const double apart = mask_m2 * next + kMaskExcess * seen_m2 * brightest;
    if (apart >= least) continue;
    least = apart;
    count = k + 1 - first;
  }
  if (count == 0 || kWorth * least > together) return out;

  std::vector<std::uint32_t> chosen;
  for (std::size_t k = 0; k < first + count; ++k) chosen.push_back(facets[k].facet);
  std::sort(chosen.begin(), chosen.end());
  const Grouping grouping(target, view.frame);
  std::vector<Group> groups;
  {
    // One of several parts may be much brighter than the others: they stand apart, if there are
    // few.
    std::vector<std::vector<std::uint32_t>> of_part(target.part.size());
    for (const std::uint32_t f : chosen) of_part[target.facet[f].part].push_back(f);
    std::erase_if(of_part, [](const auto& part) { return part.empty(); });
    if (of_part.size() > kMostGroups) of_part.assign(1, std::move(chosen));
    for (auto& part : of_part) groups.push_back(grouping.make(std::move(part)));
  }
  while (groups.size() < kMostGroups) {
    const auto widest =
        std::max_element(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
          return a.mask_m2 - a.covered_m2 < b.mask_m2 - b.covered_m2;
        });
    if (!(widest->mask_m2 > kMaskExcess * widest->covered_m2)) break;
    Group low, high;
    if (!grouping.halve(*widest, low, high)) break;
    *widest = std::move(low);
    groups.push_back(std::move(high));
  }
  out.past_others = true;
  for (Group& group : groups) out.group.push_back(std::move(group.facet));
  return out;
}

namespace {

std::uint64_t more(std::uint64_t samples) { return samples + samples / 2; }

// A stratum's pilot, and what it would bring to the square of each row's error. [row]
struct SharedStratum {
  std::uint32_t index = 0;
  double samples = 0, rays = 0;  // of the pilot
  std::vector<double> stderr_;
  std::uint64_t given = 0;
  std::vector<double> now, next;  // with those that are given, and with more

  [[nodiscard]] std::vector<double> variance(const MeasuredView& view,
                                             std::uint64_t of_samples) const {
    std::vector<double> out;
    for (std::size_t row = 0; row < stderr_.size(); ++row)
      out.push_back(
          stderr_[row] * stderr_[row] * samples / static_cast<double>(of_samples) +
          std::pow(undersampling_error_w_sr(view.setup, view.row[row], index, of_samples), 2));
    return out;
  }
  void give(const MeasuredView& view, std::uint64_t of_samples) {
    given = of_samples;
    now = next.empty() ? variance(view, given) : std::move(next);
    next = variance(view, more(given));
  }
};

}  // namespace

SharedOut share_out(MeasuredView& view, std::uint64_t& pilot_rays) {
  const AimedView& aimed = view.setup.aimed();
  std::vector<SharedStratum> strata;
  std::vector<double> goal(view.row.size(), 0.0), floor(view.row.size(), 0.0),
      bias(view.row.size(), 0.0);
  for (std::uint32_t s = 0; s < aimed.stratum.size(); ++s) {
    if (aimed.stratum[s].empty()) continue;
    run_stratum(view, s, kFirstPilotSamples, kFirstPilotStage);
    pilot_rays += view.totals.counts.rays;
    SharedStratum& of = strata.emplace_back();
    of.index = s;
    of.samples = static_cast<double>(aimed.samples(s, kFirstPilotSamples));
    of.rays = static_cast<double>(view.totals.counts.rays);
    for (std::size_t row = 0; row < view.row.size(); ++row) {
      of.stderr_.push_back(view.row[row].estimate.total.stderr_);
      goal[row] += relative_goal_w_sr(view, view.row[row]);
      floor[row] += absolute_floor_w_sr(view, view.row[row]);
      const Measured source = measured(view, view.row[row]).source;
      bias[row] += source.bias_bound() - source.of(BoundOf::kUnseen) - source.of(BoundOf::kOmitted);
    }
  }
  std::vector<double> wanted2;
  for (std::size_t row = 0; row < view.row.size(); ++row) {
    const double omitted = measured(view, view.row[row]).source.of(BoundOf::kOmitted);
    wanted2.push_back(std::pow(
        kSharedAim * stderr_wanted(std::max(goal[row], floor[row]), bias[row] + omitted), 2));
  }
  for (SharedStratum& of : strata) of.give(view, kLeastShared);
  constexpr int kMostSteps = 256;
  for (int step = 0; step < kMostSteps; ++step) {
    std::size_t worst = 0;
    double most = 1;
    for (std::size_t row = 0; row < wanted2.size(); ++row) {
      double sum = 0;
      for (const SharedStratum& of : strata) sum += of.now[row];
      if (sum > most * wanted2[row]) {
        most = wanted2[row] > 0 ? sum / wanted2[row] : std::numeric_limits<double>::infinity();
        worst = row;
      }
    }
    if (most <= 1) break;
    SharedStratum* best = nullptr;
    double gain = 0;
    for (SharedStratum& of : strata) {
      if (more(of.given) > kMostOfStratum) continue;
      const double per_ray = (of.now[worst] - of.next[worst]) * of.samples /
                             (of.rays * static_cast<double>(more(of.given) - of.given));
      if (per_ray <= gain) continue;
      gain = per_ray;
      best = &of;
    }
    if (best == nullptr) break;
    best->give(view, more(best->given));
  }
  SharedOut out;
  out.samples = kLeastShared;
  for (const SharedStratum& of : strata)
    if (of.index == 0) out.samples = of.given;
  out.share.assign(aimed.stratum.size(), 1.0);
  for (const SharedStratum& of : strata) {
    out.share[of.index] = static_cast<double>(of.given) / static_cast<double>(out.samples);
    out.rays += of.rays * static_cast<double>(of.given) / of.samples;
  }
  return out;
}

}  // namespace irsig

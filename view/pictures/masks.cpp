#include "view/pictures/masks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace irsig {
namespace {

// [pixel] Samples that meet the parts.
template <typename Has>
std::vector<std::uint32_t> counts_of(const StoredSilhouette& in, Has&& has) {
  std::vector<std::uint32_t> out(std::size_t{in.width_px} * in.height_px, 0);
  for (const StoredSilhouette::Part& part : in.part)
    if (has(part.name))
      for (const StoredSilhouette::Pixel& p : part.pixel) out[p.at] += p.samples;
  return out;
}

struct Corner {
  double x, y;
};
double turn(Corner a, Corner b, Corner c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// By Andrew's monotone chain. `all` in the order of x, then y.
std::vector<Corner> hull_of(const std::vector<Corner>& all) {
  std::vector<Corner> out;
  const auto add = [&](Corner c, std::size_t fixed) {
    while (out.size() >= fixed + 2 && turn(out[out.size() - 2], out.back(), c) <= 0) out.pop_back();
    out.push_back(c);
  };
  for (const Corner c : all) add(c, 0);
  const std::size_t fixed = out.size() - 1;
  for (auto c = all.rbegin() + 1; c != all.rend(); ++c) add(*c, fixed);
  out.pop_back();
  return out;
}

// One side of the smallest rectangle around a hull lies along one of its edges.
std::array<double, 8> smallest_rectangle(const std::vector<Corner>& hull) {
  std::array<double, 8> out{};
  double smallest = -1;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Corner a = hull[i], b = hull[(i + 1) % hull.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const Corner u{(b.x - a.x) / length, (b.y - a.y) / length};
    double low = 0, high = 0, far = 0;
    for (const Corner c : hull) {
      const double along = (c.x - a.x) * u.x + (c.y - a.y) * u.y;
      low = std::min(low, along);
      high = std::max(high, along);
      far = std::max(far, (c.y - a.y) * u.x - (c.x - a.x) * u.y);
    }
    if (smallest >= 0 && (high - low) * far >= smallest) continue;
    smallest = (high - low) * far;
    const Corner first{a.x + low * u.x, a.y + low * u.y},
        second{a.x + high * u.x, a.y + high * u.y};
    out = {first.x,
           first.y,
           second.x,
           second.y,
           second.x - far * u.y,
           second.y + far * u.x,
           first.x - far * u.y,
           first.y + far * u.x};
  }
  return out;
}

}  // namespace

std::vector<float> filled_fractions(const StoredSilhouette& silhouette) {
  std::vector<float> out;
  for (const std::uint32_t count : counts_of(silhouette, [](const std::string&) { return true; }))
    out.push_back(static_cast<float>(count) / static_cast<float>(silhouette.pixel_samples));
  return out;
}

ImageContent covered_pixels(const StoredSilhouette& silhouette) {
  return content_of({silhouette.width_px, silhouette.height_px, filled_fractions(silhouette)});
}

std::vector<std::uint16_t> part_mask(const StoredSilhouette& silhouette,
                                     const std::vector<std::string>& parts) {
  const std::vector<std::uint32_t> all =
      counts_of(silhouette, [](const std::string&) { return true; });
  std::vector<std::uint16_t> out(all.size(), 0);
  std::vector<std::uint16_t> most(all.size(), 0);
  for (const StoredSilhouette::Part& part : silhouette.part) {
    const auto place = std::find(parts.begin(), parts.end(), part.name) - parts.begin();
    for (const StoredSilhouette::Pixel& p : part.pixel) {
      if (2 * all[p.at] < silhouette.pixel_samples || p.samples <= most[p.at]) continue;
      most[p.at] = p.samples;
      out[p.at] = static_cast<std::uint16_t>(1 + place);
    }
  }
  return out;
}

namespace {

//   count  [pixel] samples that meet the object
std::optional<SeenObject> object_of(const StoredSilhouette& silhouette,
                                    const std::vector<std::uint32_t>& count) {
  SeenObject out;
  std::uint32_t most = 0;
  for (const std::uint32_t c : count) {
    out.area_px += static_cast<double>(c) / silhouette.pixel_samples;
    most = std::max(most, c);
  }
  if (most == 0) return std::nullopt;
  const bool any = 2 * most < silhouette.pixel_samples;
  const auto inside = [&](std::uint32_t x, std::uint32_t y) {
    const std::uint32_t c = count[std::size_t{y} * silhouette.width_px + x];
    return any ? c > 0 : 2 * c >= silhouette.pixel_samples;
  };
  std::uint32_t right = 0, bottom = 0, run = 0;
  out.left_px = silhouette.width_px;
  out.top_px = silhouette.height_px;
  bool within = false;
  std::vector<Corner> corners;  // of the first and last pixel of each column
  for (std::uint32_t x = 0; x < silhouette.width_px; ++x) {
    std::uint32_t first = silhouette.height_px, last = 0;
    for (std::uint32_t y = 0; y < silhouette.height_px; ++y) {
      const bool here = inside(x, y);
      if (here != within) {
        out.runs.push_back(run);
        run = 0;
        within = here;
      }
      ++run;
      if (!here) continue;
      first = std::min(first, y);
      last = y;
    }
    if (first > last) continue;
    out.left_px = std::min(out.left_px, x);
    right = x;
    out.top_px = std::min(out.top_px, first);
    bottom = std::max(bottom, last);
    for (const double side : {0.0, 1.0})
      for (const double end : {static_cast<double>(first), last + 1.0})
        corners.push_back({x + side, end});
  }
  out.runs.push_back(run);
  out.width_px = right - out.left_px + 1;
  out.height_px = bottom - out.top_px + 1;
  const auto before = [](Corner a, Corner b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); };
  const auto same = [](Corner a, Corner b) { return a.x == b.x && a.y == b.y; };
  std::sort(corners.begin(), corners.end(), before);
  corners.erase(std::unique(corners.begin(), corners.end(), same), corners.end());
  out.rectangle_px = smallest_rectangle(hull_of(corners));
  return out;
}

}  // namespace

std::optional<SeenObject> seen_object(const StoredSilhouette& silhouette,
                                      const std::function<bool(const std::string&)>& has) {
  return object_of(silhouette, counts_of(silhouette, has));
}

std::optional<WholeObject> whole_object(const StoredSilhouette& silhouette, const SeenObject& seen,
                                        const std::function<bool(const std::string&)>& has) {
  std::vector<std::uint32_t> count(std::size_t{silhouette.width_px} * silhouette.height_px, 0);
  double outside_px = 0;
  for (const StoredSilhouette::PartSet& set : silhouette.part_set) {
    if (std::none_of(set.part.begin(), set.part.end(), has)) continue;
    outside_px += set.outside_px;
    for (const StoredSilhouette::Pixel& p : set.pixel) count[p.at] += p.samples;
  }
  auto mask = object_of(silhouette, count);
  if (!mask) return std::nullopt;
  WholeObject out{*std::move(mask)};
  const double whole_px = out.mask.area_px;
  out.occlusion = std::max(0.0, 1 - seen.area_px / whole_px);
  out.truncation = outside_px / (outside_px + whole_px);
  return out;
}

}  // namespace irsig

#include "core/thermal/scene/exchange_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/sobol.h"
#include "core/thermal/scene/aimed_rays.h"

namespace irsig {
namespace {

// An aimed ray counts as so many others: their places are spread evenly over what they are aimed
// at, while how many of a thousand small facets' own rays meet one face is left to chance.
constexpr double kAimedCounts = 8;

// Number of parts of a face, 4 x 4, which are equally large.
constexpr std::size_t kFaceParts = 16;
using OfParts = std::array<double, kFaceParts>;

std::size_t part_of(SamplePair at) {
  const auto quarter = [](float u) { return std::min(3, static_cast<int>(4 * u)); };
  return static_cast<std::size_t>(4 * quarter(at.x) + quarter(at.y));
}

// Sums over the exposed places of a face.
class PlaceSums {
 public:
  void clear() {
    sum_.fill(0);
    square_.fill(0);
  }
  void add(std::size_t part, double value) {
    sum_[part] += value;
    square_[part] += value * value;
  }

  // Root of the variance between the means of the parts, less what chance makes of them.
  //   exposed  rays from each part that do not begin inside a body
  //   all      what sums are divided by for the mean of the face
  [[nodiscard]] double uneven(const OfParts& exposed, double all) const {
    const double variance = between(exposed, all, [&](std::size_t b, double weight, double) {
      return square_[b] / (all * all * weight);
    });
    return std::sqrt(std::max(0.0, variance));
  }
  // Returns the unevenness of fractions of these rays: 0 where it may be chance alone (less than 1
  // in 100 000 for rays that are independent of each other; these nearly are).
  [[nodiscard]] double uneven_fraction(const OfParts& exposed) const {
    constexpr double kBeyondChance = 4;  // chi-square of 15
    const double rays = std::accumulate(exposed.begin(), exposed.end(), 0.0);
    double chance = 0;
    const double variance = between(exposed, rays, [&](std::size_t, double, double share) {
      chance += share * (1 - share) / rays;
      return share * (1 - share) / rays;
    });
    return variance > (kBeyondChance - 1) * chance ? std::sqrt(variance) : 0;
  }

 private:
  // chance(part, its weight, its mean): what is taken off.
  template <typename Chance>
  [[nodiscard]] double between(const OfParts& exposed, double all, const Chance& chance) const {
    const double rays = std::accumulate(exposed.begin(), exposed.end(), 0.0);
    double mean = 0, out = 0, parts = 0;
    for (const double sum : sum_) mean += sum / all;
    for (std::size_t b = 0; b < kFaceParts; ++b) parts += exposed[b] > 0 ? 1 : 0;
    for (std::size_t b = 0; b < kFaceParts; ++b) {
      if (exposed[b] == 0) continue;
      const double weight = exposed[b] / rays, of_part = sum_[b] / (all * weight),
                   off = of_part - mean;
      out += weight * off * off * parts / std::max(parts - 1, 1.0) - chance(b, weight, of_part);
    }
    return out;
  }
  OfParts sum_{}, square_{};
};

struct Entry {
  std::uint32_t from, to;
  double m2;  // of what they exchange: exposed area x share
};

// Two unit vectors beside n [duff2017].
void frame_of(FaceNormal n, FaceNormal& a, FaceNormal& b) {
  const float sign = std::copysign(1.0f, n.z);
  const float c = -1 / (sign + n.z), d = n.x * n.y * c;
  a = {1 + sign * n.x * n.x * c, sign * d, -sign * n.x};
  b = {d, sign + n.y * n.y * c, -n.y};
}

class RowTracer {
 public:
  RowTracer(const Target& target, const ThermalFaces& faces, const ExchangeSettings& settings)
      : target_(target),
        faces_(faces),
        settings_(settings),
        aimed_(target, faces, settings.beyond_w_m2, settings.rays / 2),
        surface_z_(static_cast<float>(settings.surface_z_m - target.centre.z)) {}

  // Counts of a face's rays; `entry` gets a row of what they find.
  void trace(std::uint32_t face, std::vector<Entry>& entry, ExchangeFactors& out) {
    const std::uint64_t seed = mix64(settings_.seed ^ mix64(face + 1ULL));
    const SeedPair place = seed_pair(seed, 0), way = seed_pair(seed, 1);
    const FaceNormal n = normal_of(target_, faces_, face);
    FaceNormal a{}, b{};
    frame_of(n, a, b);
    met_.clear();
    for (PlaceSums* places : {&sky_, &lower_, &aims_}) places->clear();
    exposed_.fill(0);
    for (auto* of_block : {&sky_block_, &lower_block_, &all_block_}) of_block->fill(0);
    hit_.clear();
    std::uint32_t to_sky = 0, to_lower = 0, buried = 0;
    each_packet(
        settings_.rays,
        [&](std::uint32_t i, int lane) {
          const SamplePair at = sobol_pair_shuffled(i, place), to = sobol_pair(i, way);
          part_[static_cast<std::size_t>(lane)] = part_of(at);
          const float radius = std::sqrt(to.x), angle = 2 * std::numbers::pi_v<float> * to.y;
          const float x = radius * std::cos(angle), y = radius * std::sin(angle),
                      z = std::sqrt(1 - to.x);
          set_ray(lane, point_of(target_, faces_, face, at.x, at.y),
                  {x * a.x + y * b.x + z * n.x, x * a.y + y * b.y + z * n.y,
                   x * a.z + y * b.z + z * n.z});
        },
        [&](std::uint32_t i, int lane) {
          const std::size_t part = part_[static_cast<std::size_t>(lane)],
                            block = kBlocks * i / settings_.rays;
          const bool misses = packet_.triangle[lane] == RayPacket::kMiss;
          exposed_[part] += 1;
          ++all_block_[block];
          if (misses && packet_.dir_z[lane] < 0) {
            ++to_sky;
            ++sky_block_[block];
            sky_.add(part, 1);
          } else if (misses || is_below(lane)) {
            ++to_lower;
            ++lower_block_[block];
            lower_.add(part, 1);
          } else if (const std::uint32_t to = face_met(lane); to == ThermalFaces::kNone) {
            ++buried;
            --all_block_[block];
            exposed_[part] -= 1;
          } else {
            meet(face, n, to, lane, 1);
            // Aimed rays measure the exchange with aims.
            const bool aimed = aimed_.rays(face) > 0 && aimed_.is_aim(to);
            hit_.emplace_back(aimed ? ThermalFaces::kNone : to, block);
          }
        });
    out.exposed[face] = 1 - static_cast<float>(buried) / static_cast<float>(settings_.rays);
    // Such a small number is rounding where two bodies touch.
    if (32 * buried > 31 * settings_.rays) {
      out.exposed[face] = 0;
      return;
    }
    if (settings_.keep_hits) keep_hits(face, out);
    if (aimed_.rays(face) > 0) out.aimed_stderr_w_m2[face] = aim(face, n, seed) / out.exposed[face];
    if (!met_.empty()) {
      out.uneven_sky[face] = static_cast<float>(sky_.uneven_fraction(exposed_));
      out.uneven_lower[face] = static_cast<float>(lower_.uneven_fraction(exposed_));
      out.uneven_aims_w_m2[face] = static_cast<float>(
          aims_.uneven(exposed_, faces_.area_m2[face] * static_cast<double>(out.exposed[face])));
    }
    const double share = 1.0 / (settings_.rays - buried);
    out.sky[face] = static_cast<float>(share * to_sky);
    out.lower[face] = static_cast<float>(share * to_lower);
    std::sort(met_.begin(), met_.end());
    for (std::size_t i = 0; i < met_.size();) {
      const std::uint32_t to = met_[i].first;
      double sum_m2 = 0;
      for (; i < met_.size() && met_[i].first == to; ++i) sum_m2 += met_[i].second;
      entry.push_back({face, to, sum_m2});
    }
  }

 private:
  static constexpr std::size_t kBlocks = ExchangeFactors::kBlocks;

  void keep_hits(std::uint32_t face, ExchangeFactors& out) {
    for (std::size_t b = 0; b < kBlocks; ++b) {
      out.sky_hits[face * kBlocks + b] = sky_block_[b];
      out.lower_hits[face * kBlocks + b] = lower_block_[b];
      out.all_hits[face * kBlocks + b] = all_block_[b];
    }
    std::sort(hit_.begin(), hit_.end());
    for (std::size_t i = 0; i < hit_.size();) {
      const auto [to, block] = hit_[i];
      std::uint16_t count = 0;
      for (; i < hit_.size() && hit_[i] == std::pair{to, block}; ++i) ++count;
      out.hit.push_back({to, static_cast<std::uint16_t>(block), count});
    }
  }

  // Rays 0 to count: set(ray, lane), then found(ray, lane) of what they have met.
  template <typename Set, typename Found>
  void each_packet(std::uint32_t rays, const Set& set, const Found& found) {
    for (std::uint32_t begin = 0; begin < rays; begin += RayPacket::kSize) {
      const int count = static_cast<int>(std::min<std::uint32_t>(RayPacket::kSize, rays - begin));
      for (int lane = 0; lane < RayPacket::kSize; ++lane)
        set(begin + static_cast<std::uint32_t>(std::min(lane, count - 1)), lane);
      target_.tracer->intersect(packet_, count, true);
      for (int lane = 0; lane < count; ++lane)
        found(begin + static_cast<std::uint32_t>(lane), lane);
    }
  }
  void set_ray(int lane, FacePoint from, FaceNormal direction) {
    packet_.org_x[lane] = from.x;
    packet_.org_y[lane] = from.y;
    packet_.org_z[lane] = from.z;
    packet_.dir_x[lane] = direction.x;
    packet_.dir_y[lane] = direction.y;
    packet_.dir_z[lane] = direction.z;
    packet_.tnear[lane] = packet_.time[lane] = 0;
    packet_.tfar[lane] = std::numeric_limits<float>::infinity();
    packet_.mask[lane] = 0xffffffffu;
    packet_.flags[lane] = 0;
    packet_.triangle[lane] = packet_.geometry[lane] = packet_.instance[lane] = RayPacket::kMiss;
  }
  [[nodiscard]] bool is_below(int lane) const {
    return packet_.org_z[lane] + packet_.tfar[lane] * packet_.dir_z[lane] > surface_z_;
  }

  // Rays from places of the face to places of what it aims at. Returns aimed_stderr_w_m2 of a face
  // that is exposed.
  float aim(std::uint32_t face, const FaceNormal& n, std::uint64_t seed) {
    const SeedPair here = seed_pair(seed, 2), there = seed_pair(seed, 3),
                   which = seed_pair(seed, 4);
    std::array<std::uint32_t, RayPacket::kSize> to{};
    constexpr std::uint32_t kParts = 8;
    std::array<double, kParts> w{};
    aimed_.start(face);
    each_packet(
        aimed_.rays(face),
        [&](std::uint32_t i, int lane) {
          std::uint32_t& aim = to[static_cast<std::size_t>(lane)];
          aim = aimed_.pick(sobol_pair_shuffled(i, which).x);
          const SamplePair at = sobol_pair_shuffled(i, here), on = sobol_pair_shuffled(i, there);
          part_[static_cast<std::size_t>(lane)] = part_of(at);
          const FacePoint from = point_of(target_, faces_, face, at.x, at.y),
                          end = point_of(target_, faces_, aim, on.x, on.y);
          // The face itself, not beside it, where a ray that grazes it would meet the next one.
          const FaceNormal m = normal_of(target_, faces_, aim);
          const auto off = static_cast<float>(target_.offset_m());
          FaceNormal way{end.x - off * m.x - from.x, end.y - off * m.y - from.y,
                         end.z - off * m.z - from.z};
          const float length = std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
          if (length > 0 && way.x * n.x + way.y * n.y + way.z * n.z > 0) {
            way = {way.x / length, way.y / length, way.z / length};
          } else {
            aim = ThermalFaces::kNone;
            way = n;
          }
          set_ray(lane, from, way);
        },
        [&](std::uint32_t i, int lane) {
          const std::uint32_t aim = to[static_cast<std::size_t>(lane)];
          if (aim == ThermalFaces::kNone || packet_.triangle[lane] == RayPacket::kMiss ||
              face_met(lane) != aim || is_below(lane))
            return;
          const double m2 = meet(face, n, aim, lane, kAimedCounts);
          w[kParts * i / aimed_.rays(face)] += settings_.beyond_w_m2[aim] * m2;
        });
    double sum = 0, square = 0;
    for (const double part : w) {
      sum += part;
      square += part * part;
    }
    const double off = std::max(0.0, kParts * square - sum * sum) / (kParts - 1);
    return static_cast<float>(std::sqrt(off) / faces_.area_m2[face]);
  }

  // Returns the exchange that a ray which joins two faces stands for: the inverse of the density of
  // all rays that might have joined them there. The places on this face take the density of all
  // rays from here.
  //   counts  this ray's
  double meet(std::uint32_t from, const FaceNormal& n, std::uint32_t to, int lane, double counts) {
    const double from_m2 = faces_.area_m2[from], to_m2 = faces_.area_m2[to];
    double from_here = settings_.rays / from_m2, from_there = settings_.rays / to_m2;
    if (from != to && (aimed_.is_aim(to) || aimed_.is_aim(from))) {
      const FaceNormal other = normal_of(target_, faces_, to);
      const auto cosine = [&](const FaceNormal& m) {
        return std::abs(static_cast<double>(m.x * packet_.dir_x[lane] + m.y * packet_.dir_y[lane] +
                                            m.z * packet_.dir_z[lane]));
      };
      const double r_m = static_cast<double>(packet_.tfar[lane]),
                   per_m2 = cosine(n) * cosine(other) / (std::numbers::pi * r_m * r_m),
                   each = kAimedCounts / (from_m2 * to_m2 * per_m2);
      from_here += each * aimed_.rays_to(from, to);
      from_there += each * aimed_.rays_to(to, from);
    }
    const double m2 = counts / (from_here + from_there);
    met_.emplace_back(to, m2);
    if (aimed_.is_aim(to))
      aims_.add(part_[static_cast<std::size_t>(lane)],
                settings_.beyond_w_m2[to] * counts / from_here);
    return m2;
  }

  // kNone: from behind, and it has no back.
  std::uint32_t face_met(int lane) {
    const auto behind = [&] {
      const Target::Facet& f = target_.facet[packet_.triangle[lane]];
      return f.nx * packet_.dir_x[lane] + f.ny * packet_.dir_y[lane] + f.nz * packet_.dir_z[lane] >=
             0;
    };
    if (!behind()) return packet_.triangle[lane];
    const std::uint32_t back = faces_.back_of_facet[packet_.triangle[lane]];
    if (back != ThermalFaces::kNone) return back;
    return target_.tracer->look_for_front(packet_, lane, static_cast<float>(target_.offset_m()))
               ? packet_.triangle[lane]
               : ThermalFaces::kNone;
  }

  const Target& target_;
  const ThermalFaces& faces_;
  const ExchangeSettings& settings_;
  AimedRays aimed_;
  float surface_z_;
  RayPacket packet_{};
  std::array<std::size_t, RayPacket::kSize> part_{};  // of the face, where each ray begins
  OfParts exposed_{};                                 // of the rays that are not aimed
  std::array<std::uint16_t, kBlocks> sky_block_{}, lower_block_{}, all_block_{};
  std::vector<std::pair<std::uint32_t, std::size_t>> hit_;  // face, block
  PlaceSums sky_, lower_, aims_;
  std::vector<std::pair<std::uint32_t, double>> met_;  // face, exchanged_m2
};

// Returns for each face whether all of the target lies behind its plane, within the rounding of the
// target's coordinates: such a face sees nothing of the target and is not seen by it. [face]
std::vector<bool> faces_that_see_nothing(const Target& target, const ThermalFaces& faces) {
  constexpr std::size_t kMostProducts = 1'000'000'000;  // half a second
  const std::size_t vertices = target.vertex.size() / 3;
  std::vector<bool> out(faces.size(), target.convex);
  if (target.convex || faces.size() > kMostProducts / std::max<std::size_t>(1, vertices))
    return out;
  const auto allowed = static_cast<float>(0.5 * target.offset_m());
  const auto above = [&](const FaceNormal& n, float level, std::size_t v) {
    const float* at = target.vertex.data() + 3 * v;
    return n.x * at[0] + n.y * at[1] + n.z * at[2] - level > allowed;
  };
  std::size_t last = 0;  // the vertex that told the face before
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    if (faces.area_m2[face] <= 0) continue;
    const FaceNormal n = normal_of(target, faces, face);
    const float* corner = target.vertex.data() +
                          3 * static_cast<std::size_t>(
                                  target.triangle[3 * static_cast<std::size_t>(faces.facet[face])]);
    const float level = n.x * corner[0] + n.y * corner[1] + n.z * corner[2];
    if (vertices > 0 && above(n, level, last)) continue;
    std::size_t v = 0;
    while (v < vertices && !above(n, level, v)) ++v;
    out[face] = v == vertices;
    if (v < vertices) last = v;
  }
  return out;
}

// d_i: d_i d_j S_ij and d_i x what leaves the target add up to the area of i.
std::vector<double> scaled_rows(const ThermalFaces& faces, const ExchangeFactors& rows,
                                const std::vector<double>& share) {
  std::vector<double> scale(faces.size(), 1.0), sum(faces.size());
  for (int round = 0; round < 200; ++round) {
    double worst = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      sum[i] = static_cast<double>(rows.sky[i]) + static_cast<double>(rows.lower[i]);
      for (std::size_t k = rows.first[i]; k < rows.first[i + 1]; ++k)
        sum[i] += share[k] * scale[rows.to[k]];
      sum[i] *= scale[i];
      if (sum[i] > 0) worst = std::max(worst, std::abs(sum[i] - 1));
    }
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (sum[i] > 0) scale[i] /= std::sqrt(sum[i]);
    if (worst < 1e-7) break;
  }
  return scale;
}

}  // namespace

ExchangeFactors exchange_factors(const Target& target, const ThermalFaces& faces,
                                 const ExchangeSettings& settings) {
  ExchangeFactors out;
  const std::size_t count = faces.size();
  out.sky.assign(count, 0);
  out.lower.assign(count, 0);
  out.exposed.assign(count, 1);
  for (auto* of_face :
       {&out.uneven_sky, &out.uneven_lower, &out.uneven_aims_w_m2, &out.aimed_stderr_w_m2})
    of_face->assign(count, 0);
  std::vector<Entry> entry;
  RowTracer tracer(target, faces, settings);
  if (settings.keep_hits) {
    for (auto* of_block : {&out.sky_hits, &out.lower_hits, &out.all_hits})
      of_block->assign(count * ExchangeFactors::kBlocks, 0);
    out.first_hit.push_back(0);
  }
  const std::vector<bool> sees_nothing = faces_that_see_nothing(target, faces);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (sees_nothing[i]) {
      out.sky[i] = std::clamp(0.5f * (1 - normal_of(target, faces, i).z), 0.0f, 1.0f);  // z is down
      out.lower[i] = 1 - out.sky[i];
    } else if (faces.area_m2[i] > 0) {
      tracer.trace(i, entry, out);
    }
    if (settings.keep_hits) out.first_hit.push_back(out.hit.size());
  }
  out.first.assign(count + 1, 0);
  if (entry.empty()) return out;

  const auto exposed_m2 = [&](std::uint32_t i) {
    return faces.area_m2[i] * static_cast<double>(out.exposed[i]);
  };
  // Faces that are not exposed exchange nothing.
  std::erase_if(entry,
                [&](const Entry& e) { return out.exposed[e.from] <= 0 || out.exposed[e.to] <= 0; });
  // Add both ways of each pair.
  const std::size_t one_way = entry.size();
  entry.reserve(2 * one_way);
  for (std::size_t k = 0; k < one_way; ++k)
    entry.push_back({entry[k].to, entry[k].from, entry[k].m2});
  std::sort(entry.begin(), entry.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.from, a.to, a.m2) < std::tie(b.from, b.to, b.m2);
  });
  if (entry.empty()) return out;
  std::vector<double> share;
  for (std::size_t k = 0; k < entry.size();) {
    const Entry& e = entry[k];
    double sum_m2 = 0;
    while (k < entry.size() && entry[k].from == e.from && entry[k].to == e.to)
      sum_m2 += entry[k++].m2;
    out.to.push_back(e.to);
    // For a face with itself both ways are the same one.
    share.push_back((e.from == e.to ? 0.5 : 1) * sum_m2 / exposed_m2(e.from));
    ++out.first[e.from + 1];
  }
  for (std::size_t i = 0; i < count; ++i) out.first[i + 1] += out.first[i];
  const std::vector<double> scale = scaled_rows(faces, out, share);
  out.share.resize(share.size());
  for (std::size_t i = 0; i < count; ++i) {
    double sum = scale[i] * (static_cast<double>(out.sky[i]) + static_cast<double>(out.lower[i]));
    for (std::size_t k = out.first[i]; k < out.first[i + 1]; ++k)
      sum += share[k] *= scale[i] * scale[out.to[k]];
    const double to_one = sum > 0 ? 1 / sum : 0;
    for (std::size_t k = out.first[i]; k < out.first[i + 1]; ++k)
      out.share[k] = static_cast<float>(to_one * share[k]);
    out.sky[i] = static_cast<float>(to_one * scale[i] * static_cast<double>(out.sky[i]));
    out.lower[i] = static_cast<float>(to_one * scale[i] * static_cast<double>(out.lower[i]));
  }
  return out;
}

}  // namespace irsig

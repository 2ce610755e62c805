#include "core/signature/view/land_background.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/check.h"
#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"
#include "core/sources/background_land.h"
#include "core/transport/target_shadow.h"

namespace irsig {
namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

// Where the rays of a sensor meet land, and what land is there. Air is made for the ranges of all
// rays before any of them is asked; the places of few rays are kept until then.
class SeenLand {
 public:
  // The directions outlive this.
  SeenLand(const Land& land, Vec<Body> sensor, const std::vector<Vec<Body>>& direction)
      : sensor_(sensor), direction_(direction), keeps_(direction.size() <= kMostKept) {
    LandMix mix;
    for (const Vec<Body>& d : direction) {
      const auto at = land.meet_in_sight(sensor, sensor, d, mix);
      distance_m_.push_back(at ? at->distance : std::numeric_limits<double>::infinity());
      if (!keeps_) continue;
      point_.push_back(at.value_or(LandPoint{}));
      first_kind_.push_back(kind_.size());
      materials_ = mix.fraction.size();
      fraction_.insert(fraction_.end(), mix.fraction.begin(), mix.fraction.end());
      if (at) kind_.insert(kind_.end(), mix.kind.begin(), mix.kind.end());
    }
    first_kind_.push_back(kind_.size());
  }

  [[nodiscard]] const std::vector<double>& distance_m() const { return distance_m_; }

  // Returns what a ray meets, as Land::meet_in_sight of the same land.
  [[nodiscard]] std::optional<LandPoint> at(const Land& land, std::size_t ray, LandMix& mix) const {
    if (std::isinf(distance_m_[ray])) return std::nullopt;
    if (!keeps_) return land.meet_in_sight(sensor_, sensor_, direction_[ray], mix);
    const auto fraction = fraction_.begin() + static_cast<std::ptrdiff_t>(ray * materials_);
    mix.fraction.assign(fraction, fraction + static_cast<std::ptrdiff_t>(materials_));
    mix.kind.assign(kind_.begin() + static_cast<std::ptrdiff_t>(first_kind_[ray]),
                    kind_.begin() + static_cast<std::ptrdiff_t>(first_kind_[ray + 1]));
    return point_[ray];
  }

 private:
  static constexpr std::size_t kMostKept = 1 << 16;  // rays, of about 100 bytes each

  Vec<Body> sensor_;
  const std::vector<Vec<Body>>& direction_;
  bool keeps_;
  std::vector<double> distance_m_;
  std::vector<LandPoint> point_;
  std::size_t materials_ = 0;
  std::vector<float> fraction_;  // [ray][material]
  std::vector<KindShare> kind_;
  std::vector<std::size_t> first_kind_;  // [ray], and one behind the last
};

// Groups of the sources behind a target, [source]: 0; 1 + j for land lit by sun j.
std::vector<std::uint32_t> groups_of(const SourceLayout& layout) {
  const SourceRange behind = layout.behind();
  std::vector<std::uint32_t> out(behind.size(), 0);
  for (std::uint32_t j = 0; j < layout.suns(); ++j)
    for (const SourceId id : layout.behind_land_suns(j)) out[index_of(id) - behind.first] = 1 + j;
  return out;
}

}  // namespace

std::vector<const LandBackground::Group*> LandBackground::shining(
    const std::vector<unsigned char>& shines) const {
  std::vector<unsigned char> used(group_.size(), 0);
  for (std::size_t k = 0; k < shines.size(); ++k)
    if (shines[k] != 0) used[of_source_[k]] = 1;
  std::vector<const Group*> out;
  for (std::size_t g = 0; g < used.size(); ++g)
    if (used[g] != 0) out.push_back(&group_[g]);
  return out;
}

template <typename Visit>
void LandBackground::for_each_weight(std::span<const Group* const> groups, std::size_t pixel,
                                     Visit&& visit) {
  struct Range {
    const Weight *next = nullptr, *end = nullptr;
  };
  const auto range = [&](const Group& g) {
    return Range{g.weight.data() + g.first[pixel], g.weight.data() + g.first[pixel + 1]};
  };
  if (groups.size() <= 2) {
    Range a = groups.empty() ? Range{} : range(*groups[0]),
          b = groups.size() < 2 ? Range{} : range(*groups[1]);
    while (a.next != a.end && b.next != b.end)
      visit(a.next->order < b.next->order ? *a.next++ : *b.next++);
    for (; a.next != a.end; ++a.next) visit(*a.next);
    for (; b.next != b.end; ++b.next) visit(*b.next);
    return;
  }
  std::vector<const Weight*> all;
  for (const Group* g : groups)
    for (Range of = range(*g); of.next != of.end; ++of.next) all.push_back(of.next);
  std::sort(all.begin(), all.end(),
            [](const Weight* a, const Weight* b) { return a->order < b->order; });
  for (const Weight* w : all) visit(*w);
}

absl::StatusOr<LandBackground> LandBackground::make(
    const PreparedScene& scene, const ViewRequest& request, const EffectSet& effects,
    const ViewFrame& frame, const PictureFrame& pictures, std::uint32_t rays, bool shadow) {
  LandBackground out;
  out.condition_ = request.selected_condition;
  const PlaneRectangle& r = pictures.rectangle;
  const double pixel_m = r.width_m / pictures.width_px;
  std::vector<Vec<Body>> direction;  // of all rays, a pixel's side by side
  double least_z = 1, most_z = -1;
  for (std::uint32_t row = 0; row < pictures.height_px; ++row)
    for (std::uint32_t column = 0; column < pictures.width_px; ++column)
      for (std::uint32_t k = 0; k < rays * rays; ++k) {
        const double x_m = r.x0_m + (column + (k % rays + 0.5) / rays) * pixel_m,
                     y_m = r.y0_m + (pictures.height_px - row - (k / rays + 0.5) / rays) * pixel_m;
        const Vec<Body>& d = direction.emplace_back(
            normalized(pictures.plane_m * frame.forward + x_m * frame.right + y_m * frame.up));
        least_z = std::min(least_z, d.z);
        most_z = std::max(most_z, d.z);
      }
  const Viewpoint& v = request.viewpoint;
  const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
  std::optional<BackgroundDirections> directions;  // without an atmosphere: one above, one below
  if (request.environment != nullptr)
    directions = BackgroundDirections::spanning(
        least_z, most_z, request.environment->horizons_z(request.environment->line(v)),
        std::atan2(-towards.y, -towards.x));
  const SeenLand seen(land_of(request, scene.target, v.range_m), frame.sensor, direction);
  const std::vector<double> range_m = land_ranges_m(seen.distance_m());
  ASSIGN_OR_RETURN(auto surroundings,
                   ViewSurroundings::make(request, scene.target, v.range_m, scene.axis.node_um(),
                                          directions ? &*directions : nullptr, &range_m));
  EffectSet without_reflections = effects;
  without_reflections.max_reflections = 0;
  ASSIGN_OR_RETURN(auto environments,
                   surroundings.evaluate(request.selected_condition, without_reflections));
  out.environments_ = std::make_shared<const ViewEnvironments>(std::move(environments));
  out.light_ = std::make_unique<const ViewSources>(
      source_request(scene, request, request.selected_condition), without_reflections,
      out.environments_, scene.axis.node_um());

  const SourceGeometry& geometry = out.light_->geometry();
  const SourceLayout& layout = out.paths_ = SourceLayout(scene.target.part.size(), geometry);
  const Land& land = std::get<Land>(geometry.boundary);
  const SourceRange behind = layout.behind();
  std::vector<std::uint32_t> place(behind.size(), kUnused);
  const std::vector<std::uint32_t> groups = groups_of(layout);
  out.group_.resize(std::size_t{1} + layout.suns());
  std::uint32_t order = 0;
  LandMix mix;
  TargetShadow of_target(scene.target);
  const float share = 1.0f / static_cast<float>(rays * rays / 2);
  for (std::size_t i = 0; i < direction.size(); ++i) {
    const std::uint32_t ray = static_cast<std::uint32_t>(i) % (rays * rays);
    if (ray == 0) {
      order = 0;
      for (Group& g : out.group_) g.first.push_back(g.weight.size());
    }
    const auto half = static_cast<std::uint8_t>((ray % rays + ray / rays) % 2);
    const auto add = [&](SourceId source, float weight) {
      std::uint32_t& at = place[index_of(source) - behind.first];
      const std::uint32_t of_group = groups[index_of(source) - behind.first];
      if (at == kUnused) {
        at = static_cast<std::uint32_t>(out.source_.size());
        out.source_.push_back(source);
        out.of_source_.push_back(of_group);
      }
      Group& g = out.group_[of_group];
      for (std::size_t w = g.first.back(); w < g.weight.size(); ++w)
        if (g.weight[w].source == at && g.weight[w].half == half) {
          g.weight[w].value += share * weight;
          return;
        }
      g.weight.push_back({at, order++, share * weight, half});
    };
    if (const auto hit = seen.at(land, i, mix)) {
      const Vec<Body> lift{0, 0, static_cast<double>(scene.target.offset_m())};
      const auto shaded = [&](std::uint32_t j) {
        return shadow && of_target.falls_on(frame.sensor + hit->distance * direction[i] - lift,
                                            geometry.sun[j].direction);
      };
      for_each_behind(land, layout, geometry.sun, *hit, hit->distance, mix, shaded, add);
      continue;
    }
    BackgroundDirections::Share shares[2];
    const int count = geometry.behind->shares(static_cast<float>(direction[i].z), shares);
    for (int k = 0; k < count; ++k) add(layout.behind(shares[k].node), shares[k].weight);
  }
  for (Group& g : out.group_) g.first.push_back(g.weight.size());
  return out;
}

const ConditionSources& LandBackground::light(std::uint32_t condition) const {
  const auto at = std::find(condition_.begin(), condition_.end(), condition);
  IRSIG_CHECK(at != condition_.end());
  return light_->wanted(static_cast<std::size_t>(at - condition_.begin()));
}

LandBackground::Radiance LandBackground::of(std::uint32_t condition, const BandOnAxis& band) const {
  const ConditionSources& from = light(condition);
  std::vector<double> radiance, error;
  std::vector<unsigned char> shines;
  for (const SourceId id : source_) {
    const auto of = from.light_of_path(id);
    shines.push_back(of ? 1 : 0);
    radiance.push_back(of ? in_band(from.apparent(*of), band) : 0);
    error.push_back(of ? from.land_error_w_m2_sr(*of, band).apparent : 0);
  }
  const std::vector<const Group*> groups = shining(shines);
  Radiance out;
  for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
    double half[2] = {0, 0}, temperature = 0;
    for_each_weight(groups, pixel, [&](const Weight& w) {
      const auto weight = static_cast<double>(w.value);
      half[w.half] += weight * radiance[w.source];
      temperature += 0.5 * weight * error[w.source];
    });
    out.w_m2_sr.push_back(0.5 * (half[0] + half[1]));
    out.error_w_m2_sr.push_back(std::abs(half[0] - half[1]) + temperature);
  }
  return out;
}

LandBackground::Parts LandBackground::parts_of(std::uint32_t condition,
                                               const BandOnAxis& band) const {
  const ConditionSources& from = light(condition);
  std::vector<ConditionSources::LandParts> part(source_.size());
  std::vector<double> beyond(source_.size(), 0.0);
  std::vector<unsigned char> shines(source_.size(), 0);
  for (std::size_t k = 0; k < source_.size(); ++k) {
    const auto of = from.light_of_path(source_[k]);
    if (!of) continue;
    shines[k] = 1;
    part[k] = from.land_parts_w_m2_sr(*of, band);
    if (paths_.place_of(source_[k]).kind != SourceLayout::Kind::kBehind) continue;
    beyond[k] = 1;
    part[k].without_air = in_band(from.apparent(*of), band);
  }
  const std::vector<const Group*> groups = shining(shines);
  Parts out;
  for (auto* column : {&out.without_air, &out.emitted, &out.sky, &out.sun, &out.beyond})
    column->assign(pixels(), 0.0);
  for (std::size_t pixel = 0; pixel < pixels(); ++pixel)
    for_each_weight(groups, pixel, [&](const Weight& w) {
      const double weight = 0.5 * static_cast<double>(w.value);
      const ConditionSources::LandParts& of = part[w.source];
      out.without_air[pixel] += weight * of.without_air;
      out.emitted[pixel] += weight * of.emitted;
      out.sky[pixel] += weight * of.sky;
      out.sun[pixel] += weight * of.sun;
      out.beyond[pixel] += weight * beyond[w.source];
    });
  return out;
}

std::vector<double> LandBackground::temperature_k(std::span<const double> kelvin) const {
  // 0: no land, or land that faces land: its place counts as what faces the sky.
  std::vector<double> source_k(source_.size(), 0.0);
  for (std::size_t k = 0; k < source_.size(); ++k) {
    const SourceLayout::Place at = paths_.place_of(source_[k]);
    if (at.kind != SourceLayout::Kind::kBehindLand) continue;
    const std::uint32_t kind = at.index / paths_.behind_ranges();
    if (kind < paths_.land_kinds()) source_k[k] = kelvin[kind];
  }
  const Group* without_sun = &group_.front();
  std::vector<double> out;
  for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
    double sum = 0, all = 0;
    for_each_weight({&without_sun, 1}, pixel, [&](const Weight& w) {
      const double of_source_k = source_k[w.source];
      if (!(of_source_k > 0)) return;
      const auto weight = static_cast<double>(w.value);
      sum += weight * of_source_k;
      all += weight;
    });
    out.push_back(all > 0 ? sum / all : 0);
  }
  return out;
}

std::vector<float> LandBackground::weights() const {
  std::vector<float> out(pixels() * source_.size(), 0.0f);
  for (const Group& g : group_)
    for (std::size_t pixel = 0; pixel < pixels(); ++pixel)
      for (std::size_t w = g.first[pixel]; w < g.first[pixel + 1]; ++w)
        out[pixel * source_.size() + g.weight[w].source] += 0.5f * g.weight[w].value;
  return out;
}

}  // namespace irsig

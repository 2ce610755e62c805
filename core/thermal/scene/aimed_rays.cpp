#include "core/thermal/scene/aimed_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr double kLeastBeyondWM2 = 20;
// Pairs that are looked at: a second. Of more the weakest aims are left to the other rays.
constexpr std::size_t kMostPairs = 30'000'000;

double dot(const FaceNormal& n, const FacePoint& d) {
  return static_cast<double>(n.x * d.x + n.y * d.y + n.z * d.z);
}
FacePoint between(const FacePoint& from, const FacePoint& to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}

}  // namespace

AimedRays::AimedRays(const Target& target, const ThermalFaces& faces,
                     std::span<const double> beyond_w_m2, std::uint32_t rays)
    : target_(target), faces_(faces), rays_(rays) {
  for (std::uint32_t face = 0; face < beyond_w_m2.size(); ++face)
    if (beyond_w_m2[face] >= kLeastBeyondWM2 && faces.area_m2[face] > 0) aim_.push_back(face);
  const auto w = [&](std::uint32_t face) { return beyond_w_m2[face] * faces.area_m2[face]; };
  if (const std::size_t most = kMostPairs / std::max<std::size_t>(1, faces.size());
      aim_.size() > most) {
    std::stable_sort(aim_.begin(), aim_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return w(a) > w(b); });
    aim_.resize(most);
  }
  if (aim_.empty()) return;
  aim_of_face_.assign(faces.size(), kNone);
  for (std::uint32_t a = 0; a < aim_.size(); ++a) {
    aim_of_face_[aim_[a]] = a;
    place_.push_back(place_of(aim_[a]));
    w_.push_back(w(aim_[a]));
  }
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    double& sum = total_w_m2_.emplace_back(0);
    if (faces.area_m2[face] <= 0) continue;
    const Place from = place_of(face);
    for (std::size_t a = 0; a < aim_.size(); ++a) sum += might_w_m2(from, face, a);
  }
}

AimedRays::Place AimedRays::place_of(std::uint32_t face) const {
  return {point_of(target_, faces_, face, 4.0f / 9, 0.5f), normal_of(target_, faces_, face),
          static_cast<float>(std::sqrt(faces_.area_m2[face]))};
}

bool AimedRays::is_in_front(const Place& of, std::uint32_t face) const {
  const auto above = [&](float u, float v) {
    return dot(of.normal, between(of.centre, point_of(target_, faces_, face, u, v)));
  };
  return std::max({above(0, 0), above(1, 0), above(1, 1)}) > 1e-3 * static_cast<double>(of.size_m);
}

double AimedRays::might_w_m2(const Place& from, std::uint32_t from_face, std::size_t aim) const {
  const Place& to = place_[aim];
  const FacePoint way = between(from.centre, to.centre);
  const double square_m2 = static_cast<double>(way.x * way.x + way.y * way.y + way.z * way.z),
               both_m = static_cast<double>(from.size_m + to.size_m);
  double here = dot(from.normal, way), there = -dot(to.normal, way);  // cosines x distance
  // Parts of faces may see each other where their middles do not, or hardly.
  const double least = std::min(0.1 * std::sqrt(square_m2), 0.25 * both_m);
  if (std::min(here, there) < least && std::min(here, there) > -both_m &&
      is_in_front(from, aim_[aim]) && is_in_front(to, from_face)) {
    here = std::max(here, least);
    there = std::max(there, least);
  }
  if (here <= 0 || there <= 0) return 0;
  return w_[aim] * here * there / (square_m2 * (std::numbers::pi * square_m2 + both_m * both_m));
}

double AimedRays::rays_to(std::uint32_t from, std::uint32_t to) const {
  if (!is_aim(to) || rays(from) == 0) return 0;
  return rays_ * might_w_m2(place_of(from), from, aim_of_face_[to]) / total_w_m2_[from];
}

void AimedRays::start(std::uint32_t from) {
  until_.clear();
  const Place place = place_of(from);
  double sum = 0;
  for (std::size_t a = 0; a < aim_.size(); ++a) until_.push_back(sum += might_w_m2(place, from, a));
}

std::uint32_t AimedRays::pick(float u) const {
  const double at = static_cast<double>(u) * until_.back();
  const auto found = std::upper_bound(until_.begin(), until_.end(), at);
  return aim_[static_cast<std::size_t>(std::min(found, until_.end() - 1) - until_.begin())];
}

}  // namespace irsig

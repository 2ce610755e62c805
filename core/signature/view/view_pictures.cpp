#include "core/signature/view/view_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "core/base/problems.h"
#include "core/plume/plume_field.h"

namespace irsig {
namespace {

constexpr double kShown = 0.99, kMostGrowth = 8;

struct Span {
  double low = 1e300, high = -1e300;
  void add(const Span& s) {
    low = std::min(low, s.low);
    high = std::max(high, s.high);
  }
  [[nodiscard]] double length() const { return high - low; }
};

// Returns the part of an axis between equal tails that holds `kept` of all weight.
Span without_tails(const std::vector<Span>& place, const std::vector<double>& weight, double kept) {
  constexpr std::size_t kBins = 4096;
  Span all;
  for (const Span& s : place) all.add(s);
  if (!(all.length() > 0)) return all;
  std::vector<double> ends_here(kBins, 0.0), begins_here(kBins, 0.0);
  double sum = 0;
  const auto bin = [&](double x) {
    return std::min(static_cast<std::size_t>((x - all.low) / all.length() * kBins), kBins - 1);
  };
  for (std::size_t i = 0; i < place.size(); ++i) {
    begins_here[bin(place[i].low)] += weight[i];
    ends_here[bin(place[i].high)] += weight[i];
    sum += weight[i];
  }
  // Places that begin below the part or end above it are less than a tail.
  const double tail = 0.5 * (1 - kept) * sum;
  std::size_t first = 0, last = kBins;
  for (double below = begins_here[0]; first + 1 < kBins && below <= tail;)
    below += begins_here[++first];
  for (double above = ends_here[kBins - 1]; last > first + 1 && above <= tail;)
    above += ends_here[--last - 1];
  const double width = all.length() / kBins;
  return {all.low + width * static_cast<double>(first),
          all.low + width * static_cast<double>(last)};
}

// Returns the shown part of one field on the image plane: across and up.
std::array<Span, 2> shown_part(const PlumeField& field, const Target& target,
                               const ViewFrame& frame) {
  std::array<std::vector<Span>, 2> place;
  std::array<std::vector<double>, 2> weight;  // [wavelength]
  for (const PlumePoint& point : field.points()) {
    const Vec<Body> q = point.at - target.centre - frame.sensor;
    const double depth_m = dot(q, frame.forward);
    if (!(depth_m > 0)) continue;  // gas at the sensor is refused elsewhere
    const double scale = frame.plane_m / depth_m, reach = scale * point.reach_m;
    const double at[] = {scale * dot(q, frame.right), scale * dot(q, frame.up)};
    for (std::size_t axis = 0; axis < 2; ++axis)
      place[axis].push_back({at[axis] - reach, at[axis] + reach});
    for (std::size_t l = 0; l < 2; ++l) weight[l].push_back(static_cast<double>(point.thin_w[l]));
  }
  std::array<Span, 2> out;
  if (place[0].empty()) return out;
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t l = 0; l < 2; ++l)
      out[axis].add(without_tails(place[axis], weight[l], 1 - 0.5 * (1 - kShown)));
  return out;
}

// The target's, and what of hot gas is shown.
PlaneRectangle shown_rectangle(const Target& target, const ViewFrame& frame,
                               const ViewRequest& request) {
  std::set<const PlumeField*> fields;
  for (const ConditionSpec& condition : request.condition)
    if (condition.gas != nullptr) fields.insert(condition.gas.get());
  if (fields.empty()) return frame;
  const double beyond = 0.5 * (kMostGrowth - 1) * std::max(frame.width_m, frame.height_m);
  std::array<Span, 2> all = {Span{frame.x0_m, frame.x0_m + frame.width_m},
                             Span{frame.y0_m, frame.y0_m + frame.height_m}};
  const std::array<Span, 2> own = all;
  for (const PlumeField* field : fields) {
    std::array<Span, 2> part = shown_part(*field, target, frame);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      part[axis].low = std::max(part[axis].low, own[axis].low - beyond);
      part[axis].high = std::min(part[axis].high, own[axis].high + beyond);
    }
    if (!(part[0].length() > 0 && part[1].length() > 0)) continue;  // too far away
    for (std::size_t axis = 0; axis < 2; ++axis) all[axis].add(part[axis]);
  }
  return {all[0].low, all[1].low, all[0].length(), all[1].length()};
}

absl::StatusOr<PictureFrame> frame_of(const ImageSpec& image, const Target& target,
                                      const ViewFrame& frame, const ViewRequest& request) {
  PictureFrame out;
  out.plane_m = frame.plane_m;
  out.width_px = image.width_px;
  out.height_px = image.height_px;
  double pixel_m = 0, middle_x_m = 0, middle_y_m = 0;
  if (image.camera) {
    pixel_m = 2 * frame.plane_m * std::tan(0.5 * image.camera->field_of_view_rad) / image.width_px;
    if (image.camera->look_at_m) {
      const Vec<Body> q = *image.camera->look_at_m - target.centre - frame.sensor;
      const double depth_m = dot(q, frame.forward);
      if (!(depth_m > 0))
        return keyed_problem("image.look_at_m",
                             "lies beside or behind a sensor, expected a point in front of all");
      middle_x_m = frame.plane_m / depth_m * dot(q, frame.right);
      middle_y_m = frame.plane_m / depth_m * dot(q, frame.up);
    }
  } else {
    const PlaneRectangle shown = shown_rectangle(target, frame, request);
    pixel_m = (1 + 2 * image.margin) *
              std::max(shown.width_m / image.width_px, shown.height_m / image.height_px);
    middle_x_m = shown.x0_m + 0.5 * shown.width_m;
    middle_y_m = shown.y0_m + 0.5 * shown.height_m;
  }
  const double width_m = pixel_m * image.width_px, height_m = pixel_m * image.height_px;
  out.rectangle = {middle_x_m - 0.5 * width_m, middle_y_m - 0.5 * height_m, width_m, height_m};
  return out;
}

}  // namespace

absl::StatusOr<PictureFrame> picture_frame(const Target& target, const ViewFrame& frame,
                                           const ViewRequest& request) {
  if (request.image) return frame_of(*request.image, target, frame, request);
  PictureFrame out;
  if (request.thumbnail_px == 0) return out;
  out.rectangle = shown_rectangle(target, frame, request);
  out.plane_m = frame.plane_m;
  // The short side grows to a whole number of pixels.
  PlaneRectangle& r = out.rectangle;
  const double pixel_m = std::max(r.width_m, r.height_m) / request.thumbnail_px;
  const auto in_pixels = [&](double& from_m, double& length_m) {
    const auto px = std::max<std::uint32_t>(
        1, static_cast<std::uint32_t>(std::ceil(length_m / pixel_m - 1e-6)));
    from_m -= 0.5 * (px * pixel_m - length_m);
    length_m = px * pixel_m;
    return px;
  };
  out.width_px = in_pixels(r.x0_m, r.width_m);
  out.height_px = in_pixels(r.y0_m, r.height_m);
  return out;
}

ImagePlan blank_pictures(const PictureFrame& frame, const ViewFrame& view, std::size_t images,
                         std::size_t firsts, const SourceLayout& paths,
                         const SpectralBasis* basis) {
  ImagePlan plan;
  if (frame.width_px == 0) return plan;
  plan.width_px = frame.width_px;
  plan.height_px = frame.height_px;
  plan.images = static_cast<std::uint32_t>(images);
  plan.padded = (plan.images + 7) / 8 * 8;
  plan.rectangle = frame.rectangle;
  if (view.plane_m != frame.plane_m)
    for (double* length : {&plan.rectangle.x0_m, &plan.rectangle.y0_m, &plan.rectangle.width_m,
                           &plan.rectangle.height_m})
      *length *= view.plane_m / frame.plane_m;
  plan.source.assign(
      firsts * paths.count() * (basis != nullptr ? plan.images * basis->columns() : plan.padded),
      0.0f);
  return plan;
}

namespace {

// Puts weights of one source, [table.columns], into its place.
void put(const std::vector<double>& row, SourceId id, const SourceTable& table,
         const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
         std::size_t first, ImagePlan& plan) {
  const std::size_t place = first * paths.count() + index_of(id);
  if (basis != nullptr)
    std::copy(row.begin(), row.end(),
              plan.source.begin() +
                  static_cast<std::ptrdiff_t>((place * plan.images + image) * basis->columns() +
                                              table.first_column));
  else
    plan.source[place * plan.padded + image] = static_cast<float>(row[0]);
}

}  // namespace

void show_sources(const SourceTable& table, const std::vector<double>& radiance,
                  const ConditionSources& light, const SourceLayout& paths,
                  const SpectralBasis* basis, std::size_t image, std::size_t first,
                  ImagePlan& plan) {
  const SourceLayout& lights = light.layout();
  std::vector<double> row(table.columns);
  const auto of_light = [&](std::uint32_t id) { return radiance.data() + id * table.columns; };
  const auto put_emitter = [&](std::uint32_t emitter, SourceId id, SourceId first_light) {
    const ConditionSources::EmitterShare share = light.fraction_of(emitter);
    std::fill(row.begin(), row.end(), 0.0);
    for (std::uint32_t n = 0; n < share.count; ++n)
      for (std::size_t c = 0; c < row.size(); ++c)
        row[c] += share.weight[n] * of_light(index_of(first_light) + share.first + n)[c];
    put(row, id, table, paths, basis, image, first, plan);
  };
  for (std::uint32_t e = 0; e < paths.emitters(); ++e) {
    put_emitter(e, paths.seen(e), lights.seen(0));
    put_emitter(e, paths.reflected(e), lights.reflected(0));
  }
  const std::uint32_t beyond = paths.all_emitted().last;
  for (const SourceId id : SourceRange{beyond, paths.of_intensity().last}) {
    std::fill(row.begin(), row.end(), 0.0);
    if (const auto of = light.light_of_path(id))
      std::copy_n(of_light(index_of(*of)), table.columns, row.begin());
    put(row, id, table, paths, basis, image, first, plan);
  }
}

namespace {

void put_background(double sign, const SourceTable& table, const ConditionSources& light,
                    const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
                    std::size_t first, ImagePlan& plan) {
  plan.behind = true;
  std::vector<double> row(table.columns);
  for (const SourceId id : paths.behind()) {
    const auto of = light.light_of_path(id);
    for (std::size_t c = 0; c < row.size(); ++c)
      row[c] = of ? sign * table.apparent[index_of(*of) * table.columns + c] : 0;
    put(row, id, table, paths, basis, image, first, plan);
  }
}

}  // namespace

void show_background(const SourceTable& table, const ConditionSources& light,
                     const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
                     std::size_t first, ImagePlan& plan) {
  put_background(1, table, light, paths, basis, image, first, plan);
}

void hide_background(const SourceTable& table, const ConditionSources& light,
                     const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
                     ImagePlan& plan) {
  put_background(-1, table, light, paths, basis, image, 0, plan);
}

PathSettings picture_settings(PathSettings settings, const ImagePlan& plan,
                              std::uint32_t pixel_samples) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(plan.width_px) * plan.height_px;
  settings.replicates = 1;
  settings.pixel_samples = kPixelSamples;
  settings.split = 2;
  settings.roulette_survival_scale = 8;
  if (pixel_samples > 0) {
    settings.pixel_samples = pixel_samples;
    settings.samples = pixels * pixel_samples;
    return settings;
  }
  while (pixels * settings.pixel_samples < kLeastPictureSamples) settings.pixel_samples *= 2;
  while (settings.pixel_samples > kLeastPixelSamples &&
         pixels * settings.pixel_samples > kMostPictureSamples)
    settings.pixel_samples /= 2;
  settings.samples = pixels * settings.pixel_samples;
  return settings;
}

}  // namespace irsig

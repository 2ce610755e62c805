#include "view/pictures/exported_sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/base/status_macros.h"
#include "schema/store/check/check_picture.h"
#include "view/pictures/thumbnail.h"

namespace irsig {

absl::StatusOr<ExportedSweeps> ExportedSweeps::read(StoreReader& reader, const std::string& sweep) {
  ExportedSweeps out;
  ASSIGN_OR_RETURN(const auto sweeps, reader.contents());
  for (const SweepContents& of : sweeps) {
    if (!sweep.empty() && of.name != sweep) continue;
    ASSIGN_OR_RETURN(const auto stored, reader.sweep(of.name));
    const schema::Sweep& resolved = stored.resolved.sweep();
    for (const schema::Part& part : resolved.part())
      if (std::find(out.parts_.begin(), out.parts_.end(), part.name()) == out.parts_.end())
        out.parts_.push_back(part.name());
    const std::size_t place = out.place_.size();
    out.place_[of.name] = place;
    out.most_px_[of.name] = most_px_of(resolved);
    out.most_bands_ = std::max(out.most_bands_, static_cast<std::size_t>(resolved.band_size()));
    for (const schema::Band& b : resolved.band()) {
      Band& band = out.band_[{of.name, b.name()}];
      band = {b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}};
      for (const schema::SpectralPoint& point : b.response())
        band.response.push_back({point.lambda_um(), point.value()});
    }
  }
  return out;
}

std::uint32_t ExportedSweeps::most_px() const {
  std::uint32_t longest = 1;
  for (const auto& [sweep, px] : most_px_) longest = std::max(longest, px);
  return longest;
}

std::uint32_t ExportedSweeps::most_px(const StoredSignature& s) const {
  const auto of_sweep = most_px_.find(s.sweep);
  return s.superseded || of_sweep == most_px_.end() ? kMostPixels : of_sweep->second;
}

const Band* ExportedSweeps::band_of(const StoredSignature& s) const {
  const auto band = band_.find({s.sweep, s.band});
  return band == band_.end() || band->second.lambda_min_um != s.lambda_min_um ||
                 band->second.lambda_max_um != s.lambda_max_um
             ? nullptr
             : &band->second;
}

std::string ExportedSweeps::name_of(const StoredSignature& s) const {
  return place_.size() > 1 ? fmt::format("images/{}-{:07}", place_.at(s.sweep) + 1, s.row)
                           : fmt::format("images/{:07}", s.row);
}

std::string ExportedSweeps::mask_of(const StoredSignature& s) const {
  return "masks" + name_of(s).substr(std::string_view("images").size()) + ".png";
}

absl::Status ExportedSweeps::damaged(const StoredSignature& s, const std::string& how) const {
  return final_end(absl::DataLossError(
      fmt::format("the stored image of row {}{} ({}.png) is damaged: {}", s.row,
                  place_.size() > 1 ? " of sweep " + s.sweep : "", name_of(s), how)));
}

}  // namespace irsig

#include "cli/picture_program.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "planning/machine.h"

namespace irsig {

absl::StatusOr<std::vector<PictureAnswer>> read_pictures(const std::vector<PictureTask>& tasks) {
  // The program takes 0.25 s of CPU time to load: worth it for some hundreds.
  const std::size_t pieces =
      std::clamp<std::size_t>(tasks.size() / 500, 1, std::max(1u, usable_cores()));
  const std::span all(tasks);
  std::vector<std::optional<absl::StatusOr<std::vector<PictureAnswer>>>> answered(pieces);
  const auto read = [&](std::size_t piece) {
    const std::size_t from = piece * all.size() / pieces, to = (piece + 1) * all.size() / pieces;
    answered[piece] = read_pictures_subprocess(picture_program(), all.subspan(from, to - from));
  };
  std::vector<std::jthread> others;
  for (std::size_t piece = 1; piece < pieces; ++piece) others.emplace_back(read, piece);
  read(0);
  others.clear();
  std::vector<PictureAnswer> out;
  for (auto& some : answered) {
    if (!some->ok()) return some->status();
    std::move((*some)->begin(), (*some)->end(), std::back_inserter(out));
  }
  return out;
}

}  // namespace irsig

#include "core/plume/voxel_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace irsig {
namespace {

constexpr std::string_view kVolume = "irsig volume 1\n", kRefused = "irsig no volume 1\n";
constexpr VoxelMask kFull{~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL, ~0ULL};

template <typename T>
void put(const std::vector<T>& values, std::string& out) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t count = values.size();
  out.append(reinterpret_cast<const char*>(&count), sizeof count);
  out.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

// Takes lists from the front; false where there is less than announced.
class Taker {
 public:
  explicit Taker(std::string_view left) : left_(left) {}

  template <typename T>
  bool take(std::vector<T>& out) {
    std::uint64_t count = 0;
    if (left_.size() < sizeof count) return false;
    std::memcpy(&count, left_.data(), sizeof count);
    left_.remove_prefix(sizeof count);
    if (count > left_.size() / sizeof(T)) return false;
    out.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(out.data()), left_.data(), count * sizeof(T));
    left_.remove_prefix(count * sizeof(T));
    return true;
  }
  [[nodiscard]] bool at_end() const { return left_.empty(); }

 private:
  std::string_view left_;
};

bool is_sound(const VoxelVolume& volume) {
  const std::size_t channels = volume.channel.size();
  if (channels == 0 || volume.background.size() != channels) return false;
  if (volume.block.size() > kMostBlocks || volume.mask.size() != volume.block.size() * channels)
    return false;
  std::size_t values = 0;
  for (std::size_t b = 0; b < volume.block.size(); ++b) {
    const VoxelBlock& block = volume.block[b];
    if (static_cast<std::uint32_t>(block.form) > 2) return false;
    for (const std::int32_t at : block.origin)
      if (at % 8 != 0) return false;
    values += stored_voxels(block.form, held_by_any(volume, b)) * channels;
  }
  return values == volume.value.size();
}

}  // namespace

VoxelMask held_by_any(const VoxelVolume& volume, std::size_t b) {
  VoxelMask out{};
  const std::size_t channels = volume.channel.size();
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t w = 0; w < out.size(); ++w) out[w] |= volume.mask[b * channels + c][w];
  return out;
}

std::size_t stored_voxels(VoxelBlock::Form form, const VoxelMask& held) {
  switch (form) {
    case VoxelBlock::Form::kUniform:
      return 1;
    case VoxelBlock::Form::kDense:
      return 512;
    case VoxelBlock::Form::kPacked:
      break;
  }
  return count_of(held);
}

void VolumeWriter::add(std::array<std::int32_t, 3> origin, const std::vector<VoxelMask>& mask,
                       const std::vector<float>& value) {
  const std::size_t channels = volume_.channel.size();
  VoxelMask held{};
  for (const VoxelMask& m : mask)
    for (std::size_t w = 0; w < held.size(); ++w) held[w] |= m[w];
  const unsigned count = count_of(held);
  if (count == 0) return;
  const auto form = count >= 256 ? VoxelBlock::Form::kDense : VoxelBlock::Form::kPacked;
  volume_.block.push_back({origin, form});
  volume_.mask.insert(volume_.mask.end(), mask.begin(), mask.end());
  for (unsigned v = 0; v < 512; ++v) {
    if (form == VoxelBlock::Form::kPacked && !holds(held, v)) continue;
    for (std::size_t c = 0; c < channels; ++c)
      volume_.value.push_back(holds(mask[c], v) ? value[v * channels + c] : 0.0F);
  }
}

void VolumeWriter::add_uniform(std::array<std::int32_t, 3> origin,
                               const std::vector<float>& value) {
  volume_.block.push_back({origin, VoxelBlock::Form::kUniform});
  volume_.mask.insert(volume_.mask.end(), volume_.channel.size(), kFull);
  volume_.value.insert(volume_.value.end(), value.begin(), value.end());
}

std::string encode_volume(const absl::StatusOr<VoxelVolume>& volume) {
  if (!volume.ok()) return std::string(kRefused) + std::string(volume.status().message());
  std::string out(kVolume);
  out.append(reinterpret_cast<const char*>(volume->world_from_index.data()),
             sizeof volume->world_from_index);
  std::vector<char> names;
  for (const std::string& name : volume->channel) {
    names.insert(names.end(), name.begin(), name.end());
    names.push_back('\0');
  }
  out.reserve(out.size() + volume->value.size() * sizeof(float) +
              volume->mask.size() * sizeof(VoxelMask) + volume->block.size() * sizeof(VoxelBlock) +
              names.size() + 256);
  put(names, out);
  put(volume->background, out);
  put(volume->block, out);
  put(volume->mask, out);
  put(volume->value, out);
  return out;
}

absl::StatusOr<VoxelVolume> decode_volume(std::string_view bytes) {
  if (bytes.starts_with(kRefused))
    return absl::InvalidArgumentError(std::string(bytes.substr(kRefused.size())));
  const absl::Status broken = absl::DataLossError("no complete volume");
  VoxelVolume volume;
  if (!bytes.starts_with(kVolume) || bytes.size() < kVolume.size() + sizeof volume.world_from_index)
    return broken;
  bytes.remove_prefix(kVolume.size());
  std::memcpy(volume.world_from_index.data(), bytes.data(), sizeof volume.world_from_index);
  Taker taker(bytes.substr(sizeof volume.world_from_index));
  std::vector<char> names;
  if (!taker.take(names) || !taker.take(volume.background) || !taker.take(volume.block) ||
      !taker.take(volume.mask) || !taker.take(volume.value) || !taker.at_end())
    return broken;
  for (auto at = names.begin(); at != names.end();) {
    const auto end = std::find(at, names.end(), '\0');
    if (end == names.end()) return broken;
    volume.channel.emplace_back(at, end);
    at = end + 1;
  }
  if (!is_sound(volume)) return broken;
  return volume;
}

}  // namespace irsig

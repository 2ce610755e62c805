#include "core/scene/import/import_reply.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

namespace irsig {
namespace {

constexpr std::string_view kMesh = "irsig mesh 1\n", kRefused = "irsig none 1\n";

template <typename T>
void put(const std::vector<T>& values, std::string& out) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t count = values.size();
  out.append(reinterpret_cast<const char*>(&count), sizeof count);
  out.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

// Takes lists from the front of the reply; false where it is too short for what it announces.
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

bool is_sound(const FileMesh& mesh) {
  if (mesh.triangle.size() != mesh.triangle_group.size()) return false;
  for (const Vec<FileFrame>& v : mesh.vertex)
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  for (const auto& triangle : mesh.triangle)
    for (const std::uint32_t index : triangle)
      if (index >= mesh.vertex.size()) return false;
  return std::all_of(mesh.triangle_group.begin(), mesh.triangle_group.end(),
                     [&](std::uint32_t group) { return group < mesh.group.size(); });
}

}  // namespace

std::string encode_reply(const absl::StatusOr<FileMesh>& result) {
  if (!result.ok()) return std::string(kRefused) + std::string(result.status().message());
  std::string out(kMesh);
  put(result->vertex, out);
  put(result->triangle, out);
  put(result->triangle_group, out);
  std::vector<std::uint64_t> length;
  std::vector<char> names;
  for (const std::string& name : result->group) {
    length.push_back(name.size());
    names.insert(names.end(), name.begin(), name.end());
  }
  put(length, out);
  put(names, out);
  return out;
}

absl::StatusOr<FileMesh> decode_reply(std::string_view reply) {
  if (reply.starts_with(kRefused))
    return absl::InvalidArgumentError(std::string(reply.substr(kRefused.size())));
  const absl::Status broken = absl::DataLossError("no complete reply");
  if (!reply.starts_with(kMesh)) return broken;
  Taker taker(reply.substr(kMesh.size()));
  FileMesh mesh;
  std::vector<std::uint64_t> length;
  std::vector<char> names;
  if (!taker.take(mesh.vertex) || !taker.take(mesh.triangle) || !taker.take(mesh.triangle_group) ||
      !taker.take(length) || !taker.take(names) || !taker.at_end())
    return broken;
  std::string_view left(names.data(), names.size());
  for (const std::uint64_t bytes : length) {
    if (bytes > left.size()) return broken;
    mesh.group.emplace_back(left.substr(0, bytes));
    left.remove_prefix(bytes);
  }
  if (!left.empty() || !is_sound(mesh)) return broken;
  return mesh;
}

}  // namespace irsig

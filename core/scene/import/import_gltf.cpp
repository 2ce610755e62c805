// glTF 2.0 and GLB: the triangles of the default scene, with the transformations of nodes, default
// morph weights, skins in the pose of the file's nodes, and instances.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_gltf_file.h"
#include "fmt/format.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostGltfFacets = 100'000'000;

// Extensions that a file may require: what they change is read here, or is no geometry.
bool is_known_extension(std::string_view name) {
  static constexpr std::string_view kKnown[] = {"KHR_mesh_quantization",
                                                "EXT_mesh_gpu_instancing",
                                                "KHR_node_visibility",
                                                "KHR_lights_punctual",
                                                "KHR_texture_transform",
                                                "KHR_texture_basisu",
                                                "KHR_texture_float32",
                                                "KHR_xmp_json_ld",
                                                "KHR_xmp",
                                                "EXT_texture_webp",
                                                "EXT_texture_avif",
                                                "MSFT_texture_dds",
                                                "EXT_lights_ies",
                                                "EXT_lights_image_based",
                                                "MSFT_packing_normalRoughnessMetallic",
                                                "EXT_mesh_features",
                                                "EXT_structural_metadata",
                                                "EXT_instance_features",
                                                "CESIUM_primitive_outline",
                                                "FB_ngon_encoding",
                                                "KHR_techniques_webgl",
                                                "MSFT_packing_occlusionRoughnessMetallic"};
  return name.starts_with("KHR_materials_") || name.starts_with("EXT_materials_") ||
         std::ranges::find(kKnown, name) != std::end(kKnown);
}

// x -> A x + b, in rows.
struct Affine {
  std::array<double, 12> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  [[nodiscard]] Vec<FileFrame> at(const Vec<FileFrame>& v) const {
    const auto row = [&](std::size_t i) {
      return m[4 * i] * v.x + m[4 * i + 1] * v.y + m[4 * i + 2] * v.z + m[4 * i + 3];
    };
    return {row(0), row(1), row(2)};
  }
  [[nodiscard]] double determinant() const {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
  }
};

Affine operator*(const Affine& a, const Affine& b) {
  Affine out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      double sum = j == 3 ? a.m[4 * i + 3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += a.m[4 * i + k] * b.m[4 * k + j];
      out.m[4 * i + j] = sum;
    }
  return out;
}

// Translation, rotation (a quaternion x, y, z, w of any length but 0) and scale.
Affine of_parts(const double* t, const double* q, const double* s) {
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double f = 2 / norm, x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[9] = {1 - f * (y * y + z * z), f * (x * y - z * w),     f * (x * z + y * w),
                       f * (x * y + z * w),     1 - f * (x * x + z * z), f * (y * z - x * w),
                       f * (x * z - y * w),     f * (y * z + x * w),     1 - f * (x * x + y * y)};
  Affine out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out.m[4 * i + j] = r[3 * i + j] * s[j];
    out.m[4 * i + 3] = t[i];
  }
  return out;
}

// A column-major 4 x 4 matrix, whose last row is 0, 0, 0, 1.
Affine of_columns(const double* columns) {
  Affine out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) out.m[4 * i + j] = columns[4 * j + i];
  return out;
}

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const std::string& file_name)
      : file_(bytes, file_name), groups_(mesh_), vertices_(mesh_) {}

  absl::StatusOr<FileMesh> read() {
    if (file_.ok()) check_extensions();
    if (file_.ok()) place_nodes();
    std::vector<std::size_t> open = roots();
    std::reverse(open.begin(), open.end());
    while (file_.ok() && !open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      if (hidden(node)) continue;
      add_node(node);
      const std::vector<std::size_t>& children = child_[node];
      open.insert(open.end(), children.rbegin(), children.rend());
    }
    if (file_.ok())
      if (const std::optional<std::string> coarse = guard_.problem()) file_.fail("", *coarse);
    if (!file_.ok()) return file_.status();
    return std::move(mesh_);
  }

 private:
  void check_extensions() {
    const JsonValue* required = file_.root().find("extensionsRequired");
    if (required == nullptr) return;
    for (const JsonValue& name : required->item)
      if (!is_known_extension(name.text))
        return file_.fail(
            "extensionsRequired",
            fmt::format("the extension {} is not read: export the model without it", name.text));
  }

  static std::string node_place(std::size_t node) { return fmt::format("nodes[{}]", node); }

  static const JsonValue* extension(const JsonValue& of, std::string_view name) {
    const JsonValue* all = of.find("extensions");
    return all == nullptr ? nullptr : all->find(name);
  }

  std::vector<std::size_t> indices(const JsonValue& of, std::string_view name,
                                   std::string_view place, std::size_t below) {
    std::vector<std::size_t> out;
    for (const double value : file_.numbers(of, name, place)) {
      if (!(value >= 0 && value < static_cast<double>(below) && value == std::floor(value))) {
        file_.fail(fmt::format("{}.{}[{}]", place, name, out.size()),
                   fmt::format("is {}, expected a number from 0 to {}", value,
                               static_cast<double>(below) - 1));
        return {};
      }
      out.push_back(static_cast<std::size_t>(value));
    }
    return out;
  }

  Affine local(const JsonValue& node, const std::string& place) {
    std::vector<double> matrix = file_.numbers(node, "matrix", place);
    std::vector<double> t = file_.numbers(node, "translation", place),
                        q = file_.numbers(node, "rotation", place),
                        s = file_.numbers(node, "scale", place);
    if (t.empty()) t = {0, 0, 0};
    if (q.empty()) q = {0, 0, 0, 1};
    if (s.empty()) s = {1, 1, 1};
    if (!file_.ok()) return {};
    if (t.size() != 3 || q.size() != 4 || s.size() != 3 || (!matrix.empty() && matrix.size() != 16))
      file_.fail(place,
                 "expected a matrix of 16 numbers, or a translation of 3, a rotation of 4 "
                 "and a scale of 3");
    else if (!matrix.empty())
      return of_columns(matrix.data());
    else if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
      file_.fail(place + ".rotation", "is 0, expected a quaternion of length 1");
    else
      return of_parts(t.data(), q.data(), s.data());
    return {};
  }

  // Every node's place in the file's frame. Nodes are trees: each has one parent at most.
  void place_nodes() {
    const std::size_t count = file_.count("nodes");
    child_.resize(count);
    parent_.assign(count, count);
    file_from_node_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const JsonValue* node = file_.element("nodes", i);
      if (node == nullptr) return;
      child_[i] = indices(*node, "children", node_place(i), count);
      for (const std::size_t child : child_[i]) {
        if (parent_[child] != count)
          return file_.fail(node_place(child),
                            fmt::format("is the child of nodes[{}] and of nodes[{}], expected one "
                                        "parent",
                                        parent_[child], i));
        parent_[child] = i;
      }
    }
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < count; ++i)
      if (parent_[i] == count) open.push_back(i);
    std::size_t placed = 0;
    for (; file_.ok() && placed < open.size(); ++placed) {
      const std::size_t i = open[placed];
      const Affine here = local(*file_.element("nodes", i), node_place(i));
      file_from_node_[i] = parent_[i] == count ? here : file_from_node_[parent_[i]] * here;
      if (!std::ranges::all_of(file_from_node_[i].m, [](double x) { return std::isfinite(x); }))
        file_.fail(node_place(i), "its transformation is not finite");
      open.insert(open.end(), child_[i].begin(), child_[i].end());
    }
    if (file_.ok() && placed < count)
      file_.fail("nodes", "some nodes are their own ancestors, expected trees");
  }

  std::vector<std::size_t> roots() {
    std::vector<std::size_t> out;
    if (!file_.ok()) return out;
    if (file_.count("scenes") == 0) {
      for (std::size_t i = 0; i < parent_.size(); ++i)
        if (parent_[i] == parent_.size()) out.push_back(i);
      return out;
    }
    const std::size_t which = file_.whole(file_.root(), "scene", "", 0);
    const JsonValue* scene = file_.element("scenes", which);
    if (scene == nullptr) return out;
    const std::string place = fmt::format("scenes[{}]", which);
    out = indices(*scene, "nodes", place, parent_.size());
    std::vector<bool> seen(parent_.size());
    for (const std::size_t node : out) {
      if (parent_[node] != parent_.size() || seen[node])
        file_.fail(place + ".nodes",
                   seen[node] ? fmt::format("nodes[{}] stands there twice", node)
                              : fmt::format("nodes[{}] is the child of nodes[{}], expected nodes "
                                            "without a parent",
                                            node, parent_[node]));
      seen[node] = true;
    }
    return out;
  }

  // A node that KHR_node_visibility hides, with all below it.
  bool hidden(std::size_t node) {
    const JsonValue* visibility = extension(*file_.element("nodes", node), "KHR_node_visibility");
    const JsonValue* visible = visibility == nullptr ? nullptr : visibility->find("visible");
    return visible != nullptr && visible->kind == JsonValue::Kind::kBool && !visible->boolean;
  }

  // Returns the places of a node's mesh: one, or those of EXT_mesh_gpu_instancing.
  std::vector<Affine> instances(const JsonValue& node, const std::string& place) {
    const JsonValue* instancing = extension(node, "EXT_mesh_gpu_instancing");
    if (instancing == nullptr) return {Affine{}};
    const std::string where = place + ".extensions.EXT_mesh_gpu_instancing";
    const JsonValue* attributes = instancing->find("attributes");
    std::optional<std::size_t> count;
    const auto read = [&](const char* name, const char* type) {
      GltfFile::Values out;
      if (attributes == nullptr || attributes->find(name) == nullptr) return out;
      out = file_.values(file_.index(*attributes, name, where), type, where);
      if (count && *count != out.count)
        file_.fail(where, fmt::format("{} has {} elements, another attribute has {}", name,
                                      out.count, *count));
      count = out.count;
      return out;
    };
    const GltfFile::Values t = read("TRANSLATION", "VEC3"), q = read("ROTATION", "VEC4"),
                           s = read("SCALE", "VEC3");
    if (!count) file_.fail(where, "has no TRANSLATION, ROTATION or SCALE");
    if (!file_.ok()) return {};
    std::vector<Affine> out;
    constexpr double kNone[4] = {0, 0, 0, 1}, kOnes[3] = {1, 1, 1};
    for (std::size_t i = 0; i < *count; ++i) {
      const double* turn = q.value.empty() ? kNone : &q.value[4 * i];
      if (turn[0] == 0 && turn[1] == 0 && turn[2] == 0 && turn[3] == 0) {
        file_.fail(where, fmt::format("ROTATION of instance {} is 0", i));
        return {};
      }
      out.push_back(of_parts(t.value.empty() ? kNone : &t.value[3 * i], turn,
                             s.value.empty() ? kOnes : &s.value[3 * i]));
    }
    return out;
  }

  // Joints of a skin: from where a vertex was bound to where it is.
  std::vector<Affine> joints(std::size_t index) {
    const JsonValue* skin = file_.element("skins", index);
    if (skin == nullptr) return {};
    const std::string place = fmt::format("skins[{}]", index);
    const std::vector<std::size_t> nodes = indices(*skin, "joints", place, parent_.size());
    GltfFile::Values inverse;
    if (skin->find("inverseBindMatrices") != nullptr)
      inverse = file_.values(file_.index(*skin, "inverseBindMatrices", place), "MAT4", place);
    if (file_.ok() && !inverse.value.empty() && inverse.count < nodes.size())
      file_.fail(place, fmt::format("has {} joints and {} inverse bind matrices", nodes.size(),
                                    inverse.count));
    std::vector<Affine> out;
    for (std::size_t i = 0; file_.ok() && i < nodes.size(); ++i)
      out.push_back(inverse.value.empty()
                        ? file_from_node_[nodes[i]]
                        : file_from_node_[nodes[i]] * of_columns(&inverse.value[16 * i]));
    return out;
  }

  void add_node(std::size_t index) {
    const JsonValue& node = *file_.element("nodes", index);
    if (node.find("mesh") == nullptr) return;
    const std::string place = node_place(index);
    const std::size_t which = file_.index(node, "mesh", place);
    const JsonValue* mesh = file_.element("meshes", which);
    if (mesh == nullptr) return;
    const bool skinned = node.find("skin") != nullptr;
    std::vector<double> weights = file_.numbers(node, "weights", place);
    if (weights.empty())
      weights = file_.numbers(*mesh, "weights", fmt::format("meshes[{}]", which));
    const std::vector<Affine> copies = instances(node, place);
    const std::vector<Affine> bones =
        skinned ? joints(file_.index(node, "skin", place)) : std::vector<Affine>{};
    if (file_.ok() && skinned && extension(node, "EXT_mesh_gpu_instancing") != nullptr)
      file_.fail(place, "has a skin and EXT_mesh_gpu_instancing, which are not read together");
    const JsonValue* primitives = mesh->find("primitives");
    const std::size_t count = primitives == nullptr ? 0 : primitives->item.size();
    const auto name_of = [](const JsonValue& of, std::string otherwise) {
      const JsonValue* name = of.find("name");
      return name == nullptr || name->text.empty() ? std::move(otherwise) : name->text;
    };
    const std::string node_name = name_of(node, place),
                      mesh_name = name_of(*mesh, fmt::format("meshes[{}]", which));
    for (std::size_t p = 0; file_.ok() && p < count; ++p) {
      const JsonValue& primitive = primitives->item[p];
      const std::string where = fmt::format("meshes[{}].primitives[{}]", which, p);
      std::string material;
      if (primitive.find("material") != nullptr) {
        const JsonValue* named =
            file_.element("materials", file_.index(primitive, "material", where));
        if (named != nullptr) material = name_of(*named, "");
      }
      const std::string group = GroupTable::join(
          {node_name, count > 1 ? fmt::format("{}-{}", mesh_name, p) : mesh_name, material});
      add_primitive(primitive, where, weights, group, file_from_node_[index], copies, bones);
    }
  }

  // The corners of a primitive's facets, three by three; none for points and lines.
  std::vector<std::uint32_t> corners(const JsonValue& primitive, const std::string& where,
                                     std::size_t vertices) {
    const std::uint64_t mode = file_.whole(primitive, "mode", where, 4);
    if (mode > 6) file_.fail(where + ".mode", fmt::format("is {}, expected 0 to 6", mode));
    if (!file_.ok() || mode < 4) return {};
    std::vector<std::uint32_t> in;
    if (primitive.find("indices") != nullptr) {
      const GltfFile::Values values =
          file_.values(file_.index(primitive, "indices", where), "SCALAR", where + ".indices");
      in.reserve(values.count);
      for (const double value : values.value) {
        if (!(value >= 0 && value < static_cast<double>(vertices) && value == std::floor(value))) {
          file_.fail(where + ".indices",
                     fmt::format("element {} names vertex {} of {}", in.size(), value, vertices));
          return {};
        }
        in.push_back(static_cast<std::uint32_t>(value));
      }
    } else {
      for (std::size_t i = 0; i < vertices; ++i) in.push_back(static_cast<std::uint32_t>(i));
    }
    if (mode == 4) {
      if (in.size() % 3 != 0)
        file_.fail(where, fmt::format("has {} corners of triangles, no multiple of 3", in.size()));
      return in;
    }
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i + 2 < in.size(); ++i) {
      const bool fan = mode == 6, odd = !fan && i % 2 == 1;
      const std::uint32_t a = fan ? in[0] : in[i], b = in[i + 1], c = in[i + 2];
      if (a == b || b == c || c == a) continue;  // joins two strips
      out.insert(out.end(), {odd ? b : a, odd ? a : b, c});
    }
    return out;
  }

  // Adds the shifts of morph targets, each times its weight.
  void morph(const JsonValue& primitive, const std::string& where,
             const std::vector<double>& weights, GltfFile::Values& position) {
    const JsonValue* targets = primitive.find("targets");
    const std::size_t count = targets == nullptr ? 0 : targets->item.size();
    for (std::size_t i = 0; file_.ok() && i < std::min(count, weights.size()); ++i) {
      if (weights[i] == 0 || targets->item[i].find("POSITION") == nullptr) continue;
      const std::string place = fmt::format("{}.targets[{}]", where, i);
      const GltfFile::Values shift =
          file_.values(file_.index(targets->item[i], "POSITION", place), "VEC3", place);
      if (file_.ok() && shift.count != position.count)
        file_.fail(place, fmt::format("has {} vertices, the primitive has {}", shift.count,
                                      position.count));
      for (std::size_t j = 0; file_.ok() && j < shift.value.size(); ++j)
        position.value[j] += weights[i] * shift.value[j];
    }
  }

  // Compute for each vertex the mean of its joints' transformations.
  std::vector<Affine> skin(const JsonValue& attributes, const std::string& where,
                           std::size_t vertices, const std::vector<Affine>& bones) {
    std::vector<Affine> out(vertices);
    std::vector<double> total(vertices, 0);
    for (Affine& a : out) a.m.fill(0);
    for (int set = 0; file_.ok(); ++set) {
      const std::string of_joints = fmt::format("JOINTS_{}", set),
                        of_weights = fmt::format("WEIGHTS_{}", set);
      if (attributes.find(of_joints) == nullptr || attributes.find(of_weights) == nullptr) {
        if (set == 0)
          file_.fail(where, "its node has a skin, but it has no JOINTS_0 and WEIGHTS_0");
        break;
      }
      const GltfFile::Values joint = file_.values(file_.index(attributes, of_joints, where), "VEC4",
                                                  where + "." + of_joints),
                             weight = file_.values(file_.index(attributes, of_weights, where),
                                                   "VEC4", where + "." + of_weights);
      if (file_.ok() && (joint.count != vertices || weight.count != vertices))
        file_.fail(where, fmt::format("{} has {} elements and {} {}, expected {}", of_joints,
                                      joint.count, of_weights, weight.count, vertices));
      for (std::size_t i = 0; file_.ok() && i < joint.value.size(); ++i) {
        if (weight.value[i] == 0) continue;
        if (!(joint.value[i] >= 0 && joint.value[i] < static_cast<double>(bones.size()))) {
          file_.fail(where + "." + of_joints, fmt::format("vertex {} names joint {} of {}", i / 4,
                                                          joint.value[i], bones.size()));
          break;
        }
        total[i / 4] += weight.value[i];
        for (std::size_t k = 0; k < 12; ++k)
          out[i / 4].m[k] += weight.value[i] * bones[static_cast<std::size_t>(joint.value[i])].m[k];
      }
    }
    for (std::size_t i = 0; file_.ok() && i < vertices; ++i) {
      if (!(total[i] > 0)) file_.fail(where, fmt::format("vertex {} has no weight in its skin", i));
      for (double& x : out[i].m) x /= total[i];
    }
    return out;
  }

  void add_primitive(const JsonValue& primitive, const std::string& where,
                     const std::vector<double>& weights, const std::string& group,
                     const Affine& file_from_node, const std::vector<Affine>& copies,
                     const std::vector<Affine>& bones) {
    const std::uint64_t mode = file_.whole(primitive, "mode", where, 4);
    if (!file_.ok() || mode < 4) return;
    const JsonValue* attributes = primitive.find("attributes");
    // A primitive without positions is nothing to be seen, or an extension has its geometry.
    if (const JsonValue* all = primitive.find("extensions"); all != nullptr)
      for (const auto& [name, value] : all->member)
        if (name.find("compression") != name.npos && !has_plain_copy(attributes))
          return file_.fail(where, fmt::format("the extension {} is not read: export the model "
                                               "without compression",
                                               name));
    if (attributes == nullptr || attributes->find("POSITION") == nullptr)
      return file_.fail(where, "has no attribute POSITION");
    GltfFile::Values position = file_.values(file_.index(*attributes, "POSITION", where), "VEC3",
                                             where + ".attributes.POSITION");
    const std::vector<std::uint32_t> corner = corners(primitive, where, position.count);
    if (!file_.ok() || corner.empty()) return;
    if (mesh_.triangle.size() + corner.size() / 3 * copies.size() > kMostGltfFacets)
      return file_.fail(where, fmt::format("the scene has more than {} facets", kMostGltfFacets));
    // Rounding to float32 concerns the numbers of the file, without morph targets and
    // transformations.
    const bool morphs = primitive.find("targets") != nullptr && !weights.empty();
    const GltfFile::Values apart = morphs ? position : GltfFile::Values{};
    morph(primitive, where, weights, position);
    const GltfFile::Values& as_stored = morphs ? apart : position;
    const std::vector<Affine> posed =
        bones.empty() ? std::vector<Affine>{} : skin(*attributes, where, position.count, bones);
    if (!file_.ok()) return;
    const std::uint32_t group_number = groups_.number(group);
    const auto vertex_of = [](const GltfFile::Values& values, std::size_t i) {
      return Vec<FileFrame>{values.value[3 * i], values.value[3 * i + 1], values.value[3 * i + 2]};
    };
    std::vector<std::uint32_t> number(position.count);
    for (const Affine& copy : copies) {
      const Affine rigid = file_from_node * copy;
      for (std::size_t i = 0; i < position.count; ++i) {
        const Vec<FileFrame> at = (posed.empty() ? rigid : posed[i]).at(vertex_of(position, i));
        if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z))
          return file_.fail(where, fmt::format("vertex {} is moved to infinity", i));
        number[i] = vertices_.number(at);
      }
      for (std::size_t i = 0; i < corner.size(); i += 3) {
        const Affine& here = posed.empty() ? rigid : posed[corner[i]];
        const double determinant = here.determinant();
        std::array<std::uint32_t, 3> triangle{number[corner[i]], number[corner[i + 1]],
                                              number[corner[i + 2]]};
        // A mirroring transformation turns facets inside out.
        if (determinant < 0) std::swap(triangle[0], triangle[2]);
        mesh_.triangle.push_back(triangle);
        mesh_.triangle_group.push_back(group_number);
        if (as_stored.is_float)
          guard_.add(vertex_of(as_stored, corner[i]), vertex_of(as_stored, corner[i + 1]),
                     vertex_of(as_stored, corner[i + 2]), std::pow(std::abs(determinant), 2.0 / 3));
      }
    }
  }

  // Compression that is not required has a plain copy in the accessors.
  bool has_plain_copy(const JsonValue* attributes) {
    if (attributes == nullptr || attributes->find("POSITION") == nullptr) return false;
    const JsonValue* accessor =
        file_.element("accessors", file_.index(*attributes, "POSITION", "attributes"));
    return accessor != nullptr && accessor->find("bufferView") != nullptr;
  }

  GltfFile file_;
  FileMesh mesh_;
  GroupTable groups_;
  VertexMerger vertices_;
  Float32Guard guard_;
  std::vector<std::vector<std::size_t>> child_;
  std::vector<std::size_t> parent_;  // the number of nodes: none
  std::vector<Affine> file_from_node_;
};

}  // namespace

absl::StatusOr<FileMesh> read_gltf(std::string_view bytes, const std::string& file_name) {
  return GltfReader(bytes, file_name).read();
}

}  // namespace irsig

// Binary PLY and STL, glTF and GLB through Assimp, which keeps float32 only.
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "core/scene/import_formats.h"
#include "fmt/format.h"

namespace irsig {
namespace {

// A model is its bytes alone: files that it refers to do not exist.
class NoFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

bool magic_fits(std::string_view bytes, std::string_view form) {
  if (form == "glb") return bytes.substr(0, 4) == "glTF";
  if (form == "ply") return bytes.substr(0, 3) == "ply";
  if (form == "gltf")
    return bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf") < bytes.size() &&
           bytes[bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf")] == '{';
  if (bytes.size() < 84) return false;
  std::uint32_t facets = 0;
  for (std::size_t i = 4; i-- > 0;)
    facets = facets << 8 | static_cast<unsigned char>(bytes[80 + i]);
  return bytes.size() >= 84 + std::uint64_t{50} * facets;
}

// The longest distance between neighbouring float32 numbers at the mesh's coordinates, and its
// shortest edge. Facets that have collapsed to a point are no edges: their neighbours tell.
struct Resolution {
  double spacing = 0, edge = std::numeric_limits<double>::infinity();
};

Resolution resolution_of(const aiMesh& mesh) {
  float farthest = 0;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    farthest = std::max({farthest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  Resolution out;
  out.spacing =
      static_cast<double>(std::nextafter(farthest, std::numeric_limits<float>::infinity())) -
      static_cast<double>(farthest);
  const auto at = [&](const aiFace& face, unsigned corner) {
    const aiVector3D& v = mesh.mVertices[face.mIndices[corner]];
    return Vec<FileFrame>{static_cast<double>(v.x), static_cast<double>(v.y),
                          static_cast<double>(v.z)};
  };
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices < 3) continue;
    for (unsigned j = 0; j < face.mNumIndices; ++j) {
      const double edge = length(at(face, j) - at(face, (j + 1) % face.mNumIndices));
      if (edge > 0) out.edge = std::min(out.edge, edge);
    }
  }
  return out;
}

class Float32Reader {
 public:
  Float32Reader(const aiScene& scene, std::string file_name, bool named)
      : scene_(scene),
        file_name_(std::move(file_name)),
        named_(named),
        groups_(mesh_),
        vertices_(mesh_) {}

  absl::StatusOr<FileMesh> read() {
    std::vector<std::pair<const aiNode*, aiMatrix4x4t<double>>> open;
    open.emplace_back(scene_.mRootNode, aiMatrix4x4t<double>());
    while (!open.empty()) {
      const auto [node, parent] = open.back();
      open.pop_back();
      const aiMatrix4x4t<double> file_from_node =
          parent * aiMatrix4x4t<double>(node->mTransformation);
      for (unsigned i = 0; i < node->mNumMeshes; ++i) {
        const absl::Status status =
            add(*scene_.mMeshes[node->mMeshes[i]], node->mName.C_Str(), file_from_node);
        if (!status.ok()) return status;
      }
      for (unsigned i = node->mNumChildren; i-- > 0;)
        open.emplace_back(node->mChildren[i], file_from_node);
    }
    return std::move(mesh_);
  }

 private:
  absl::Status refuse(const std::string& what) const {
    return absl::InvalidArgumentError(fmt::format("{}: {}", file_name_, what));
  }

  std::string group_of(const aiMesh& mesh, const char* node) const {
    if (!named_) return GroupTable::join({});
    aiString material;
    if (mesh.mMaterialIndex < scene_.mNumMaterials)
      scene_.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, material);
    return GroupTable::join({node, mesh.mName.C_Str(), material.C_Str()});
  }

  absl::Status add(const aiMesh& mesh, const char* node,
                   const aiMatrix4x4t<double>& file_from_node) {
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        return refuse(fmt::format("vertex {} of \"{}\" is not finite", i, group_of(mesh, node)));
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      for (unsigned j = 0; j < mesh.mFaces[i].mNumIndices; ++j) {
        if (mesh.mFaces[i].mIndices[j] >= mesh.mNumVertices)
          return refuse(fmt::format("face {} of \"{}\" uses vertex {}, which does not exist", i,
                                    group_of(mesh, node), mesh.mFaces[i].mIndices[j]));
      }
    }
    const Resolution resolution = resolution_of(mesh);
    if (resolution.spacing > 0.01 * resolution.edge) {
      return refuse(
          fmt::format("float32 coordinates of \"{}\" are {} apart, more than a hundredth of the "
                      "shortest facet edge ({}, in the file's unit): use OBJ, ASCII PLY or ASCII "
                      "STL, or move the model to its origin",
                      group_of(mesh, node), resolution.spacing, resolution.edge));
    }
    std::vector<std::uint32_t> number(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3t<double> at = file_from_node * aiVector3t<double>(mesh.mVertices[i]);
      if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z))
        return refuse(fmt::format("the transformation of node \"{}\" is not finite", node));
      number[i] = vertices_.number({at.x, at.y, at.z});
    }
    // A node that mirrors turns its facets inside out.
    const bool mirrored = file_from_node.Determinant() < 0;
    std::vector<std::uint32_t> corner;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices < 3) continue;
      corner.clear();
      for (unsigned j = 0; j < face.mNumIndices; ++j) corner.push_back(number[face.mIndices[j]]);
      if (mirrored) std::reverse(corner.begin(), corner.end());
      if (!add_polygon(corner, groups_.number(group_of(mesh, node)), mesh_)) {
        return refuse(
            fmt::format("face {} of \"{}\" crosses itself, or is concave with more than {} corners",
                        i, group_of(mesh, node), max_concave_corners));
      }
    }
    return absl::OkStatus();
  }

  const aiScene& scene_;
  std::string file_name_;
  bool named_;  // PLY and binary STL name nothing; what Assimp calls their nodes is its own
  FileMesh mesh_;
  GroupTable groups_;
  VertexMerger vertices_;
};

}  // namespace

absl::StatusOr<FileMesh> read_float32(std::string_view bytes, const std::string& file_name,
                                      const std::string& form) {
  // Assimp would try its other forty readers on what is not the form that it claims to be.
  if (!magic_fits(bytes, form)) {
    return absl::InvalidArgumentError(
        fmt::format("{}: this is no complete {} file", file_name, form));
  }
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new NoFiles);  // the importer owns it
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, form.c_str());
    if (scene == nullptr || scene->mRootNode == nullptr)
      return absl::InvalidArgumentError(
          fmt::format("{}: {}", file_name, importer.GetErrorString()));
    return Float32Reader(*scene, file_name, form == "gltf" || form == "glb").read();
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(fmt::format("{}: {}", file_name, error.what()));
  }
}

}  // namespace irsig

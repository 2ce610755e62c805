// Binary PLY and STL, glTF and GLB through Assimp, which keeps float32 only.
#include "core/scene/importer/import_float32.h"

#include <assimp/BaseImporter.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <new>
#include <sstream>
#include <utility>

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

// Assimp tries its other forty readers on what the form's own cannot make sense of; one of them
// took 3.9 GB for a damaged GLB of 1.4 kB.
void keep_readers_of(const std::string& form, Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::istringstream endings(importer.GetImporterInfo(i)->mFileExtensions);
    const std::istream_iterator<std::string> first(endings), last;
    if (std::find(first, last, form) != last) continue;
    Assimp::BaseImporter* other = importer.GetImporter(i);
    importer.UnregisterLoader(other);
    delete other;
  }
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
  Float32Reader(const aiScene& scene, bool named)
      : scene_(scene), named_(named), groups_(mesh_), vertices_(mesh_) {}

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
        return absl::InvalidArgumentError(
            fmt::format("vertex {} of \"{}\" is not finite", i, group_of(mesh, node)));
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      for (unsigned j = 0; j < mesh.mFaces[i].mNumIndices; ++j) {
        if (mesh.mFaces[i].mIndices[j] >= mesh.mNumVertices)
          return absl::InvalidArgumentError(
              fmt::format("face {} of \"{}\" uses vertex {}, which does not exist", i,
                          group_of(mesh, node), mesh.mFaces[i].mIndices[j]));
      }
    }
    const Resolution resolution = resolution_of(mesh);
    if (resolution.spacing > 0.01 * resolution.edge) {
      return absl::InvalidArgumentError(
          fmt::format("float32 coordinates of \"{}\" are {} apart, more than a hundredth of the "
                      "shortest facet edge ({}, in the file's unit): use OBJ, ASCII PLY or ASCII "
                      "STL, or move the model to its origin",
                      group_of(mesh, node), resolution.spacing, resolution.edge));
    }
    std::vector<std::uint32_t> number(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3t<double> at = file_from_node * aiVector3t<double>(mesh.mVertices[i]);
      if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z))
        return absl::InvalidArgumentError(
            fmt::format("the transformation of node \"{}\" is not finite", node));
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
        return absl::InvalidArgumentError(
            fmt::format("face {} of \"{}\" crosses itself, or is concave with more than {} corners",
                        i, group_of(mesh, node), max_concave_corners));
      }
    }
    return absl::OkStatus();
  }

  const aiScene& scene_;
  bool named_;  // PLY and binary STL name nothing; what Assimp calls their nodes is its own
  FileMesh mesh_;
  GroupTable groups_;
  VertexMerger vertices_;
};

}  // namespace

absl::StatusOr<FileMesh> import_float32(std::string_view bytes, const std::string& form) {
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new NoFiles);  // the importer owns it
    keep_readers_of(form, importer);
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, form.c_str());
    if (importer.GetException()) std::rethrow_exception(importer.GetException());
    if (scene == nullptr || scene->mRootNode == nullptr)
      return absl::InvalidArgumentError(importer.GetErrorString());
    return Float32Reader(*scene, form == "gltf" || form == "glb").read();
  } catch (const std::bad_alloc&) {
    throw;  // whoever set the limit says so
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(error.what());
  }
}

}  // namespace irsig

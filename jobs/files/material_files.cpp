#include "jobs/files/material_files.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/materials/optical/optical_files.h"
#include "jobs/files/material_kinds.h"
#include "jobs/text/section_check.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;

bool has(const schema::Material& material, const char* key) {
  const FieldDescriptor* field = material.GetDescriptor()->FindFieldByName(key);
  return field->is_repeated() ? material.GetReflection()->FieldSize(material, field) > 0
                              : material.GetReflection()->HasField(material, field);
}

std::string material_text(const schema::Material& material, const char* key) {
  return material.GetReflection()->GetString(material,
                                             material.GetDescriptor()->FindFieldByName(key));
}

// The property stands in a file, and nowhere else.
bool only_in_file(const schema::Material& material, const OpticalProperty& property) {
  return has(material, property.file) && !has(material, property.table) &&
         std::none_of(property.value.begin(), property.value.end(),
                      [&](const char* key) { return has(material, key); });
}

absl::Status fill_constants(const std::string& bytes, const std::string& name,
                            schema::Material& material) {
  ASSIGN_OR_RETURN(const auto table, read_optical_constants(bytes, name));
  for (const OpticalConstant& at : table) {
    schema::OpticalConstant& point = *material.add_optical_constants();
    point.set_lambda_um(at.lambda_um);
    point.set_n(at.n);
    point.set_k(at.k);
  }
  return absl::OkStatus();
}

absl::Status fill_brdf(const std::string& bytes, const std::string& name,
                       schema::Material& material) {
  ASSIGN_OR_RETURN(const auto table, read_brdf(bytes, name));
  schema::BrdfTable& brdf = *material.mutable_brdf();
  for (const double v : table.lambda_um) brdf.add_lambda_um(v);
  for (const double v : table.theta_i_deg) brdf.add_theta_i_deg(v);
  for (const double v : table.theta_r_deg) brdf.add_theta_r_deg(v);
  for (const double v : table.phi_deg) brdf.add_phi_deg(v);
  for (const float v : table.brdf_per_sr) brdf.add_brdf_per_sr(static_cast<double>(v));
  return absl::OkStatus();
}

// "specular_reflectance" is a reflectance to whoever measured it.
absl::Status fill_spectrum(const std::string& bytes, const std::string& name,
                           const OpticalProperty& property, schema::Material& material) {
  const bool emissivity = std::string(property.name) == "emissivity";
  ASSIGN_OR_RETURN(const auto table,
                   read_spectrum(bytes, name, emissivity ? "emissivity" : "reflectance"));
  const FieldDescriptor* field = material.GetDescriptor()->FindFieldByName(property.table);
  for (const SpectralPoint& at : table) {
    auto& point = static_cast<schema::SpectralPoint&>(
        *material.GetReflection()->AddMessage(&material, field));
    point.set_lambda_um(at.lambda_um);
    point.set_value(at.value);
  }
  return absl::OkStatus();
}

absl::Status fill(const std::string& bytes, const std::string& name,
                  const OpticalProperty& property, schema::Material& material) {
  const std::string table = property.table;
  if (table == "optical_constants") return fill_constants(bytes, name, material);
  if (table == "brdf") return fill_brdf(bytes, name, material);
  return fill_spectrum(bytes, name, property, material);
}

}  // namespace

absl::Status read_material_files(SweepFile& file, const FileReader& read) {
  Problems wrong;
  for (int i = 0; i < file.sweep.material_size(); ++i) {
    schema::Material& material = *file.sweep.mutable_material(i);
    const MaterialKind* kind = find_material_kind(material.kind());
    if (kind == nullptr) continue;
    for (const OpticalProperty& property : kind->property) {
      if (!only_in_file(material, property)) continue;
      const std::string name = material_text(material, property.file);
      const std::string path = absl::StrCat("material[", i, "].", property.file);
      const absl::StatusOr<std::string> bytes = read(name);
      if (!bytes.ok()) {
        wrong.add(placed_problem(
            file.location(path),
            absl::StrCat(path, " = \"", one_line(name), "\": ", bytes.status().message())));
        continue;
      }
      const absl::Status status = fill(*bytes, one_line(name), property, material);
      if (!status.ok()) {
        wrong.add(status);
        continue;
      }
      file.where[absl::StrCat("material[", i, "].", property.table)] = file.location(path);
      material.GetReflection()->ClearField(
          &material, material.GetDescriptor()->FindFieldByName(property.file));
    }
  }
  return wrong.status();
}

}  // namespace irsig

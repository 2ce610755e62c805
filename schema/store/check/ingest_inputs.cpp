#include "schema/store/check/ingest_inputs.h"

#include <algorithm>
#include <initializer_list>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

std::optional<double> if_change_stated(bool stated, double value) {
  return stated ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<std::string> input_names(const schema::ResolvedSweep& sweep) {
  const schema::Uncertainty& stated = sweep.sweep().uncertainty();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  stated.GetReflection()->ListFields(stated, &fields);
  std::vector<std::string> out;
  for (const google::protobuf::FieldDescriptor* field : fields)
    if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE)
      out.push_back(field->name());
  return out;
}

absl::Status check_inputs(const schema::SignatureRow& row, const std::vector<std::string>& names,
                          const std::string& path) {
  const auto wrong = [&](const std::string& what) {
    return absl::InvalidArgumentError(absl::StrCat("result: ", path, what));
  };
  if (row.input_size() != static_cast<int>(names.size()))
    return wrong(absl::StrCat(".input has ", row.input_size(), " of the sweep's ", names.size(),
                              " uncertain inputs"));
  for (int i = 0; i < row.input_size(); ++i) {
    const schema::InputContribution& input = row.input(i);
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (input.input() != name)
      return wrong(absl::StrCat(".input[", i, "] is not the sweep's, ", name));
    if (!input.has_contribution_w_sr() || !input.has_apparent_contribution_w_sr() ||
        !input.has_contrast_contribution_w_sr())
      return wrong(absl::StrCat(".input[", i, "] is incomplete"));
  }
  const auto of_model = std::count_if(names.begin(), names.end(), is_of_heat_model);
  const auto check = [&](bool asked, std::initializer_list<bool> stated, const char* name) {
    for (const bool has : stated)
      if (has != asked)
        return wrong(absl::StrCat(".", name, asked ? " is missing" : " was not asked for"));
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(
      check(of_model < static_cast<std::ptrdiff_t>(names.size()),
            {row.has_input_uncertainty_w_sr(), row.has_apparent_input_uncertainty_w_sr(),
             row.has_contrast_input_uncertainty_w_sr()},
            "input_uncertainty_w_sr"));
  return check(of_model > 0,
               {row.has_heat_model_error_w_sr(), row.has_apparent_heat_model_error_w_sr(),
                row.has_contrast_heat_model_error_w_sr()},
               "heat_model_error_w_sr");
}

absl::Status insert_inputs(Database& database, std::int64_t signature_id,
                           const schema::SignatureRow& row) {
  for (int i = 0; i < row.input_size(); ++i) {
    const schema::InputContribution& c = row.input(i);
    IRSIG_STORE_TRY(database.run(
        sql::insert_input_contribution, signature_id, i, c.input(), c.contribution_w_sr().value(),
        c.contribution_w_sr().stderr(), c.apparent_contribution_w_sr().value(),
        c.apparent_contribution_w_sr().stderr(), c.contrast_contribution_w_sr().value(),
        c.contrast_contribution_w_sr().stderr(),
        if_change_stated(c.has_curvature_w_sr(), c.curvature_w_sr()),
        if_change_stated(c.has_apparent_curvature_w_sr(), c.apparent_curvature_w_sr()),
        if_change_stated(c.has_contrast_curvature_w_sr(), c.contrast_curvature_w_sr())));
  }
  return absl::OkStatus();
}

}  // namespace irsig

#include <set>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/materials/optical/material_library.h"
#include "core/materials/optical/yaml_block.h"

namespace irsig {
namespace {

// The keys of one entry, each taken once; what is left at the end does not belong.
class Entry {
 public:
  Entry(const YAML::Node& root, std::string_view text, TableErrors& errors)
      : root_(root), text_(text), errors_(errors) {}

  std::string string(const char* key) {
    const YAML::Node node = take(key);
    if (!node.IsDefined()) return "";
    if (!node.IsScalar() || node.Scalar().empty()) {
      at(node, absl::StrCat(key, " is no text"));
      return "";
    }
    return node.Scalar();
  }

  double number(const char* key, double least, double most) {
    const YAML::Node node = take(key);
    double value = 0;
    if (!node.IsDefined()) return value;
    if (!node.IsScalar() || !absl::SimpleAtod(node.Scalar(), &value) ||
        !(value >= least && value <= most))
      at(node, absl::StrCat(key, ", expected a number from ", least, " to ", most));
    return value;
  }

  // One number, or a block of "lambda_um value" rows.
  Spectrum spectrum(const char* key) {
    const YAML::Node node = take(key);
    double value = 0;
    if (!node.IsDefined()) return {};
    if (node.IsScalar() && absl::SimpleAtod(node.Scalar(), &value)) {
      if (!(value >= 0 && value <= 1))
        at(node, absl::StrCat(key, ", expected a number from 0 to 1"));
      return {{0, value}};
    }
    Spectrum out;
    for (const auto& row : rows(node, 2)) {
      if (!(row[1].value >= 0 && row[1].value <= 1))
        errors_.add(row[1], absl::StrCat(row[1].value, ", expected a number from 0 to 1"));
      out.push_back({row[0].value, row[1].value});
    }
    return out;
  }

  OpticalConstants constants(const char* key) {
    const YAML::Node node = take(key);
    OpticalConstants out;
    if (!node.IsDefined()) return out;
    for (const auto& row : rows(node, 3)) {
      if (!(row[1].value > 0)) errors_.add(row[1], "n, expected a number above 0");
      if (!(row[2].value >= 0)) errors_.add(row[2], "k, expected 0 or more");
      out.push_back({row[0].value, row[1].value, row[2].value});
    }
    return out;
  }

  template <typename Value>
  Value choice(const char* key, std::initializer_list<std::pair<const char*, Value>> choices) {
    const YAML::Node node = take(key);
    Value value = choices.begin()->second;
    if (!node.IsDefined()) return value;
    for (const auto& [name, meaning] : choices)
      if (node.IsScalar() && node.Scalar() == name) return meaning;
    at(node, absl::StrCat(key, " is not known"));
    return value;
  }

  void unknown_kind() { at(root_["kind"], "kind, expected \"lambert\" or \"cook_torrance\""); }

  void finish() {
    for (const auto& item : root_)
      if (!item.first.IsScalar() || !taken_.contains(item.first.Scalar()))
        at(item.first, "a key that this kind of material does not have");
  }

 private:
  YAML::Node take(const char* key) {
    taken_.insert(key);
    const YAML::Node node = root_[key];
    if (!node.IsDefined()) errors_.add(1, 1, absl::StrCat(key, " is missing"));
    return node;
  }

  std::vector<std::vector<PlacedNumber>> rows(const YAML::Node& node, std::size_t columns) {
    auto out = block_rows(node, root_.Mark(), text_, columns, errors_);
    check_wavelengths(out, errors_);
    return out;
  }

  void at(const YAML::Node& node, const std::string& what) {
    errors_.add(node.Mark().line + 1, node.Mark().column + 1, what);
  }

  const YAML::Node root_;
  std::string_view text_;
  TableErrors& errors_;
  std::set<std::string> taken_;
};

}  // namespace

absl::StatusOr<LibraryEntry> read_library_entry(std::string_view text, std::string_view file_name) {
  TableErrors errors(file_name);
  const auto root = load_yaml(text, errors);
  if (!root) return errors.status();
  if (!root->IsMap()) {
    errors.add(1, 1, "no keys, expected a material");
    return errors.status();
  }
  Entry entry(*root, text, errors);
  LibraryEntry out;
  out.spec.name = entry.string("name");
  out.description = entry.string("description");
  out.source = entry.string("source");
  out.licence = entry.string("licence");
  out.provenance = entry.string("provenance");
  const std::string kind = entry.string("kind");
  if (kind == "lambert") {
    out.spec.model = Lambert{entry.spectrum("emissivity")};
  } else if (kind == "cook_torrance") {
    CookTorrance lobe;
    lobe.constants = entry.constants("optical_constants");
    lobe.roughness = entry.number("roughness", 1e-4, 1);
    lobe.fresnel = entry.choice<Fresnel>(
        "fresnel", {{"exact", Fresnel::kExact}, {"schlick", Fresnel::kSchlick}});
    lobe.masking = entry.choice<Masking>(
        "masking", {{"v_groove", Masking::kVGroove}, {"smith", Masking::kSmith}});
    out.spec.model = lobe;
  } else if (!kind.empty()) {
    entry.unknown_kind();
    return errors.status();
  }
  entry.finish();
  if (!errors.empty()) return errors.status();
  return out;
}

}  // namespace irsig

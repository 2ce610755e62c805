#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/scene/import/import_json.h"

namespace irsig {

// A glTF 2.0 file: its JSON, its buffers, and numbers out of its accessors. Every function reports
// the first problem to status() and returns something empty from then on; a caller looks at ok()
// where it would go on for long. Problems name their place as the file has it:
// "accessors[3].count".
class GltfFile {
 public:
  // bytes: GLB or JSON, told apart by the first bytes; they must outlive the file.
  GltfFile(std::string_view bytes, const std::string& file_name);

  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const absl::Status& status() const { return status_; }
  void fail(std::string_view place, std::string_view what);

  [[nodiscard]] const JsonValue& root() const { return root_; }
  // Returns the element `index` of the file's list `name`, as "nodes"; null where it does not
  // exist.
  const JsonValue* element(std::string_view name, std::size_t index);
  [[nodiscard]] std::size_t count(std::string_view name) const;
  // Returns a whole number from 0 to 2^32 - 1; `otherwise` where there is none of that name.
  std::uint64_t whole(const JsonValue& of, std::string_view name, std::string_view place,
                      std::uint64_t otherwise);
  // Returns the index of something; fails where it is absent.
  std::size_t index(const JsonValue& of, std::string_view name, std::string_view place);
  // Returns the numbers of a list; an empty list where it is absent.
  std::vector<double> numbers(const JsonValue& of, std::string_view name, std::string_view place);

  // An accessor holds numbers of one type and one shape.
  struct Values {
    std::size_t count = 0;  // of elements
    std::size_t width = 0;  // numbers in an element
    bool is_float = false;
    std::vector<double> value;  // normalised integers as fractions
  };
  // Reads an accessor that must be of the given type ("SCALAR", "VEC3", ...).
  Values values(std::size_t accessor, std::string_view type, std::string_view place);

 private:
  void read_container(std::string_view bytes);
  void check_version();
  std::string_view buffer(std::size_t index);
  std::string_view view(std::size_t index, std::string_view place, std::uint64_t& stride);
  void read_numbers(std::string_view bytes, std::uint64_t stride, std::uint64_t component,
                    bool normalized, Values& out);
  void put_sparse(const JsonValue& sparse, std::string_view place, std::uint64_t component,
                  bool normalized, Values& out);

  const std::string& file_name_;
  absl::Status status_;
  JsonValue root_;
  std::string_view binary_;  // the second chunk of a GLB
  bool has_binary_ = false;
  std::map<std::size_t, std::string> decoded_;  // buffers of data URIs
};

// Decodes the bytes of a data URI, whatever its media type. INVALID_ARGUMENT: it is not base64.
[[nodiscard]] absl::StatusOr<std::string> bytes_of_data_uri(std::string_view uri);

}  // namespace irsig

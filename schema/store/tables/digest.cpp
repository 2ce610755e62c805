#include "schema/store/tables/digest.h"

#include <bit>
#include <string_view>
#include <vector>

#include "core/base/status_macros.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

// The encoding of one value is a letter and its content, so that no two lists of values have the
// same bytes: 'i' integer and 'r' real (IEEE 754 bits) in 8 bytes, little-endian; 't' text and 'b'
// blob after their length in 8 bytes; 'n' NULL. Each statement starts with 's' and each of its rows
// with '|'.
class Encoder {
 public:
  void integer(std::int64_t value) { tagged('i', static_cast<std::uint64_t>(value)); }
  void real(double value) { tagged('r', std::bit_cast<std::uint64_t>(value)); }
  void bytes(char letter, std::string_view value) {
    tagged(letter, value.size());
    hash_.add(value);
  }
  void mark(char letter) { hash_.add({&letter, 1}); }
  std::string hex() { return hash_.hex(); }

 private:
  void tagged(char letter, std::uint64_t value) {
    char text[9] = {letter};
    for (int byte = 0; byte < 8; ++byte)
      text[byte + 1] = static_cast<char>(value >> (8 * byte) & 0xff);
    hash_.add({text, sizeof text});
  }

  Sha256 hash_;
};

void encode_value(Rows& row, Encoder& out) {
  switch (row.type()) {
    case Rows::Type::kInteger:
      return out.integer(row.integer());
    case Rows::Type::kReal:
      return out.real(row.real());
    case Rows::Type::kText:
      return out.bytes('t', row.blob());
    case Rows::Type::kBlob:
      return out.bytes('b', row.blob());
    case Rows::Type::kNull:
      row.integer();
      return out.mark('n');
  }
}

// Runs a statement and encodes its rows, every value by its type: the tables are STRICT, so that is
// the column's. With kKey the first column is an id, which is not content: the ids are returned
// instead.
enum class First { kKey, kContent };
template <typename... Values>
absl::StatusOr<std::vector<std::int64_t>> encode(Database& database, Encoder& out, First first,
                                                 const char* statement, const Values&... values) {
  std::vector<std::int64_t> keys;
  ASSIGN_OR_RETURN(Rows row, database.query(statement, values...));
  out.mark('s');
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return keys;
    out.mark('|');
    if (first == First::kKey) keys.push_back(row.integer());
    while (!row.at_end()) encode_value(row, out);
  }
}

absl::Status encode_definitions(Database& database, Encoder& out, std::int64_t sweep_id) {
  IRSIG_STORE_TRY(
      encode(database, out, First::kContent, sql::digest_viewpoints, sweep_id).status());
  ASSIGN_OR_RETURN(const auto conditions,
                   encode(database, out, First::kKey, sql::digest_conditions, sweep_id));
  for (const std::int64_t condition_id : conditions) {
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_part_temperatures, condition_id)
            .status());
  }
  ASSIGN_OR_RETURN(const auto bands,
                   encode(database, out, First::kKey, sql::digest_bands, sweep_id));
  for (const std::int64_t band_id : bands) {
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_band_response, band_id).status());
  }
  IRSIG_STORE_TRY(encode(database, out, First::kContent, sql::digest_parts, sweep_id).status());
  return encode(database, out, First::kContent, sql::digest_published, sweep_id).status();
}

absl::Status encode_temperatures(Database& database, Encoder& out, std::int64_t sweep_id) {
  ASSIGN_OR_RETURN(const std::int64_t any, database.integer(sql::has_heat_output, sweep_id));
  if (any == 0) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto jobs,
                   encode(database, out, First::kKey, sql::digest_heat_jobs, sweep_id));
  for (const std::int64_t job_id : jobs) {
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_computed_temperatures, job_id).status());
  }
  return absl::OkStatus();
}

absl::Status encode_signatures(Database& database, Encoder& out, std::int64_t sweep_id) {
  ASSIGN_OR_RETURN(const auto signatures,
                   encode(database, out, First::kKey, sql::digest_signatures, sweep_id));
  for (const std::int64_t signature_id : signatures) {
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_spectrum, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_part_intensities, signature_id)
            .status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_ledger, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_energy, signature_id).status());
    ASSIGN_OR_RETURN(const std::int64_t plume, database.integer(sql::has_plume, signature_id));
    if (plume != 0)
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_plume, signature_id).status());
    ASSIGN_OR_RETURN(const std::int64_t details,
                     database.integer(sql::has_plume_details, signature_id));
    if (details != 0)
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_plume_details, signature_id).status());
    ASSIGN_OR_RETURN(const std::int64_t clutter, database.integer(sql::has_clutter, signature_id));
    if (clutter != 0) {
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_clutter, signature_id).status());
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_clutter_materials, signature_id)
              .status());
    }
    ASSIGN_OR_RETURN(const std::int64_t inputs,
                     database.integer(sql::has_input_contributions, signature_id));
    if (inputs != 0)
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_input_contributions, signature_id)
              .status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_thumbnail, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_image_layers, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_silhouette, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_part_pixels, signature_id).status());
    ASSIGN_OR_RETURN(const std::int64_t whole, database.integer(sql::has_part_sets, signature_id));
    if (whole != 0)
      IRSIG_STORE_TRY(
          encode(database, out, First::kContent, sql::digest_part_sets, signature_id).status());
    IRSIG_STORE_TRY(
        encode(database, out, First::kContent, sql::digest_profile, signature_id).status());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> content_digest(Database& database) {
  Encoder out;
  out.bytes('t', "irsig digest 7");
  ASSIGN_OR_RETURN(const auto sweeps, encode(database, out, First::kKey, sql::digest_sweeps));
  for (const std::int64_t sweep_id : sweeps) {
    IRSIG_STORE_TRY(encode_definitions(database, out, sweep_id));
    IRSIG_STORE_TRY(encode_temperatures(database, out, sweep_id));
    IRSIG_STORE_TRY(encode_signatures(database, out, sweep_id));
  }
  return out.hex();
}

}  // namespace irsig

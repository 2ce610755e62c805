#include "coordinator/client/certificate.h"

#include <openssl/err.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "coordinator/client/openssl_handles.h"

namespace irsig {
namespace {

constexpr std::string_view kRoleArc = "2.25.229628290256372065999791439529870542176";
constexpr double kDay_s = 86400;
constexpr double kSoon_s = 14 * kDay_s;

double unix_s(const ASN1_TIME* time) {
  std::tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? static_cast<double>(timegm(&parts)) : 0;
}

std::string text_of(const ASN1_OBJECT* object) {
  char text[256] = {};
  OBJ_obj2txt(text, sizeof(text), object, 1);
  return text;
}

std::string common_name(const X509& certificate) {
  const X509_NAME* subject = X509_get_subject_name(&certificate);
  const int at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (at < 0) return "";
  unsigned char* text = nullptr;
  const int bytes =
      ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
  if (bytes < 0) return "";
  std::string out(reinterpret_cast<const char*>(text), static_cast<std::size_t>(bytes));
  OPENSSL_free(text);
  return out;
}

}  // namespace

std::string hex_of(const ASN1_INTEGER* serial) {
  const std::unique_ptr<BIGNUM, Freed<BN_free>> number(ASN1_INTEGER_to_BN(serial, nullptr));
  char* text = number ? BN_bn2hex(number.get()) : nullptr;
  std::string out = text == nullptr ? "" : absl::AsciiStrToLower(text);
  OPENSSL_free(text);
  return out;
}

std::string_view role_name(Role role) {
  switch (role) {
    case Role::kSubmit:
      return "submit";
    case Role::kWork:
      return "work";
    case Role::kRead:
      return "read";
  }
  return "";
}

absl::StatusOr<Role> role_by_name(std::string_view name) {
  for (const Role role : kRoles)
    if (role_name(role) == name) return role;
  return absl::InvalidArgumentError(
      absl::StrCat("role \"", std::string(name), "\", expected submit, work or read"));
}

std::string role_list(const std::set<Role>& roles, std::string_view word) {
  std::string out;
  std::size_t left = roles.size();
  for (const Role role : roles) {
    absl::StrAppend(&out, std::string(role_name(role)));
    if (--left > 0)
      absl::StrAppend(&out, left > 1 ? ", " : absl::StrCat(" ", std::string(word), " "));
  }
  return out;
}

std::string role_oid(Role role) {
  return absl::StrCat(std::string(kRoleArc), ".", static_cast<int>(role) + 1);
}

absl::StatusOr<CertificateFacts> certificate_facts(const std::string& pem) {
  const auto chain = certificates_of(pem);
  if (chain.empty()) return absl::InvalidArgumentError("has no certificate, expected one in PEM");
  const X509& certificate = *chain.front();
  CertificateFacts out;
  out.name = common_name(certificate);
  out.serial_hex = hex_of(X509_get0_serialNumber(&certificate));
  out.valid_from_unix_s = unix_s(X509_get0_notBefore(&certificate));
  out.valid_until_unix_s = unix_s(X509_get0_notAfter(&certificate));
  const std::unique_ptr<EXTENDED_KEY_USAGE, Freed<EXTENDED_KEY_USAGE_free>> usage(
      static_cast<EXTENDED_KEY_USAGE*>(
          X509_get_ext_d2i(&certificate, NID_ext_key_usage, nullptr, nullptr)));
  for (int i = 0; usage && i < sk_ASN1_OBJECT_num(usage.get()); ++i) {
    const ASN1_OBJECT* purpose = sk_ASN1_OBJECT_value(usage.get(), i);
    if (OBJ_obj2nid(purpose) == NID_server_auth) out.of_a_server = true;
    const std::string oid = text_of(purpose);
    for (const Role role : kRoles)
      if (oid == role_oid(role)) out.roles.insert(role);
  }
  ERR_clear_error();
  return out;
}

std::string running_out(const CertificateFacts& facts, double now_unix_s) {
  const double left_s = facts.valid_until_unix_s - now_unix_s;
  if (left_s <= 0) return "has expired";
  const double tenth_s = (facts.valid_until_unix_s - facts.valid_from_unix_s) / 10;
  if (left_s > std::min(kSoon_s, tenth_s)) return "";
  const auto in = [&](double unit_s, const char* unit) {
    const auto count = static_cast<std::int64_t>(std::floor(left_s / unit_s));
    return absl::StrCat("expires in ", count, " ", unit, count == 1 ? "" : "s");
  };
  return left_s >= kDay_s ? in(kDay_s, "day")
         : left_s >= 3600 ? in(3600, "hour")
                          : in(60, "minute");
}

std::vector<std::string> running_out(const TlsIdentity& identity, double now_unix_s) {
  std::vector<std::string> out;
  for (const auto& [what, pem] :
       {std::pair<const char*, const std::string&>{"the certificate", identity.certificate},
        {"the authority's certificate", identity.ca}}) {
    const auto facts = certificate_facts(pem);
    if (!facts.ok()) continue;  // read_tls has refused it
    if (const std::string end = running_out(*facts, now_unix_s); !end.empty())
      out.push_back(absl::StrCat(what, " \"", facts->name, "\" ", end));
  }
  return out;
}

absl::StatusOr<std::set<std::string>> revoked_serials(const std::string& crl,
                                                      const std::string& ca) {
  const Bio bio(BIO_new_mem_buf(crl.data(), static_cast<int>(crl.size())));
  const std::unique_ptr<X509_CRL, Freed<X509_CRL_free>> list(
      PEM_read_bio_X509_CRL(bio.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (!list) return absl::InvalidArgumentError("has no revocation list, expected one in PEM");
  const auto authorities = certificates_of(ca);
  const bool is_signed =
      std::any_of(authorities.begin(), authorities.end(), [&](const Certificate& authority) {
        return X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) == 1;
      });
  ERR_clear_error();
  if (!is_signed)
    return absl::InvalidArgumentError("is no revocation list of the authority in --tls-ca");
  std::set<std::string> out;
  const STACK_OF(X509_REVOKED)* revoked = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(revoked); ++i)
    out.insert(hex_of(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(revoked, i))));
  return out;
}

}  // namespace irsig

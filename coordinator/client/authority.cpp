#include "coordinator/client/authority.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <tuple>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "coordinator/client/openssl_handles.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostPemBytes = 1'000'000;
constexpr double kClocksDiffer_s = 300;
constexpr std::size_t kLongestName = 64;  // of a common name: RFC 5280, ub-common-name

absl::Status openssl_failed(const char* what) {
  char text[256] = "no reason given";
  if (const unsigned long error = ERR_get_error(); error != 0)
    ERR_error_string_n(error, text, sizeof(text));
  ERR_clear_error();
  return absl::InternalError(absl::StrCat("OpenSSL: ", what, ": ", text));
}

absl::Status file_failed(const std::string& path, const char* what) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", what, ": ", std::strerror(errno)));
}

// Whole or not at all, also after a power cut.
enum class Existing { kIsAnError, kIsReplaced };
absl::Status write_file(const std::string& path, const std::string& bytes, mode_t mode,
                        Existing existing = Existing::kIsAnError) {
  const std::string draft = absl::StrCat(path, ".new-", getpid());
  const int fd = open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) return file_failed(draft, "cannot be written");
  const bool written = write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  const bool on_disk = written && fsync(fd) == 0;
  close(fd);
  const bool placed =
      on_disk && (existing == Existing::kIsReplaced ? rename(draft.c_str(), path.c_str()) == 0
                                                    : link(draft.c_str(), path.c_str()) == 0);
  const int error = errno;
  unlink(draft.c_str());
  errno = error;
  if (placed) return absl::OkStatus();
  if (existing == Existing::kIsAnError && error == EEXIST)
    return absl::AlreadyExistsError(absl::StrCat(path, " is there already"));
  return file_failed(path, "cannot be written");
}

absl::StatusOr<std::string> read_file(const std::string& path) {
  auto bytes = read_user_file(path, kMostPemBytes);
  if (!bytes.ok())
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": ", std::string(bytes.status().message())));
  return bytes;
}

template <class Write>
std::string pem_of(Write write) {
  const Bio bio(BIO_new(BIO_s_mem()));
  if (write(bio.get()) != 1) return "";
  const char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}
std::string pem_of(X509* certificate) {
  return pem_of([&](BIO* bio) { return PEM_write_bio_X509(bio, certificate); });
}
std::string pem_of(EVP_PKEY* key) {
  return pem_of([&](BIO* bio) {
    return PEM_write_bio_PKCS8PrivateKey(bio, key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

absl::Status check_name(const std::string& name) {
  const bool fine = !name.empty() && name.size() <= kLongestName && name[0] != '.' &&
                    name[0] != '-' && std::all_of(name.begin(), name.end(), [](char c) {
                      return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' ||
                             c == '_' || c == '-';
                    });
  if (fine && name != "ca" && name != "crl") return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("name \"", name, "\", expected 1 to ", kLongestName,
                   " letters, digits, \".\", \"_\" and \"-\", and neither \"ca\" nor \"crl\""));
}

// A host as a subject alternative name: "IP:192.0.2.7", "DNS:node7.example".
absl::StatusOr<std::string> alternative_name(const std::string& host) {
  in6_addr any{};
  for (const int family : {AF_INET, AF_INET6})
    if (inet_pton(family, host.c_str(), &any) == 1) return "IP:" + host;
  const std::vector<std::string> labels = absl::StrSplit(host, '.');
  const bool fine =
      host.size() <= 253 && host.find_first_not_of("0123456789.") != std::string::npos &&
      std::all_of(labels.begin(), labels.end(), [](const std::string& label) {
        return !label.empty() && label.size() <= 63 && label.front() != '-' &&
               label.back() != '-' && std::all_of(label.begin(), label.end(), [](char c) {
                 return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-';
               });
      });
  if (fine) return "DNS:" + host;
  return absl::InvalidArgumentError(absl::StrCat(
      "host \"", host,
      "\", expected a name of letters, digits and \"-\" between dots, an IPv4 or an IPv6 address"));
}

absl::Status add_extension(X509* certificate, X509* issuer, int kind, const std::string& text) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, text.c_str()));
  if (!extension || X509_add_ext(certificate, extension.get(), -1) != 1)
    return openssl_failed(OBJ_nid2ln(kind));
  return absl::OkStatus();
}

struct Authority {
  std::string folder;
  Certificate certificate;
  PrivateKey key;

  [[nodiscard]] std::string file(const std::string& name) const { return folder + "/" + name; }
};

absl::StatusOr<Authority> open_authority(const std::string& folder) {
  Authority out{folder, nullptr, nullptr};
  ASSIGN_OR_RETURN(const auto pem, read_file(out.file("ca.pem")));
  ASSIGN_OR_RETURN(const auto key, read_file(out.file("ca.key")));
  auto chain = certificates_of(pem);
  out.key = private_key_of(key);
  if (chain.size() != 1 || !out.key || X509_check_private_key(chain[0].get(), out.key.get()) != 1) {
    ERR_clear_error();
    return absl::InvalidArgumentError(absl::StrCat(
        folder, ": ca.pem and ca.key are no certificate and its key; `irsig ca init` makes them"));
  }
  out.certificate = std::move(chain[0]);
  return out;
}

// Serial number, dates and names; the rest is what makes it an authority's or somebody's.
absl::StatusOr<Certificate> begin_certificate(const std::string& name, X509* issuer, EVP_PKEY* key,
                                              double from_unix_s, double until_unix_s) {
  Certificate out(X509_new());
  const std::unique_ptr<BIGNUM, Freed<BN_free>> serial(BN_new());
  X509_NAME* subject = X509_get_subject_name(out.get());
  const bool done =
      X509_set_version(out.get(), X509_VERSION_3) == 1 &&
      BN_rand(serial.get(), 127, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
      BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(out.get())) != nullptr &&
      X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                 reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1,
                                 0) == 1 &&
      X509_set_issuer_name(out.get(),
                           issuer == nullptr ? subject : X509_get_subject_name(issuer)) == 1 &&
      ASN1_TIME_set(X509_getm_notBefore(out.get()), static_cast<time_t>(from_unix_s)) != nullptr &&
      ASN1_TIME_set(X509_getm_notAfter(out.get()), static_cast<time_t>(until_unix_s)) != nullptr &&
      X509_set_pubkey(out.get(), key) == 1;
  if (!done) return openssl_failed("a certificate");
  return out;
}

absl::Status write_list(const Authority& authority, X509_CRL* list, double now_unix_s) {
  X509_CRL_sort(list);
  const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> now(
      ASN1_TIME_set(nullptr, static_cast<time_t>(now_unix_s)));
  const bool done =
      X509_CRL_set_version(list, X509_CRL_VERSION_2) == 1 &&
      X509_CRL_set_issuer_name(list, X509_get_subject_name(authority.certificate.get())) == 1 &&
      X509_CRL_set1_lastUpdate(list, now.get()) == 1 &&
      X509_CRL_set1_nextUpdate(list, X509_get0_notAfter(authority.certificate.get())) == 1 &&
      X509_CRL_sign(list, authority.key.get(), EVP_sha256()) > 0;
  if (!done) return openssl_failed("a revocation list");
  const std::string pem = pem_of([&](BIO* bio) { return PEM_write_bio_X509_CRL(bio, list); });
  return write_file(authority.file("crl.pem"), pem, 0644, Existing::kIsReplaced);
}

double expiry_of(const Authority& authority) {
  const auto facts = certificate_facts(pem_of(authority.certificate.get()));
  return facts.ok() ? facts->valid_until_unix_s : 0;
}

}  // namespace

absl::Status make_authority(const std::string& folder, const std::string& name, double now_unix_s,
                            double valid_s) {
  if (name.empty() || name.size() > kLongestName ||
      !std::all_of(name.begin(), name.end(),
                   [](char c) { return absl::ascii_isprint(static_cast<unsigned char>(c)); }))
    return absl::InvalidArgumentError(absl::StrCat("the authority's name has ", name.size(),
                                                   " bytes, expected 1 to ", kLongestName,
                                                   " letters, digits, blanks and signs of ASCII"));
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return file_failed(folder, "cannot be made");
  std::error_code error;
  if (!std::filesystem::is_empty(folder, error) || error)
    return absl::AlreadyExistsError(absl::StrCat(
        folder, " is there already, expected a folder that does not exist or is empty"));
  if (chmod(folder.c_str(), 0700) != 0 || mkdir((folder + "/issued").c_str(), 0700) != 0)
    return file_failed(folder, "cannot be used");
  Authority authority{folder, nullptr,
                      PrivateKey(EVP_PKEY_Q_keygen(nullptr, nullptr, "EC", "P-256"))};
  if (!authority.key) return openssl_failed("a key");
  ASSIGN_OR_RETURN(authority.certificate,
                   begin_certificate(name, nullptr, authority.key.get(),
                                     now_unix_s - kClocksDiffer_s, now_unix_s + valid_s));
  X509* const own = authority.certificate.get();
  for (const auto& [kind, text] : {std::pair{NID_basic_constraints, "critical,CA:TRUE,pathlen:0"},
                                   {NID_key_usage, "critical,keyCertSign,cRLSign"},
                                   {NID_subject_key_identifier, "hash"}})
    RETURN_IF_ERROR(add_extension(own, own, kind, text));
  if (X509_sign(own, authority.key.get(), EVP_sha256()) == 0) return openssl_failed("a signature");
  RETURN_IF_ERROR(write_file(authority.file("ca.key"), pem_of(authority.key.get()), 0600));
  RETURN_IF_ERROR(write_file(authority.file("ca.pem"), pem_of(own), 0644));
  const std::unique_ptr<X509_CRL, Freed<X509_CRL_free>> list(X509_CRL_new());
  return write_list(authority, list.get(), now_unix_s);
}

absl::Status issue_certificate(const std::string& folder, const CertificateWish& wish,
                               const std::string& out_folder, double now_unix_s, double valid_s) {
  RETURN_IF_ERROR(check_name(wish.name));
  if (wish.hosts.empty() && wish.roles.empty())
    return absl::InvalidArgumentError(
        "a certificate is of a coordinator (--host) or has roles (--role submit, work, read)");
  std::string hosts, uses;
  for (const std::string& host : wish.hosts) {
    ASSIGN_OR_RETURN(const auto name, alternative_name(host));
    absl::StrAppend(&hosts, hosts.empty() ? "" : ",", name);
  }
  if (!wish.hosts.empty()) uses = "serverAuth";
  if (!wish.roles.empty()) absl::StrAppend(&uses, uses.empty() ? "" : ",", "clientAuth");
  for (const Role role : wish.roles) absl::StrAppend(&uses, ",", role_oid(role));
  ASSIGN_OR_RETURN(const auto authority, open_authority(folder));
  if (now_unix_s + valid_s > expiry_of(authority))
    return absl::InvalidArgumentError(absl::StrCat(
        "the certificate would outlive its authority's, which ends in ",
        std::max(0.0, std::floor((expiry_of(authority) - now_unix_s) / 86400)), " days"));
  const std::string pem_path = absl::StrCat(out_folder, "/", wish.name, ".pem");
  const std::string key_path = absl::StrCat(out_folder, "/", wish.name, ".key");
  for (const std::string& path : {pem_path, key_path})
    if (access(path.c_str(), F_OK) == 0)
      return absl::AlreadyExistsError(absl::StrCat(path, " is there already"));
  const PrivateKey key(EVP_PKEY_Q_keygen(nullptr, nullptr, "EC", "P-256"));
  if (!key) return openssl_failed("a key");
  X509* const issuer = authority.certificate.get();
  ASSIGN_OR_RETURN(auto made,
                   begin_certificate(wish.name, issuer, key.get(), now_unix_s - kClocksDiffer_s,
                                     now_unix_s + valid_s));
  std::vector<std::pair<int, std::string>> extensions = {
      {NID_basic_constraints, "critical,CA:FALSE"},
      {NID_key_usage, "critical,digitalSignature"},
      {NID_ext_key_usage, uses},
      {NID_subject_key_identifier, "hash"},
      {NID_authority_key_identifier, "keyid"}};
  if (!hosts.empty()) extensions.emplace_back(NID_subject_alt_name, hosts);
  for (const auto& [kind, text] : extensions)
    RETURN_IF_ERROR(add_extension(made.get(), issuer, kind, text));
  if (X509_sign(made.get(), authority.key.get(), EVP_sha256()) == 0)
    return openssl_failed("a signature");
  const std::string pem = pem_of(made.get());
  ASSIGN_OR_RETURN(const auto facts, certificate_facts(pem));
  // The authority's copy is written first: a certificate that the authority knows can be revoked
  // even if a later step fails.
  RETURN_IF_ERROR(
      write_file(authority.file(absl::StrCat("issued/", facts.serial_hex, ".pem")), pem, 0600));
  RETURN_IF_ERROR(write_file(key_path, pem_of(key.get()), 0600));
  return write_file(pem_path, pem, 0644);
}

absl::StatusOr<std::vector<IssuedCertificate>> issued_certificates(const std::string& folder) {
  ASSIGN_OR_RETURN(const auto ca, read_file(folder + "/ca.pem"));
  ASSIGN_OR_RETURN(const auto crl, read_file(folder + "/crl.pem"));
  const auto revoked = revoked_serials(crl, ca);
  if (!revoked.ok())
    return absl::InvalidArgumentError(
        absl::StrCat(folder, "/crl.pem ", std::string(revoked.status().message())));
  std::vector<IssuedCertificate> out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/issued", error)) {
    if (entry.path().extension() != ".pem") continue;
    ASSIGN_OR_RETURN(const auto pem, read_file(entry.path()));
    auto facts = certificate_facts(pem);
    if (!facts.ok())
      return absl::InvalidArgumentError(
          absl::StrCat(entry.path().string(), " ", std::string(facts.status().message())));
    const bool gone = revoked->contains(facts->serial_hex);
    out.push_back({*std::move(facts), gone});
  }
  if (error) return absl::InvalidArgumentError(absl::StrCat(folder, "/issued: ", error.message()));
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::tie(a.facts.name, a.facts.valid_from_unix_s, a.facts.serial_hex) <
           std::tie(b.facts.name, b.facts.valid_from_unix_s, b.facts.serial_hex);
  });
  return out;
}

absl::StatusOr<std::size_t> revoke_certificates(const std::string& folder,
                                                const std::string& name_or_serial,
                                                double now_unix_s) {
  ASSIGN_OR_RETURN(const auto authority, open_authority(folder));
  ASSIGN_OR_RETURN(const auto issued, issued_certificates(folder));
  const std::string serial = absl::AsciiStrToLower(name_or_serial);
  ASSIGN_OR_RETURN(const auto known, read_file(authority.file("crl.pem")));
  const Bio bio(BIO_new_mem_buf(known.data(), static_cast<int>(known.size())));
  const std::unique_ptr<X509_CRL, Freed<X509_CRL_free>> list(
      PEM_read_bio_X509_CRL(bio.get(), nullptr, nullptr, nullptr));
  if (!list) return openssl_failed("a revocation list");
  const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> now(
      ASN1_TIME_set(nullptr, static_cast<time_t>(now_unix_s)));
  std::size_t found = 0, revoked = 0;
  for (const IssuedCertificate& one : issued) {
    const bool meant = one.facts.name == name_or_serial || one.facts.serial_hex == serial;
    found += meant ? 1 : 0;
    if (!meant || one.revoked) continue;
    ++revoked;
    BIGNUM* number = nullptr;
    BN_hex2bn(&number, one.facts.serial_hex.c_str());
    const std::unique_ptr<BIGNUM, Freed<BN_free>> owned(number);
    const std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>> serial_number(
        BN_to_ASN1_INTEGER(number, nullptr));
    std::unique_ptr<X509_REVOKED, Freed<X509_REVOKED_free>> entry(X509_REVOKED_new());
    if (X509_REVOKED_set_serialNumber(entry.get(), serial_number.get()) != 1 ||
        X509_REVOKED_set_revocationDate(entry.get(), now.get()) != 1 ||
        X509_CRL_add0_revoked(list.get(), entry.get()) != 1)
      return openssl_failed("a revocation");
    static_cast<void>(entry.release());
  }
  if (found == 0)
    return absl::NotFoundError(absl::StrCat("\"", name_or_serial,
                                            "\" is neither name nor serial number of a "
                                            "certificate that ",
                                            folder, " has signed"));
  RETURN_IF_ERROR(write_list(authority, list.get(), now_unix_s));
  return revoked;
}

}  // namespace irsig

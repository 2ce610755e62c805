#include "coordinator/client/tls.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <sys/stat.h>

#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "coordinator/client/openssl_handles.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostTlsPemBytes = 1'000'000;

absl::Status wrong(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", what));
}

absl::StatusOr<std::string> read(const char* option, const std::string& path) {
  if (path.empty())
    return absl::InvalidArgumentError(
        absl::StrCat(option, " is missing: TLS needs --tls-cert, --tls-key and --tls-ca"));
  auto text = read_user_file(path, kMostTlsPemBytes);
  if (!text.ok()) return wrong(path, std::string(text.status().message()));
  return text;
}

// Whoever reads a key can do whatever its owner can.
absl::Status check_mode(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return wrong(path, "cannot be looked at");
  if ((info.st_mode & 077U) == 0) return absl::OkStatus();
  return wrong(path, absl::StrFormat("a private key that others may use (mode %04o), expected a "
                                     "file of its owner alone: chmod 600",
                                     info.st_mode & 07777U));
}

// Its dates are looked at by themselves: what is wrong with them is said better than by OpenSSL.
absl::Status check_dates(const X509& certificate, const std::string& path) {
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) <= 0)
    return wrong(path, "the certificate has expired");
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0)
    return wrong(path, "the certificate is not valid yet");
  return absl::OkStatus();
}

absl::Status check_signed(const std::vector<Certificate>& chain,
                          const std::vector<Certificate>& trusted, const TlsFiles& files) {
  const CertificateStore store = store_of(trusted);
  const std::unique_ptr<STACK_OF(X509), void (*)(STACK_OF(X509)*)> others(
      sk_X509_new_null(), [](STACK_OF(X509) * list) { sk_X509_free(list); });
  for (const Certificate& other : chain) sk_X509_push(others.get(), other.get());
  const std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>> check(X509_STORE_CTX_new());
  X509_STORE_CTX_init(check.get(), store.get(), chain.front().get(), others.get());
  if (X509_verify_cert(check.get()) == 1) return absl::OkStatus();
  return wrong(files.certificate,
               absl::StrCat("not signed by the authority in ", files.ca, ": ",
                            X509_verify_cert_error_string(X509_STORE_CTX_get_error(check.get()))));
}

}  // namespace

std::vector<Certificate> certificates_of(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  std::vector<Certificate> out;
  while (X509* next = PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr))
    out.emplace_back(next);
  ERR_clear_error();  // of the end
  return out;
}

PrivateKey private_key_of(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  const auto no_password = [](char*, int, int, void*) { return -1; };
  PrivateKey key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
  ERR_clear_error();
  return key;
}

CertificateStore store_of(const std::vector<Certificate>& trusted) {
  CertificateStore store(X509_STORE_new());
  for (const Certificate& certificate : trusted)
    X509_STORE_add_cert(store.get(), certificate.get());
  return store;
}

absl::Status use_identity(const TlsIdentity& tls, SSL_CTX* context) {
  SSL_CTX_set_cert_store(context, store_of(certificates_of(tls.ca)).release());
  const auto chain = certificates_of(tls.certificate);
  const PrivateKey key = private_key_of(tls.key);
  bool taken = !chain.empty() && key && SSL_CTX_use_certificate(context, chain.front().get()) == 1;
  for (std::size_t i = 1; taken && i < chain.size(); ++i)
    taken = SSL_CTX_add1_chain_cert(context, chain[i].get()) == 1;
  if (taken && SSL_CTX_use_PrivateKey(context, key.get()) == 1) return absl::OkStatus();
  const char* why = ERR_reason_error_string(ERR_peek_error());
  auto status = absl::InvalidArgumentError(
      absl::StrCat("the certificate cannot be used: ", why == nullptr ? "unknown error" : why));
  ERR_clear_error();
  return status;
}

absl::StatusOr<TlsIdentity> read_tls(const TlsFiles& files) {
  TlsIdentity out;
  for (const auto& [option, path, text] :
       {std::tuple<const char*, const std::string&, std::string&>{"--tls-cert", files.certificate,
                                                                  out.certificate},
        {"--tls-key", files.key, out.key},
        {"--tls-ca", files.ca, out.ca}}) {
    ASSIGN_OR_RETURN(text, read(option, path));
  }
  RETURN_IF_ERROR(check_mode(files.key));
  const auto chain = certificates_of(out.certificate), trusted = certificates_of(out.ca);
  if (chain.empty()) return wrong(files.certificate, "has no certificate, expected one in PEM");
  if (trusted.empty()) return wrong(files.ca, "has no certificate, expected one in PEM");
  const PrivateKey key = private_key_of(out.key);
  if (!key) return wrong(files.key, "has no private key, expected one in PEM without a password");
  if (X509_check_private_key(chain.front().get(), key.get()) != 1) {
    ERR_clear_error();
    return wrong(files.key,
                 absl::StrCat("is not the key of the certificate in ", files.certificate));
  }
  RETURN_IF_ERROR(check_dates(*chain.front(), files.certificate));
  RETURN_IF_ERROR(check_dates(*trusted.front(), files.ca));
  RETURN_IF_ERROR(check_signed(chain, trusted, files));
  return out;
}

}  // namespace irsig

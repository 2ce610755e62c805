#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "coordinator/client/tls.h"

namespace irsig {

// OpenSSL's objects, freed when they go.
template <auto free>
struct Freed {
  template <class Object>
  void operator()(Object* object) const {
    free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using CertificateStore = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;

// Reads the certificates of a PEM text, in their order; stops at the first block that is not a
// certificate.
std::vector<Certificate> certificates_of(const std::string& pem);
// Reads a private key. Null: the text is not a key, or the key has a password; no password is asked
// for.
PrivateKey private_key_of(const std::string& pem);
// Returns the number as lower-case hex.
std::string hex_of(const ASN1_INTEGER* serial);
// Returns the store of an authority.
CertificateStore store_of(const std::vector<Certificate>& trusted);
// Sets the identity's certificate with its chain, and trusts its authority. INVALID_ARGUMENT:
// OpenSSL refuses the identity.
[[nodiscard]] absl::Status use_identity(const TlsIdentity& tls, SSL_CTX* context);

}  // namespace irsig

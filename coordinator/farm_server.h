#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "coordinator/farm.h"

namespace irsig {

struct FarmServerOptions {
  std::string db_path;
  Address listen;
  FarmRules rules;
  Clock clock, unix_clock;  // as Farm's
  std::function<void(const absl::Status&)>
      on_failure;  // the store cannot continue; called at most once
  SweepCheck check_sweep;  // for submitted and for stored sweeps; not empty
  // If true, a database that this coordinator made is removed if no sweep was submitted to it.
  bool remove_unused = false;
  // The authority's list of revoked certificates, with TLS; read again when the file changes;
  // empty: none.
  std::string tls_crl = {};
};

// A coordinator in this process: one database, one address. Belongs to one thread.
class FarmServer {
 public:
  // Opens the database, takes back every lease of an earlier coordinator, and only then listens, so
  // that every client that connects is answered. ALREADY_EXISTS: the port is in use; no new
  // database is left.
  static absl::StatusOr<std::unique_ptr<FarmServer>> start(FarmServerOptions options);
  virtual ~FarmServer() = default;

  // Returns the address at which the server listens; if port 0 was requested, with the port that
  // the system chose.
  [[nodiscard]] virtual std::string address() const = 0;
  // Refuses further calls, commits waiting ones, and makes the database one plain file.
  // UNAVAILABLE: a reader has the database open; it is complete, but its journal stays beside it.
  virtual absl::Status stop() = 0;
};

}  // namespace irsig

#include "serve/serve.h"

#include <fmt/format.h>

#include "core/base/status_macros.h"
#include "schema/store/reader.h"
#include "serve/answers.h"
#include "serve/guarded_page.h"

namespace irsig {

absl::Status serve(const ServeOptions& options) {
  // Before a database is opened: an address that is wrong.
  RETURN_IF_ERROR(parse_listen_address(options.address).status());
  if (options.port < 0 || options.port > 65535)
    return absl::InvalidArgumentError(
        fmt::format("--port {}: expected 0 (a free one) to 65535", options.port));
  for (const std::string& database : options.database)
    if (const auto reader = StoreReader::open(database); !reader.ok()) return reader.status();
  const PageSources sources{options.database, options.detector, options.extent_of, options.farm,
                            options.accuracy_page};
  return serve_guarded(
      {.command = "irsig serve",
       .address = options.address,
       .port = options.port,
       .answer = [&](const RequestTarget& target) {
         return answer(sources, target.path, target.parameters);
       },
       .on_ready = [&](const std::string& url, const ListenAddress& address) {
         options.on_ready(
             url, address.loopback
                      ? ""
                      : fmt::format(
                            "whoever knows the address below and reaches {} can read these "
                            "databases; nothing is encrypted, so that whoever can listen to the "
                            "network learns it",
                            address.address));
       }});
}

}  // namespace irsig
